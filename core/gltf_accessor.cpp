#include "core/gltf_accessor.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/check.h"
#include "core/gltf_support.h"

namespace core {
namespace {

constexpr std::uint64_t kMaxZeros = std::uint64_t{1} << 24;  // numbers in an accessor that no byte of the file backs
enum ComponentType { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat };

std::uint64_t componentSize(const AccessorView& view) {
  switch (view.componentType) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      throw Error(view.where, "has component type " + std::to_string(view.componentType), "use 5120 to 5126");
  }
}

/// Checks that every element lies inside the bytes, and returns the stride in bytes.
std::uint64_t checkedStride(const AccessorView& view) {
  const std::uint64_t element = componentSize(view) * view.components;
  if (view.zeros) {
    if (view.count > kMaxZeros / view.components) throw Error(view.where, "claims too many zeros", kRepair);
    return element;
  }
  const std::uint64_t stride = view.stride ? view.stride : element, size = view.bytes.size();
  const bool fits = view.count == 0 || (view.offset <= size && element <= size - view.offset &&
                                        (view.count - 1) <= (size - view.offset - element) / stride);
  if (!fits || stride < element) throw Error(view.where, "reaches beyond its buffer view", kRepair);
  return stride;
}

template <class T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// [glTF 2.0, section 3.6.2.2: f = c / max, and at least -1]
template <class T>
float loadInteger(const unsigned char* bytes, bool normalized) {
  const float value = static_cast<float>(load<T>(bytes));
  return normalized ? std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0f) : value;
}

float loadNumber(const AccessorView& view, const unsigned char* bytes) {
  switch (view.componentType) {
    case kByte:
      return loadInteger<std::int8_t>(bytes, view.normalized);
    case kUnsignedByte:
      return loadInteger<std::uint8_t>(bytes, view.normalized);
    case kShort:
      return loadInteger<std::int16_t>(bytes, view.normalized);
    case kUnsignedShort:
      return loadInteger<std::uint16_t>(bytes, view.normalized);
    case kUnsignedInt:
      return loadInteger<std::uint32_t>(bytes, view.normalized);
    default:
      return load<float>(bytes);
  }
}

std::uint32_t loadIndex(const AccessorView& view, const unsigned char* bytes) {
  switch (view.componentType) {
    case kUnsignedByte:
      return load<std::uint8_t>(bytes);
    case kUnsignedShort:
      return load<std::uint16_t>(bytes);
    case kUnsignedInt:
      return load<std::uint32_t>(bytes);
    default:
      throw Error(view.where, "holds indices of component type " + std::to_string(view.componentType),
                  "use 5121, 5123 or 5125");
  }
}

std::vector<float> readDense(const AccessorView& view) {
  const std::uint64_t stride = checkedStride(view), size = componentSize(view);
  std::vector<float> numbers(view.count * view.components, 0.0f);
  if (view.zeros) return numbers;
  float* out = numbers.data();
  for (std::uint64_t i = 0; i < view.count; ++i)
    for (int c = 0; c < view.components; ++c, ++out) {
      *out = loadNumber(view, &view.bytes[view.offset + i * stride + c * size]);
      if (!std::isfinite(*out)) throw Error(view.where, "holds a number that is not finite", kRepair);
    }
  return numbers;
}

void overlaySparse(std::vector<float>& base, const AccessorView& indices, const AccessorView& values) {
  const std::vector<std::uint32_t> where = readIndices(indices);
  const std::vector<float> replacements = readDense(values);
  const std::size_t components = values.components, elements = base.size() / components;
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (where[i] >= elements) throw Error(indices.where, "has a sparse index beyond its end", kRepair);
    std::copy_n(&replacements[i * components], components, &base[where[i] * components]);
  }
}

}  // namespace

std::vector<float> readFloats(const AccessorView& view, int components) {
  if (view.components != components)
    throw Error(view.where,
                "has " + std::to_string(view.components) + " numbers an element, not " + std::to_string(components),
                kRepair);
  std::vector<float> numbers = readDense(view);
  if (!view.sparse.empty()) overlaySparse(numbers, view.sparse[0], view.sparse[1]);
  return numbers;
}

std::vector<std::uint32_t> readIndices(const AccessorView& view) {
  const std::uint64_t stride = checkedStride(view);
  if (view.components != 1) throw Error(view.where, "holds indices that are not scalars", kRepair);
  std::vector<std::uint32_t> indices(view.count, 0);
  for (std::uint64_t i = 0; i < view.count && !view.zeros; ++i)
    indices[i] = loadIndex(view, &view.bytes[view.offset + i * stride]);
  return indices;
}

std::span<const unsigned char> checkedPart(std::span<const unsigned char> buffer, std::uint64_t offset,
                                           std::uint64_t length, const std::string& where) {
  if (offset > buffer.size() || length > buffer.size() - offset)
    throw Error(where, "reaches beyond the end of its buffer", kRepair);
  return buffer.subspan(offset, length);
}

}  // namespace core
