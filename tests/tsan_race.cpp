// Races on purpose inside a loop body: built with ThreadSanitizer only, where it must be reported in spite of
// tsan.supp.
#include <cstdio>

#include "core/parallel.h"

int main() {
  int shared = 0;
  for (int repeat = 0; repeat < 100; ++repeat) core::forEachRow(1000, [&](int y) { shared += y; });
  std::printf("sum %d\n", shared);
}
