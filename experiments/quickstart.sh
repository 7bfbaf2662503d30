#!/usr/bin/env bash
# From a clone to a table of results: installs packages, builds the program, runs experiments/configs/quickstart.json.
# usage: experiments/quickstart.sh [OPTION OF twofold run...]
set -euo pipefail
cd "$(dirname "$0")/.."

experiments/install.sh
cmake --preset release
cmake --build --preset release --target twofold
built=$SECONDS

build/release/experiments/twofold run experiments/configs/quickstart.json -o out/quickstart "$@"
echo "quickstart: built in $built s, ran in $((SECONDS - built)) s; results are in out/quickstart"
