// What must hold of an encoded image before a decoder may see it, and how its pixels become texels.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/scene.h"

namespace core {

/// Throws Error naming `where` for bytes that are neither PNG nor JPEG, or a PNG above 2^26 pixels.
void checkImage(std::span<const unsigned char> bytes, const std::string& where);

/// 16-bit numbers (of this machine's byte order) as 8-bit ones: the high bytes.
std::vector<std::uint8_t> highBytes(const std::vector<unsigned char>& pairs);

/// glTF's wrap mode (an OpenGL constant); repeat for any other number.
Texture::Wrap wrapOf(int mode);

}  // namespace core
