// Which program, compiler and machine made a result.
#pragma once

#include <string>

namespace experiments {

struct Provenance {
  std::string version, commit;  ///< commit is "unknown" for builds outside a git repository
  std::string compiler, build;  ///< build: the compiler's mode, such as Release
  int cpus = 0, threads = 0;    ///< hardware threads of the machine; threads that this run was allowed
  std::string date;             ///< UTC, ISO 8601
};

/// Of this program, here and now.
Provenance currentProvenance();

/// Version of the program, such as 0.1.0.
const char* programVersion();

}  // namespace experiments
