// Images that own their pixels, and the small views that kernels take.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "core/check.h"
#include "core/maths.h"

namespace core {

/// Pixels of an image owned elsewhere. pitch counts elements from one row to the next.
template <class T>
struct ImageView {
  using Value = std::remove_const_t<T>;
  T* data = nullptr;
  int width = 0, height = 0;
  std::ptrdiff_t pitch = 0;

  T& operator()(int x, int y) const {
    DCHECK(x >= 0 && x < width && y >= 0 && y < height);
    return data[y * pitch + x];
  }
  T* row(int y) const { return data + y * pitch; }
  bool empty() const { return data == nullptr; }
  bool contains(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  Value load(int x, int y) const { return (*this)(x, y); }
  /// Element i of an image without padding (pitch == width), row by row.
  T& at(std::ptrdiff_t i) const { return data[i]; }
  void store(int x, int y, const Value& value) const requires(!std::is_const_v<T>) { (*this)(x, y) = value; }
  operator ImageView<const T>() const requires(!std::is_const_v<T>) { return {data, width, height, pitch}; }
};

template <class T>
using In = ImageView<const T>;

/// An image that owns its pixels: row-major, width x height, no padding.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, const T& value = T{})
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height, value) {}

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  std::size_t size() const { return pixels_.size(); }
  std::size_t bytes() const { return size() * sizeof(T); }
  T* data() { return pixels_.data(); }
  const T* data() const { return pixels_.data(); }
  T& operator()(int x, int y) { return pixels_[index(x, y)]; }
  const T& operator()(int x, int y) const { return pixels_[index(x, y)]; }
  void fill(const T& value) { std::fill(pixels_.begin(), pixels_.end(), value); }

  ImageView<T> view() { return {pixels_.data(), width_, height_, width_}; }
  In<T> view() const { return {pixels_.data(), width_, height_, width_}; }
  operator ImageView<T>() { return view(); }
  operator In<T>() const { return view(); }

 private:
  std::size_t index(int x, int y) const {
    DCHECK(x >= 0 && x < width_ && y >= 0 && y < height_);
    return static_cast<std::size_t>(y) * width_ + x;
  }
  int width_ = 0, height_ = 0;
  std::vector<T> pixels_;
};

/// Channels of a colour that one T holds: 1 (T converts to and from float) or 3 (to and from vec3).
template <class T>
inline constexpr int kChannels = 1;
/// Channel c of what one element holds.
template <class T>
[[gnu::always_inline]] inline float channelOf(const T& element, [[maybe_unused]] int c) {
  if constexpr (kChannels<T> == 1)
    return element;
  else
    return static_cast<vec3>(element)[c];
}
template <class T>
inline constexpr int kPlanes = 3 / kChannels<std::remove_const_t<T>>;

/// A colour image as three planes of T, or as one where a T is a whole colour, for kernels that stream rows.
/// Const-ness as for ImageView.
template <class T>
struct PlanesView {
  std::array<ImageView<T>, kPlanes<T>> plane;

  int width() const { return plane[0].width; }
  int height() const { return plane[0].height; }
  bool empty() const { return plane[0].empty(); }
  vec3 load(int x, int y) const { return at(y * plane[0].pitch + x); }
  vec3 at(std::ptrdiff_t i) const {
    if constexpr (kPlanes<T> == 1)
      return plane[0].data[i];
    else
      return {plane[0].data[i], plane[1].data[i], plane[2].data[i]};
  }
  void store(int x, int y, const vec3& v) const requires(!std::is_const_v<T>) {
    if constexpr (kPlanes<T> == 1)
      plane[0](x, y) = v;
    else
      for (int c = 0; c < 3; ++c) plane[c](x, y) = v[c];
  }
  operator PlanesView<const T>() const requires(!std::is_const_v<T>) {
    PlanesView<const T> view;
    for (int p = 0; p < kPlanes<T>; ++p) view.plane[p] = plane[p];
    return view;
  }
};

/// Owner of the planes of a colour image, all of one size.
template <class T>
class PlanesOf {
 public:
  PlanesOf() = default;
  PlanesOf(int width, int height, T value = T(0)) {
    for (auto& p : planes_) p = Image<T>(width, height, value);
  }
  int width() const { return planes_[0].width(); }
  int height() const { return planes_[0].height(); }
  bool empty() const { return planes_[0].empty(); }
  std::size_t bytes() const { return kPlanes<T> * planes_[0].bytes(); }
  PlanesView<T> view() {
    PlanesView<T> view;
    for (int p = 0; p < kPlanes<T>; ++p) view.plane[p] = planes_[p].view();
    return view;
  }
  PlanesView<const T> view() const {
    PlanesView<const T> view;
    for (int p = 0; p < kPlanes<T>; ++p) view.plane[p] = planes_[p].view();
    return view;
  }
  operator PlanesView<T>() { return view(); }
  operator PlanesView<const T>() const { return view(); }

 private:
  std::array<Image<T>, kPlanes<T>> planes_;
};

using Planes = PlanesOf<float>;

}  // namespace core
