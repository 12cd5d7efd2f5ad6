#!/usr/bin/env bash
# Installs the Debian packages that are missing and builds Alcove into build/ in Release. Takes seconds when all is there.
#   scripts/setup.sh [--only-program] [CMAKE ARGUMENTS]
# ALCOVE_STRICT=ON makes warnings in our code errors, as continuous integration does.
# --only-program: build/alcove, with the packages of [run] and [build] and no tests. Without it, all of packages.txt and the tests.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

sections="run build pictures test" testing=ON target=all
if [ "${1:-}" = --only-program ]; then
  sections="run build" testing=OFF target=alcove
  shift
fi

packages_of() {  # the packages of the named sections of packages.txt
  awk -v wanted=" $* " '/^\[/ { gsub(/[][]/, ""); is_in = index(wanted, " " $0 " "); next } is_in && NF && !/^#/' packages.txt
}

missing=()
# shellcheck disable=SC2086
for package in $(packages_of $sections); do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  as_root=()
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
fi

# Passes on a line of ninja's progress, "[12/104] ...": each on a terminal, over the last one; elsewhere every twentieth.
show_progress() {
  local terminal=0
  [ -t 1 ] && terminal=1
  awk -v terminal="$terminal" '
    match($0, /^\[[0-9]+\/[0-9]+\]/) {
      split(substr($0, 2, RLENGTH - 2), count, "/")
      if (terminal) { printf "\r  %d of %d", count[1], count[2]; fflush() }
      else if (count[1] > 0 && (count[1] % 20 == 0 || count[1] == count[2])) { printf "  %d of %d\n", count[1], count[2]; fflush() }
      any = 1
    }
    END { if (terminal && any) print "" }'
}

mkdir -p build
echo "Configuring"
cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING="$testing" -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" "$@" >build/build.log 2>&1 || { cat build/build.log; exit 1; }
echo "Compiling"
NINJA_STATUS='[%f/%t] ' cmake --build build --target "$target" 2>&1 | tee -a build/build.log | show_progress || { cat build/build.log; exit 1; }
