// Loops visit everything once for any size and tile; sums have the same bits on any number of threads.
#include "core/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstring>
#include <numeric>
#include <vector>

#include "core/image.h"

namespace core {
namespace {

constexpr int kSizes[][2] = {{1, 1}, {16, 16}, {17, 31}, {33, 1}, {1, 47}, {0, 5}, {5, 0}};

/// Runs body with exactly this many threads, also on a machine with fewer cores.
template <class Body>
void withThreads(int threads, Body&& body) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute(body);
}

void expectAllOnes(const Image<int>& visits) {
  for (std::size_t i = 0; i < visits.size(); ++i) ASSERT_EQ(visits.data()[i], 1) << "pixel " << i;
}

TEST(ForEachPixel, VisitsEveryPixelOnce) {
  for (const auto& [width, height] : kSizes)
    for (const int tile : {1, 7, 16, 64}) {
      Image<int> visits(width, height);
      withThreads(3, [&] {
        forEachPixel(
            width, height, [&](int x, int y) { ++visits(x, y); }, tile);
      });
      expectAllOnes(visits);
    }
}

TEST(ForEachTile, CoversEveryPixelOnce) {
  for (const auto& [width, height] : kSizes)
    for (const int tile : {1, 7, 16, 64}) {
      Image<int> visits(width, height);
      const auto body = [&](int x0, int y0, int x1, int y1) {
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) ++visits(x, y);
      };
      withThreads(3, [&] { forEachTile(width, height, body, tile); });
      expectAllOnes(visits);
    }
}

TEST(ForEachIndex, VisitsEveryIndexOnce) {
  for (const int count : {0, 1, 63, 64, 65, 1001})
    for (const std::size_t grain : {1, 64}) {
      Image<int> visits(count, 1);
      const auto visit = [&](std::size_t i) { ++visits(static_cast<int>(i), 0); };
      withThreads(3, [&] { forEachIndex(static_cast<std::size_t>(count), visit, grain); });
      expectAllOnes(visits);
    }
}

TEST(ForEachRow, VisitsEveryRowOnce) {
  Image<int> visits(1, 1001);
  withThreads(3, [&] { forEachRow(1001, [&](int y) { ++visits(0, y); }); });
  expectAllOnes(visits);
}

/// Terms of very different size, so that every order of addition gives other bits.
double term(std::int64_t i) { return std::sin(static_cast<double>(i)) * std::pow(10.0, static_cast<double>(i % 17)); }

double sumWith(int threads, std::int64_t count) {
  double sum = 0;
  withThreads(threads, [&] { sum = deterministicSum(count, term); });
  return sum;
}

bool sameBits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(DeterministicSum, HasTheSameBitsForAnyNumberOfThreads) {
  for (const std::int64_t count : {1, 1000, 1025, 100003}) {
    const double one = sumWith(1, count);
    for (const int threads : {2, 3, 8})
      for (int run = 0; run < 5; ++run) EXPECT_TRUE(sameBits(one, sumWith(threads, count))) << threads << " threads";
  }
}

/// Negative control: the terms are such that another order of addition is noticed.
TEST(DeterministicSum, TheTermsTellOrdersApart) {
  double up = 0, down = 0;
  for (std::int64_t i = 0; i < 100003; ++i) up += term(i), down += term(100002 - i);
  EXPECT_FALSE(sameBits(up, down));
}

TEST(DeterministicSum, IsTheSum) {
  EXPECT_EQ(deterministicSum(0, [](std::int64_t) { return 1.0; }), 0.0);
  EXPECT_EQ(deterministicSum(100000, [](std::int64_t i) { return static_cast<double>(i); }), 99999.0 * 50000);
}

}  // namespace
}  // namespace core
