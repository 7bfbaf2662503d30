// 8-bit PNG images, to a file or to bytes that a page or a GLB embeds. The same pixels always give the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace core {

/// 8-bit sRGB pixels, row-major from the top, channels 3 (RGB) or 4 (RGBA, alpha not premultiplied).
struct ByteImage {
  int width = 0, height = 0, channels = 3;
  std::span<const std::uint8_t> bytes;  ///< width x height x channels
};

/// The image as a PNG file's bytes.
std::string pngBytes(const ByteImage& image);

/// Writes under a temporary name and renames. Throws Error.
void writePng(const std::filesystem::path& path, const ByteImage& image);

}  // namespace core
