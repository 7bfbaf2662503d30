#include "experiments/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <thread>

#include "experiments/commit.h"  // made by the build

namespace experiments {

namespace {

std::string compilerName() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown";
#endif
}

}  // namespace

const char* programVersion() { return TWOFOLD_VERSION; }

Provenance currentProvenance() {
  Provenance p;
  p.version = TWOFOLD_VERSION;
  p.commit = TWOFOLD_COMMIT;
  p.compiler = compilerName();
  p.build = TWOFOLD_BUILD;
  p.cpus = static_cast<int>(std::thread::hardware_concurrency());
  p.threads = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  p.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
  return p;
}

}  // namespace experiments
