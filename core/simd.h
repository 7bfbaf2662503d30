// One portable binary: kernels marked TWOFOLD_CLONES are compiled for several instruction sets and chosen when the
// program starts. Without fused multiply-add every set gives the same bits.
#pragma once

#include <bit>
#include <cstdint>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TWOFOLD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define TWOFOLD_CLONES
#endif

namespace core {

/// Pixels that a row kernel treats at a time; its partial sums live on the stack.
inline constexpr int kBlock = 256;

/// exp(max(x, -87)) for x <= 0, branch-free so that loops vectorise; relative error below 3e-7.
/// Cody-Waite reduction and a minimax-like polynomial of degree 6 on [-ln 2 / 2, ln 2 / 2].
[[gnu::always_inline]] inline float expNegative(float x) {
  const float clamped = x > -87.0f ? x : -87.0f;
  const float scaled = clamped * 1.44269504f;
  const auto whole = static_cast<std::int32_t>(scaled - 0.5f);  // rounds to nearest for x <= 0
  const float k = static_cast<float>(whole);
  const float r = (clamped - k * 0.693359375f) - k * -2.12194440e-4f;
  float p = 1.3888889e-3f;
  p = p * r + 8.3333333e-3f;
  p = p * r + 4.1666667e-2f;
  p = p * r + 1.6666667e-1f;
  p = p * r + 0.5f;
  p = p * r + 1.0f;
  p = p * r + 1.0f;
  const float scale = std::bit_cast<float>((whole + 127) << 23);
  return p * scale;
}

}  // namespace core
