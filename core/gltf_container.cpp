#include "core/gltf_container.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/check.h"

namespace core {
namespace {

constexpr int kMaxDepth = 256;
constexpr std::uint64_t kMaxSize = 0xffffffffu;  // lengths are 32 bits wide
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;

std::uint32_t word(std::string_view bytes, std::uint64_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

[[noreturn]] void broken(const std::string& where, const std::string& what) {
  throw Error(where, "is no valid GLB: " + what, "repair the file or export it again");
}

std::string_view checkGlb(std::string_view bytes, const std::string& where) {
  if (bytes.size() < 20) broken(where, "its header is cut off");
  if (word(bytes, 4) != 2) broken(where, "its version is " + std::to_string(word(bytes, 4)) + ", not 2");
  const std::uint64_t length = word(bytes, 8);
  if (length > bytes.size())
    broken(where, "it claims " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()));
  const std::uint64_t json = word(bytes, 12), bin = 20 + json;
  if (word(bytes, 16) != kJsonChunk || bin > length) broken(where, "its first chunk is not whole JSON");
  if (bin == length) return bytes.substr(20, json);
  if (bin + 8 > length || bin + 8 + word(bytes, bin) > length) broken(where, "its second chunk is cut off");
  if (word(bytes, bin + 4) != kBinChunk) broken(where, "its second chunk is not binary data");
  return bytes.substr(20, json);
}

/// Deepest nesting of brackets outside strings.
int nesting(std::string_view json) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted && c == '\\') ++i;
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '{' || c == '[') deepest = std::max(deepest, ++depth);
    if (c == '}' || c == ']') --depth;
  }
  return deepest;
}

}  // namespace

bool isGlb(std::string_view bytes) { return bytes.substr(0, 4) == "glTF"; }

std::string_view checkContainer(std::string_view bytes, const std::string& where) {
  if (bytes.size() > kMaxSize) throw Error(where, "is larger than 4 GiB", "split it into several files");
  const std::string_view json = isGlb(bytes) ? checkGlb(bytes, where) : bytes;
  const std::size_t start = json.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (start == std::string_view::npos || json[start] != '{')
    throw Error(where, "is not glTF", "give a .gltf or .glb file of version 2.0");
  if (nesting(json) > kMaxDepth) throw Error(where, "nests its JSON too deep", "export it again");
  return json;
}

}  // namespace core
