#!/usr/bin/env bash
# Installs packages, builds, and runs the fast tests.
# usage: tests/run.sh [--all] [--preset NAME] [-D NAME=VALUE]...
#   --all      the slow statistical tests too
#   --preset   release (default), debug, asan or tsan
#   -D         passed on to CMake
set -euo pipefail
cd "$(dirname "$0")/.."

usage() {
  sed -n '3,6s/^# //p' tests/run.sh >&2
  exit 2
}

preset=release target=fast_tests selection=(-L fast) definitions=()
while [ $# -gt 0 ]; do
  case $1 in
    --all) target=all selection=() ;;
    --preset) preset=${2:-} && shift ;;
    -D) definitions+=(-D "${2:-}") && shift ;;
    *) usage ;;
  esac
  shift || usage
done

experiments/install.sh
cmake --preset "$preset" -DTWOFOLD_TESTS=ON "${definitions[@]}"
cmake --build --preset "$preset" --target "$target"
[ -d "${TWOFOLD_SHARED:-../shared}" ] || echo "tests/run.sh: ../shared is absent: tests that need its files are skipped"
ctest --preset "$preset" "${selection[@]}" --parallel "$(nproc)"
