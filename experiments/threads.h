// How many threads the program may use; results never depend on it.
#pragma once

#include <tbb/global_control.h>

#include <memory>
#include <string>

#include "core/check.h"

namespace experiments {

/// Limits all parallel loops while it lives. threads = 0: one per hardware thread.
class ThreadLimit {
 public:
  /// Throws core::UsageError outside 0..1024.
  explicit ThreadLimit(int threads) {
    if (threads < 0 || threads > 1024)
      throw core::UsageError("--threads", std::to_string(threads) + " is outside [0, 1024]",
                             "give 0 for all, or 1, 2, ...");
    if (threads > 0)
      control_ = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
  }

 private:
  std::unique_ptr<tbb::global_control> control_;
};

}  // namespace experiments
