#!/usr/bin/env bash
# Installs the Debian packages that are missing and builds Alcove into build/ in Release. Takes seconds if everything is built already.
#   scripts/setup.sh [--only-program] [CMAKE ARGUMENTS]
#   scripts/setup.sh --only-packages SECTION...
# ALCOVE_STRICT=ON makes warnings in our code errors, as continuous integration does.
# --only-program: builds build/alcove alone, with the packages of [run] and [build]. Without it, those of [pictures] and [test], and the tests, too.
# --only-packages: installs the packages of these sections of packages.txt, and builds nothing.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

sections="run build pictures test" testing=ON
case "${1:-}" in
  --only-program)
    sections="run build" testing=OFF
    shift
    ;;
  --only-packages)
    shift
    sections=$* testing=
    ;;
esac

packages_of() {  # the packages of the named sections of packages.txt
  awk -v wanted=" $* " '/^\[/ { gsub(/[][]/, ""); is_in = index(wanted, " " $0 " "); next } is_in && NF && !/^#/' packages.txt
}

missing=()
# shellcheck disable=SC2086
for package in $(packages_of $sections); do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
give_up() {
  echo "$1" >&2
  exit 1
}

if [ ${#missing[@]} -gt 0 ]; then
  [ -x "$(command -v apt-get)" ] || give_up "This system has no apt-get. Install the contents of these Debian packages, and build with CMake: ${missing[*]}"
  as_root=()
  if [ "$(id -u)" != 0 ]; then
    [ -x "$(command -v sudo)" ] || give_up "Only root can install packages, and there is no sudo. As root: apt-get install ${missing[*]}"
    as_root=(sudo)
  fi
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq || echo "apt-get update failed; the present lists of packages may be enough"
  # sudo passes no variables on. Without this one, a package that asks a question would wait for ever.
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null ||
    give_up "The packages could not be installed: see the messages of apt-get above, and check the network"
fi

# Passes on the lines of ninja's progress, "[12/104] ...": on a terminal every line, over the last one; elsewhere every twentieth. Debian's awk would
# read 4 KiB of a pipe before the first line.
show_progress() {
  local line has_shown=
  while IFS= read -r line; do
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    local count=${BASH_REMATCH[1]} total=${BASH_REMATCH[2]}
    if [ -t 1 ]; then
      printf '\r  %d of %d' "$count" "$total"
      has_shown=yes
    elif [ "$count" -gt 0 ] && { [ $((count % 20)) = 0 ] || [ "$count" = "$total" ]; }; then
      echo "  $count of $total"
    fi
  done
  if [ -n "$has_shown" ]; then echo; fi
}

[ -n "$testing" ] || exit 0
mkdir -p build
# Sources compiled together take less than half the time. Compiled one by one they are faster after a change: scripts/setup.sh -DCMAKE_UNITY_BUILD=OFF
together=()
[ -f build/CMakeCache.txt ] || together=(-DCMAKE_UNITY_BUILD=ON)
echo "Configuring"
cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING="$testing" -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" "${together[@]}" "$@" >build/build.log 2>&1 || { cat build/build.log; exit 1; }
echo "Compiling"
NINJA_STATUS='[%f/%t] ' cmake --build build 2>&1 | tee -a build/build.log | show_progress || { cat build/build.log; exit 1; }
