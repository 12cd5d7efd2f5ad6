#!/usr/bin/env bash
# ARM64 without such a machine: this one compiles for a Debian in a folder, where qemu runs the first picture,
# tests, packages and the archive. As root, with debootstrap. An hour or more.
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
# Who registers the emulator takes it away: where binfmt_misc was mounted before, it would outlive the script.
[ -e $emulators/register ] || mount -t binfmt_misc binfmt_misc $emulators
if [ ! -e $emulators/qemu-aarch64 ]; then
  cat /usr/lib/binfmt.d/qemu-aarch64.conf >$emulators/register
  at_exit "echo -1 >$emulators/qemu-aarch64 || true"
fi
make_debian bookworm arm64
here=$PWD
in_alcove() { inside sh -c "cd '$here' && $1"; }

step "libraries"
mkdir -p "$root$here"
mount --bind . "$root$here"
in_alcove 'scripts/setup.sh --only-packages run build pictures package'
install --no-install-recommends libgtest-dev libgmock-dev python3 python3-jsonschema python3-numpy \
  vulkan-validationlayers
# Links of development packages to /lib would lead out of the folder.
find "$root/usr/lib" -lname '/*' | while read -r link; do ln -rsf "$root$(readlink "$link")" "$link"; done

step "cross compiling"
libraries=$root/usr/lib/aarch64-linux-gnu
export PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$libraries/pkgconfig:$root/usr/share/pkgconfig
export QEMU_LD_PREFIX=$root  # for the program outside the folder, which prints its man pages
settings=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DALCOVE_JAVASCRIPT=/usr/share/javascript)
settings+=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++-12)
settings+=(-DCMAKE_SYSROOT="$root" -DCMAKE_LIBRARY_ARCHITECTURE=aarch64-linux-gnu -DCMAKE_FIND_ROOT_PATH="$root")
settings+=(-DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER -DALCOVE_TEST_CACHE=/root/.cache/alcove-tests)
# Libraries of libraries that lie in folders of their own (BLAS) are not looked for.
settings+=(-DCMAKE_EXE_LINKER_FLAGS=-Wl,--allow-shlib-undefined)
for kind in LIBRARY INCLUDE PACKAGE; do settings+=(-DCMAKE_FIND_ROOT_PATH_MODE_$kind=ONLY); done
cmake -S . -B build-arm64 -G Ninja "${settings[@]}" >"$root/log" 2>&1 || fail "cmake: $(cat "$root/log")"
cmake --build build-arm64 >"$root/log" || fail "$(tail -n 30 "$root/log")"

step "first picture, in $(in_alcove 'build-arm64/alcove devices')"
scripts/setup.sh --only-program
frame="run examples/interior.gbuffer.exr --camera examples/interior.camera.json --radius 0.35 -o build-arm64"
build/alcove $frame/here.exr
in_alcove "build-arm64/alcove $frame/arm64.exr"
build/alcove compare build-arm64/arm64.exr build-arm64/here.exr --max-rmse 1e-4
step "packages and archive"
rm -f build-arm64/*.deb
in_alcove 'cpack --config build-arm64/CPackConfig.cmake -B build-arm64 && scripts/archive.sh build-arm64'
tests/first_picture.sh bookworm build-arm64/alcove_*_arm64.deb
tests/first_picture.sh bullseye build-arm64/alcove-*-linux-aarch64.tar.xz
step "tests"
in_alcove "ctest --test-dir build-arm64 -LE 'long|hosts' --timeout 7200 --output-on-failure ${ALCOVE_ARM64_TESTS:-}"
step "done"
