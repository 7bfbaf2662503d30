// Numbers out of glTF buffers, every access checked against the bytes that are there.
// Source: glTF 2.0 specification, section 3.6.2 (accessors).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace core {

/// Where an accessor's numbers lie and how they are stored.
struct AccessorView {
  std::span<const unsigned char> bytes;  ///< of the buffer view
  bool zeros = false;                    ///< no buffer view: all elements are 0
  std::uint64_t offset = 0;              ///< of the first element, in bytes
  std::uint64_t stride = 0;              ///< bytes from one element to the next, 0 = tightly packed
  std::uint64_t count = 0;               ///< elements
  int components = 1;                    ///< numbers per element
  int componentType = 5126;              ///< 5120 .. 5126, as glTF counts them
  bool normalized = false;               ///< integers stand for [0, 1] or [-1, 1]
  std::string where;                     ///< file and accessor, for messages
  std::vector<AccessorView> sparse;      ///< empty, or the indices and the values of elements that are replaced
};

/// All numbers as float, element by element, sparse ones replaced. Throws Error where they reach beyond the bytes, are
/// not finite, or an element does not have `components` numbers.
std::vector<float> readFloats(const AccessorView& view, int components);

/// The same as vectors.
template <class Vec>
std::vector<Vec> readVectors(const AccessorView& view) {
  const std::vector<float> numbers = readFloats(view, Vec::length());
  std::vector<Vec> vectors(view.count);
  for (std::size_t i = 0; i < numbers.size(); ++i) vectors[i / Vec::length()][i % Vec::length()] = numbers[i];
  return vectors;
}

/// Unsigned integers. Throws Error where they reach beyond the bytes or are of another type.
std::vector<std::uint32_t> readIndices(const AccessorView& view);

/// A part of a buffer. Throws Error where it reaches beyond the buffer's end.
std::span<const unsigned char> checkedPart(std::span<const unsigned char> buffer, std::uint64_t offset,
                                           std::uint64_t length, const std::string& where);

}  // namespace core
