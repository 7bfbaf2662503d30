// Tells ThreadSanitizer in which order loops run; nothing in any other build.
//
// Debian's oneTBB is built without ThreadSanitizer, which therefore cannot see that what comes before a loop happens
// before its bodies, and that they happen before what comes after it. Bodies of one loop stay unordered, so races
// between them are found.
#pragma once

#ifdef __SANITIZE_THREAD__
#include <atomic>
#endif

namespace core {

#ifdef __SANITIZE_THREAD__

inline std::atomic<unsigned> loopsBegun{0}, bodiesEnded{0};

/// Lives from before a loop until after it.
struct LoopOrder {
  LoopOrder() { loopsBegun.fetch_add(1, std::memory_order_release); }
  ~LoopOrder() { bodiesEnded.load(std::memory_order_acquire); }
};

/// Lives while a body runs; made before anything that the body captured is touched.
struct BodyOrder {
  BodyOrder() { loopsBegun.load(std::memory_order_acquire); }
  ~BodyOrder() { bodiesEnded.fetch_add(1, std::memory_order_release); }
};

#else

struct LoopOrder {
  ~LoopOrder() {}
};
struct BodyOrder {
  ~BodyOrder() {}
};

#endif

}  // namespace core
