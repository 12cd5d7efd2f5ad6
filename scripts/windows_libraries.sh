#!/usr/bin/env bash
# Builds the libraries that Alcove needs on Windows into FOLDER, static, with Debian's MinGW, from Debian's source packages, which apt checks by their
# signatures. What is header files alone comes from this machine's packages. Takes no time if FOLDER is complete.
#   scripts/windows_libraries.sh FOLDER
# FOLDER/licences has the licence of each, as Debian keeps it, and FOLDER/licences/VERSIONS what was built.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p "$1"
folder=$(realpath "$1")
toolchain=$PWD/cmake/mingw.cmake
source_packages="libpng1.6 libdeflate imath openexr fmtlib xxhash"
header_packages="libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libvulkan-dev spirv-headers"
# zlib alone is a package of Debian's that is compiled for Windows already.
compiled_packages="libz-mingw-w64-dev"
# The C and C++ libraries of the compiler, parts of which become parts of the program.
runtime_packages="g++-mingw-w64-x86-64-posix mingw-w64-x86-64-dev"
# An upgrade of this machine's own packages of them, such as a security update, builds the libraries again.
own_packages="libpng-dev libdeflate-dev libimath-dev libopenexr-dev libfmt-dev libxxhash-dev"
# Complete for these packages and this script.
state=$(cat "$0" "$toolchain" <(dpkg-query -W $own_packages $header_packages $compiled_packages $runtime_packages) | sha256sum)
[ "$(cat "$folder/complete" 2>/dev/null)" != "$state" ] || exit 0
rm -rf "$folder"
sources=$folder/sources
mkdir -p "$sources/lists/partial" "$sources/archives/partial" "$folder"/{include,lib/pkgconfig,licences}

# The Debian archives that this machine installs from have the sources too, whether or not its lists name them.
archives() {
  apt-get indextargets --format "\$(ORIGIN) deb-src \$(REPO_URI) \$(CODENAME) \$(COMPONENT)" 'Created-By: Packages' |
    sed -n 's/^Debian //p' | awk '!(($0) in known) { known[$0]; print }'
}
fetch() {
  local options=(-o Dir::Etc::SourceList="$sources/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o Dir::State::Lists="$sources/lists" -o Dir::Cache="$sources" -o APT::Sandbox::User= -o APT::Update::Error-Mode=any)
  (cd "$sources" && apt-get -qq "${options[@]}" update && apt-get -qq "${options[@]}" source $source_packages) >"$folder/log" 2>&1
}
archives >"$sources/sources.list"
[ -s "$sources/sources.list" ] || { echo "apt knows no Debian archive: run apt-get update first" >&2; exit 1; }
if ! fetch; then
  echo "Sources of security updates cannot be fetched; those of the release are built" >&2
  { archives | grep -v -- -security || true; } >"$sources/sources.list"
  fetch || { cat "$folder/log" >&2; exit 1; }
fi

build() {  # SOURCE [CMAKE ARGUMENTS]
  local source
  source=$(echo "$sources"/$1)
  shift
  cmake -S "$source" -B "$sources/build-${source##*/}" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_PREFIX_PATH="$folder" -DCMAKE_INSTALL_PREFIX="$folder" -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF "$@"
  cmake --build "$sources/build-${source##*/}" --target install
}
# pkg-config's file of a library that comes with none, or with one for another folder.
pkg_config_file() {  # NAME VERSION [LIBRARY]
  printf '%s\n' "Name: $1" "Description: $1" "Version: $2" "Cflags: -I\${pcfiledir}/../../include" "Libs: -L\${pcfiledir}/.. ${3:-}" \
    >"$folder/lib/pkgconfig/$1.pc"
}
version_of() { dpkg-parsechangelog -l "$(echo "$sources"/$1/debian/changelog)" -S Version; }
build_all() {
  build 'libpng1.6-*' -DPNG_SHARED=OFF -DPNG_TESTS=OFF -DPNG_EXECUTABLES=OFF
  make -C "$(echo "$sources"/libdeflate-*)" CC=x86_64-w64-mingw32-gcc-posix AR=x86_64-w64-mingw32-ar libdeflatestatic.lib
  cp "$sources"/libdeflate-*/libdeflatestatic.lib "$folder/lib/libdeflate.a"
  cp "$sources"/libdeflate-*/libdeflate.h "$folder/include"
  pkg_config_file libdeflate "$(version_of 'libdeflate-*')" -ldeflate
  build 'imath-*'
  build 'openexr-*' -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_EXAMPLES=OFF -DOPENEXR_INSTALL_TOOLS=OFF
  build 'fmtlib-*' -DFMT_DOC=OFF -DFMT_TEST=OFF
  build 'xxhash-*/cmake_unofficial' -DXXHASH_BUILD_XXHSUM=OFF
  pkg_config_file libxxhash "$(version_of 'xxhash-*')" -lxxhash
  # Headers, and the files by which CMake finds them, which name no folder outside of their own.
  dpkg -L $header_packages | grep -E '^/usr/(include|share/cmake)/' | while read -r file; do
    [ -d "$file" ] || install -D -m 644 "$file" "$folder/${file#/usr/}"
  done
  pkg_config_file tomlplusplus "$(dpkg-query -W -f '${Version}' libtomlplusplus-dev)"
  # The import library of Vulkan's loader, which Windows' drivers bring.
  {
    echo "LIBRARY vulkan-1.dll"
    echo "EXPORTS"
    sed -n 's/^VKAPI_ATTR .* VKAPI_CALL \(vk[A-Za-z0-9]*\)(.*/  \1/p' /usr/include/vulkan/vulkan_core.h
  } >"$sources/vulkan.def"
  x86_64-w64-mingw32-dlltool -d "$sources/vulkan.def" -l "$folder/lib/libvulkan-1.dll.a"
  for source in "$sources"/*/debian; do
    cp "$source/copyright" "$folder/licences/$(dpkg-parsechangelog -l "$source/changelog" -S Source)"
    echo "$(dpkg-parsechangelog -l "$source/changelog" -S Source) $(dpkg-parsechangelog -l "$source/changelog" -S Version)"
  done >"$folder/licences/VERSIONS"
  for package in $header_packages $compiled_packages $runtime_packages; do
    cp -L "/usr/share/doc/$package/copyright" "$folder/licences/$package"
    dpkg-query -W "$package"
  done >>"$folder/licences/VERSIONS"
}
trap 'tail -n 30 "$folder/log" >&2' EXIT
build_all >"$folder/log" 2>&1
trap - EXIT
rm -rf "$sources"
echo "$state" >"$folder/complete"
