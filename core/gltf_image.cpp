#include "core/gltf_image.h"

#include <cstring>

#include "core/check.h"

namespace core {
namespace {

constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 26;
constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr unsigned char kJpeg[] = {0xff, 0xd8, 0xff};

template <std::size_t N>
bool startsWith(std::span<const unsigned char> bytes, const unsigned char (&magic)[N]) {
  return bytes.size() >= N && std::memcmp(bytes.data(), magic, N) == 0;
}

/// A number of the PNG header, big-endian.
std::uint64_t headerWord(std::span<const unsigned char> bytes, std::size_t at) {
  return std::uint64_t{bytes[at]} << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3];
}

}  // namespace

void checkImage(std::span<const unsigned char> bytes, const std::string& where) {
  const bool png = startsWith(bytes, kPng);
  if (!png && !startsWith(bytes, kJpeg)) throw Error(where, "is neither PNG nor JPEG", "convert it");
  if (bytes.size() < 24 || bytes.size() > 0x7fffffff) throw Error(where, "is no whole image", "export it again");
  if (png && headerWord(bytes, 16) * headerWord(bytes, 20) > kMostTexels)
    throw Error(where, "has more than 2^26 pixels", "scale it down");
}

std::vector<std::uint8_t> highBytes(const std::vector<unsigned char>& pairs) {
  std::vector<std::uint8_t> bytes(pairs.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::uint16_t value;
    std::memcpy(&value, &pairs[2 * i], sizeof(value));
    bytes[i] = static_cast<std::uint8_t>(value >> 8);
  }
  return bytes;
}

Texture::Wrap wrapOf(int mode) {
  constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648;
  if (mode == kClampToEdge) return Texture::Wrap::clamp;
  return mode == kMirroredRepeat ? Texture::Wrap::mirror : Texture::Wrap::repeat;
}

}  // namespace core
