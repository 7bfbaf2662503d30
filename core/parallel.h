// Loops over pixels and rows on all threads, and sums whose bits do not depend on how many there are.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstdint>
#include <functional>

#include "core/loop_order.h"

namespace core {

/// Pixels on a tile's side; results never depend on it. 16 keeps a tile's surfaces in the second-level cache.
inline constexpr int kDefaultTile = 16;

/// Calls body(x0, y0, x1, y1) once for every block [x0, x1) x [y0, y1) of at most the given size.
template <class Body>
void forEachBlock(int width, int height, int blockWidth, int blockHeight, Body&& body) {
  const int columns = (width + blockWidth - 1) / blockWidth, rows = (height + blockHeight - 1) / blockHeight;
  const LoopOrder loop;
  tbb::parallel_for(tbb::blocked_range<int>(0, columns * rows, 1), [&](const tbb::blocked_range<int>& range) {
    const BodyOrder order;
    for (int t = range.begin(); t != range.end(); ++t) {
      const int x0 = (t % columns) * blockWidth, y0 = (t / columns) * blockHeight;
      body(x0, y0, std::min(x0 + blockWidth, width), std::min(y0 + blockHeight, height));
    }
  });
}

/// The same for square tiles.
template <class Body>
void forEachTile(int width, int height, Body&& body, int tile = kDefaultTile) {
  forEachBlock(width, height, tile, tile, body);
}

/// Calls body(x, y) once for every pixel, tile by tile. body must only write what belongs to (x, y).
template <class Body>
void forEachPixel(int width, int height, Body&& body, int tile = kDefaultTile) {
  forEachTile(
      width, height,
      [&](int x0, int y0, int x1, int y1) {
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) body(x, y);
      },
      tile);
}

/// Calls body(i) once for every i in [0, count), at least grain of them in a row on one thread.
template <class Body>
void forEachIndex(std::size_t count, Body&& body, std::size_t grain = 1) {
  const LoopOrder loop;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
    const BodyOrder order;
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
  });
}

/// Calls body(y) once for every row.
template <class Body>
void forEachRow(int height, Body&& body) {
  forEachIndex(static_cast<std::size_t>(height), [&](std::size_t y) { body(static_cast<int>(y)); });
}

/// Sum of term(i) over [0, count) in double precision, in an order fixed by count alone.
template <class Term>
double deterministicSum(std::int64_t count, Term&& term) {
  const auto part = [&](const tbb::blocked_range<std::int64_t>& range, double sum) {
    const BodyOrder order;
    for (std::int64_t i = range.begin(); i != range.end(); ++i) sum += term(i);
    return sum;
  };
  const LoopOrder loop;
  return tbb::parallel_deterministic_reduce(tbb::blocked_range<std::int64_t>(0, count, 1024), 0.0, part, std::plus<>{});
}

}  // namespace core
