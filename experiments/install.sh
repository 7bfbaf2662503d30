#!/usr/bin/env bash
# Installs the Debian packages that building and testing need; does nothing where they are all present.
# usage: experiments/install.sh [FURTHER PACKAGE...]
set -euo pipefail

packages=(
  g++ cmake ninja-build                                                            # build
  libtbb-dev libglm-dev libembree-dev libopenexr-dev libtinygltf-dev libpng-dev    # core
  nlohmann-json3-dev libcli11-dev libfmt-dev                                       # experiments
  libgtest-dev                                                                     # tests
  "$@"
)

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

fail() {
  echo "install.sh: $1" >&2
  exit 1
}

command -v dpkg-query >/dev/null || fail "this is no Debian system; install by hand: ${packages[*]}"

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "install.sh: all ${#packages[@]} packages are present"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "neither root nor sudo; ask an administrator to install: ${missing[*]}"
  as_root=(sudo)
fi
apt() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q "$@"; }

echo "install.sh: installing ${missing[*]}"
apt update || echo "install.sh: apt-get update failed; trying with the package lists at hand" >&2
apt install -y --no-install-recommends "${missing[@]}" ||
  fail "apt-get could not install: ${missing[*]}; check the network and /etc/apt/sources.list (Debian 12)"
