#!/usr/bin/env bash
# Builds into build-package/ the Debian packages of the program, its module for pictures and its libraries, or the portable archive of the program;
# or into build-wheel/ the wheel of the Python package with libalcove, or into build-windows/ the zip for Windows, cross-compiled.
#   scripts/package.sh [archive|wheel|windows] [CMAKE ARGUMENTS]
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

kind=packages
if [[ "${1:-}" =~ ^(archive|wheel|windows)$ ]]; then
  kind=$1
  shift
fi
if [ "$kind" = windows ]; then
  scripts/setup.sh --only-packages build windows
  echo "Libraries"
  scripts/windows_libraries.sh build-windows/libraries
  # The machine's own compiler options are for another system.
  env -u CXXFLAGS -u CFLAGS -u LDFLAGS cmake -S . -B build-windows -G Ninja -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/mingw.cmake" \
    -DCMAKE_PREFIX_PATH="$PWD/build-windows/libraries" -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON "$@"
  cmake --build build-windows
  scripts/windows_zip.sh build-windows
  exit
fi
scripts/setup.sh --only-packages run build pictures package
# Debian's flags with all of its hardening, and without debug information, which would be stripped again.
export DEB_BUILD_MAINT_OPTIONS=hardening=+all DEB_CXXFLAGS_MAINT_STRIP=-g
linker_flags=$(dpkg-buildflags --get LDFLAGS)
if [ "$kind" = wheel ]; then
  cmake -S . -B build-wheel -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON -DALCOVE_LIBRARY_RPATH="\$ORIGIN" \
    -DCMAKE_CXX_FLAGS="$(dpkg-buildflags --get CXXFLAGS) $(dpkg-buildflags --get CPPFLAGS) -include $PWD/scripts/old_glibc.h" \
    -DCMAKE_SHARED_LINKER_FLAGS="$linker_flags" "$@"
  cmake --build build-wheel --target alcove_library
  cmake --install build-wheel --component library --strip --prefix build-wheel/installed >/dev/null
  rm -f build-wheel/*.whl
  scripts/wheel.py build-wheel/installed/lib/libalcove.so.0 build-wheel
  exit
fi
cmake -S . -B build-package -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_CXX_FLAGS="$(dpkg-buildflags --get CXXFLAGS) $(dpkg-buildflags --get CPPFLAGS)" \
  -DCMAKE_EXE_LINKER_FLAGS="$linker_flags" -DCMAKE_MODULE_LINKER_FLAGS="$linker_flags" "$@"
cmake --build build-package
if [ "$kind" = archive ]; then
  scripts/archive.sh build-package
else
  rm -f build-package/*.deb
  cpack --config build-package/CPackConfig.cmake -B build-package
fi
