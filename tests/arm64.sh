#!/usr/bin/env bash
# ARM64 without such a machine: this machine's compiler builds for a Debian in a folder, where qemu runs the first picture, tests, packages and the archive.
# As root, with debootstrap and the packages [arm64] of packages.txt. An hour or more.
#   tests/arm64.sh [FOLDER]                FOLDER stays, and is gone on with
#   ALCOVE_ARM64_TESTS='-R debug_view'     arguments of ctest
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
fail() {
  echo "tests/arm64.sh: $*" >&2
  exit 1
}
step() { echo "$(date +%T) $*"; }
. tests/debian.sh
in_own_mounts "$@"
scripts/setup.sh --only-packages run build test arm64
own_root "${1:-}"
emulators=/proc/sys/fs/binfmt_misc
[ -e $emulators/register ] || mount -t binfmt_misc binfmt_misc $emulators
[ -e $emulators/qemu-aarch64 ] || cat /usr/lib/binfmt.d/qemu-aarch64.conf >$emulators/register
make_debian bookworm arm64
here=$PWD build=$PWD/build-arm64
in_alcove() { inside sh -c "cd '$here' && $1"; }

step "libraries"
# Without browsers, compilers of the tests and other programs: what needs them is not tested here.
mkdir -p "$root$here"
mount --bind . "$root$here"
in_alcove 'scripts/setup.sh --only-packages run build pictures package'
install --no-install-recommends libgtest-dev libgmock-dev python3 python3-jsonschema python3-numpy vulkan-validationlayers
# Links of development packages to /lib would lead out of the folder.
find "$root/usr/lib" -lname '/*' | while read -r link; do ln -rsf "$root$(readlink "$link")" "$link"; done

step "cross compiling"
export PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root/usr/lib/aarch64-linux-gnu/pkgconfig:$root/usr/share/pkgconfig
export QEMU_LD_PREFIX=$root  # the program prints its man pages
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
  -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++-12 -DCMAKE_SYSROOT="$root" -DCMAKE_LIBRARY_ARCHITECTURE=aarch64-linux-gnu -DCMAKE_FIND_ROOT_PATH="$root" \
  -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY \
  -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY -DALCOVE_JAVASCRIPT=/usr/share/javascript -DALCOVE_TEST_CACHE=/root/.cache/alcove-tests >"$root/log" 2>&1 ||
  fail "cmake: $(cat "$root/log")"
nice -n 5 cmake --build "$build" >"$root/log" || fail "$(tail -n 30 "$root/log")"
