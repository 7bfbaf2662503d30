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

/// A colour image as three planes of T (a type that converts to and from float), for kernels that stream rows.
/// Const-ness as for ImageView.
template <class T>
struct PlanesView {
  std::array<ImageView<T>, 3> plane;

  int width() const { return plane[0].width; }
  int height() const { return plane[0].height; }
  bool empty() const { return plane[0].empty(); }
  vec3 load(int x, int y) const { return {plane[0](x, y), plane[1](x, y), plane[2](x, y)}; }
  vec3 at(std::ptrdiff_t i) const { return {plane[0].data[i], plane[1].data[i], plane[2].data[i]}; }
  void store(int x, int y, const vec3& v) const requires(!std::is_const_v<T>) {
    for (int c = 0; c < 3; ++c) plane[c](x, y) = v[c];
  }
  operator PlanesView<const T>() const requires(!std::is_const_v<T>) { return {{plane[0], plane[1], plane[2]}}; }
};

/// Owner of three planes of one size.
template <class T>
class PlanesOf {
 public:
  PlanesOf() = default;
  PlanesOf(int width, int height, T value = 0) {
    for (auto& p : planes_) p = Image<T>(width, height, value);
  }
  int width() const { return planes_[0].width(); }
  int height() const { return planes_[0].height(); }
  bool empty() const { return planes_[0].empty(); }
  std::size_t bytes() const { return 3 * planes_[0].bytes(); }
  PlanesView<T> view() { return {{planes_[0].view(), planes_[1].view(), planes_[2].view()}}; }
  PlanesView<const T> view() const { return {{planes_[0].view(), planes_[1].view(), planes_[2].view()}}; }
  operator PlanesView<T>() { return view(); }
  operator PlanesView<const T>() const { return view(); }

 private:
  std::array<Image<T>, 3> planes_;
};

using Planes = PlanesOf<float>;

}  // namespace core
