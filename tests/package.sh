#!/usr/bin/env bash
# What is installed and packaged from a finished build, and whether it works elsewhere. Nothing is compiled.
#   tests/package.sh --install [BUILD]      `cmake --install` into a folder that is then moved: ctest's case `install`
#   tests/package.sh [BUILD]                also the Debian packages, by lintian, and the archive, which is made if it is not there
#   tests/package.sh --bootstrap [BUILD]    also the packages in a fresh Debian without a compiler: as root, with debootstrap and the machine's own archives
# BUILD is build/ unless given; build-package/ holds what scripts/package.sh built.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

last=packages
case "${1:-}" in
  --install | --bootstrap)
    last=${1#--}
    shift
    ;;
esac
build=$(realpath "${1:-build}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() {
  echo "tests/package.sh: $*" >&2
  exit 1
}
step() { echo "$(date +%T) $*"; }

version=$(awk '/^project\(alcove VERSION/ {print $3}' CMakeLists.txt)
wanted_library() { printf 'lib/libalcove.so.%s\n' 0 "$version"; }
wanted_dev() {
  printf '%s\n' lib/libalcove.so include/alcove/alcove.h lib/pkgconfig/alcove.pc
  printf 'lib/cmake/alcove/%s\n' alcove-config.cmake alcove-config-version.cmake alcove-config-release.cmake
  find examples/library -type f -printf 'share/doc/alcove/%p\n'
}

# What lies below the prefix; a command of --help without a man page is missed here.
wanted() {
  printf '%s\n' bin/alcove lib/alcove/libalcove_image_io.so
  wanted_library
  wanted_dev
  printf 'share/%s\n' bash-completion/completions/alcove fish/vendor_completions.d/alcove.fish zsh/vendor-completions/_alcove man/man1/alcove.1.gz
  "$build/alcove" --help | sed -n 's,^  \([a-z][a-z]*\)   .*,share/man/man1/alcove-\1.1.gz,p'
  printf 'share/alcove/hosts/%s\n' blender/alcove.py nuke/alcove_nuke.py nuke/menu.py comfyui/__init__.py \
    python/pyproject.toml python/alcove/__init__.py python/alcove/_arrays.py python/alcove/py.typed
  find presets -name '*.toml' -printf 'share/alcove/%p\n'
  printf 'share/doc/alcove/%s\n' README.md CHANGELOG.md copyright examples/interior.{gbuffer.exr,beauty.exr,camera.json} \
    examples/farm/{README.md,Snakefile,alcove.flamenco.js,alcove.openjd.json,slurm.sh}
  find docs -name '*.md' -o -name '*.png' -o -name '*.svg' -o -name '*.json' | sed 's,^,share/doc/alcove/,'
}
expect_files() {  # what it is, then file names on two inputs: wanted, and there
  diff <(LC_ALL=C sort "$2") <(LC_ALL=C sort "$3") >"$folder/difference" || fail "$1: < is missing, > is too much
$(cat "$folder/difference")"
}
wanted >"$folder/wanted"

step "cmake --install"
cmake --install "$build" --prefix "$folder/first" >"$folder/install.log" || fail "cmake --install: $(cat "$folder/install.log")"
mv "$folder/first" "$folder/moved"  # no path to the prefix is kept
(cd "$folder/moved" && find . ! -type d -printf '%P\n') >"$folder/files"
expect_files "cmake --install" "$folder/wanted" "$folder/files"
examples=$folder/moved/share/doc/alcove/examples
# Every link of an installed page leads to an installed file.
(cd "$folder/moved/share/doc/alcove" && grep -oE '\]\([^)#: ]+' README.md CHANGELOG.md docs/*.md examples/*/*.md) | while IFS=: read -r page link; do
  [ -e "$folder/moved/share/doc/alcove/$(dirname "$page")/${link#](}" ] || echo "$page: ${link#](}"
done >"$folder/dead"
[ ! -s "$folder/dead" ] || fail "dead links of installed pages:
$(cat "$folder/dead")"
mkdir "$folder/elsewhere"
# Of the environment only where the driver keeps compiled kernels, and what sanitizers are told.
alone() { (cd "$folder/elsewhere" && env -i XDG_CACHE_HOME="${XDG_CACHE_HOME:-$folder/cache}" ASAN_OPTIONS="${ASAN_OPTIONS:-}" "$folder/moved/bin/alcove" "$@"); }
alone run "$examples/interior.gbuffer.exr" --camera "$examples/interior.camera.json" --beauty "$examples/interior.beauty.exr" --radius 0.35 --preset draft \
  -o ao.exr --composite composite.exr --preview ao.png --set debug=view-z
for file in ao.exr composite.exr ao.png ao.view-z.png; do
  [ -s "$folder/elsewhere/$file" ] || fail "the installed program wrote no $file"
done
alone doctor | grep -qF "$folder/moved/share/alcove/presets" || fail "the installed program has other presets than those installed: $(alone doctor)"
# Other programs find the library where it lies, and it finds what it needs.
build_example() {  # name, then the compiler and its flags
  local example=$1
  shift
  "$@" "$folder/moved/share/doc/alcove/examples/library/$example" -o "$folder/$example.program" $(PKG_CONFIG_PATH="$folder/moved/lib/pkgconfig" pkg-config --cflags --libs alcove) -lm
  LD_LIBRARY_PATH=$folder/moved/lib "$folder/$example.program" >"$folder/$example.said" || fail "$example: it failed"
}
if ! grep -q '^ALCOVE_SANITIZE:STRING=.' "$build/CMakeCache.txt"; then
  build_example sphere.c cc -std=c99 -Wall -Wextra -pedantic -Werror
  build_example box.cpp c++ -std=c++17 -Wall -Wextra -pedantic -Werror
  grep -q '[#%]' "$folder/sphere.c.said" || fail "sphere.c: there is no shadow below the sphere: $(cat "$folder/sphere.c.said")"
  cmake -S "$folder/moved/share/doc/alcove/examples/library" -B "$folder/library" -DCMAKE_PREFIX_PATH="$folder/moved" >"$folder/library.log" &&
    cmake --build "$folder/library" >>"$folder/library.log" || fail "find_package(alcove): $(cat "$folder/library.log")"
  for example in sphere.c box.cpp; do
    "$folder/library/${example%.*}" | cmp -s - "$folder/$example.said" || fail "$example says something else when CMake builds it"
  done
fi
[ "$last" != install ] || exit 0

step "packages"
(cd "$folder" && cpack --config "$build/CPackConfig.cmake" -B "$folder/packages") >"$folder/cpack.log" || fail "cpack: $(cat "$folder/cpack.log")"
alcove=$(echo "$folder"/packages/alcove_*.deb) pictures=$(echo "$folder"/packages/alcove-pictures_*.deb)
library=$(echo "$folder"/packages/libalcove0_*.deb) dev=$(echo "$folder"/packages/libalcove-dev_*.deb) python=$(echo "$folder"/packages/python3-alcove_*.deb)
module=lib/alcove/libalcove_image_io.so
wanted_library >"$folder/library.files"
wanted_dev >"$folder/dev.files"
{ grep -vxF -e "$module" -f "$folder/library.files" -f "$folder/dev.files" "$folder/wanted"; echo share/doc/alcove/changelog.gz; } >"$folder/wanted.alcove"
printf '%s\n' "$module" share/doc/alcove-pictures >"$folder/wanted.pictures"
{ cat "$folder/library.files"; printf 'share/doc/libalcove0/%s\n' changelog.gz copyright; } >"$folder/wanted.library"
{ cat "$folder/dev.files"; echo share/doc/libalcove-dev; } >"$folder/wanted.dev"
{ printf 'lib/python3/dist-packages/alcove/%s\n' __init__.py _arrays.py py.typed; printf 'share/doc/python3-alcove/%s\n' changelog.gz copyright; } >"$folder/wanted.python"
files_of() { dpkg-deb --fsys-tarfile "$1" | tar -t | sed '/\/$/d; s,^\./usr/,,'; }
for package in alcove pictures library dev python; do
  files_of "${!package}" >"$folder/files"
  expect_files "${!package##*/}" "$folder/wanted.$package" "$folder/files"
done
for package in alcove library; do
  ! dpkg-deb -f "${!package}" Depends | grep -q openimageio || fail "${!package##*/} depends on OpenImageIO"
done
! dpkg-deb -f "$library" Depends | grep -q openexr || fail "libalcove0 depends on OpenEXR"
dpkg-deb -f "$pictures" Depends | grep -qF "alcove (= $(dpkg-deb -f "$alcove" Version))" || fail "alcove-pictures takes any version of alcove"
# CPack 3.25 calls ldconfig for every shared object below /usr/lib, modules too.
as_root=()
[ "$(id -u)" != 0 ] || as_root=(--allow-root)
lintian "${as_root[@]}" --fail-on error,warning --suppress-tags maintscript-calls-ldconfig,pkg-config-unavailable-for-cross-compilation "$alcove" "$pictures" "$library" "$dev" "$python" || fail "lintian: see above"
(cd "$folder/packages" && stat -c '%s bytes: %n' -- *.deb)

step "archive"
archive=$(echo "$build"/alcove-*-linux-*.tar.xz)
[ -e "$archive" ] || scripts/archive.sh "$build"
archive=$(echo "$build"/alcove-*-linux-*.tar.xz)
[ "$(stat -c %s "$archive")" -le 50000000 ] || fail "$archive has more than 50 MB"
tar -C "$folder" -xJf "$archive"
mv "$folder"/alcove-*-linux-* "$folder/archive of"  # no path is kept, and a space does no harm
(cd "$folder/archive of" && find . ! -type d -printf '%P\n') | grep -vE '^lib/|^share/doc/alcove/libraries/' >"$folder/files"
{ cat "$folder/wanted.alcove"; printf '%s\n' libexec/alcove share/vulkan/icd.d/lavapipe.json; } >"$folder/wanted.archive"
expect_files "the archive" "$folder/wanted.archive" "$folder/files"
ln -s "$folder/archive of/bin/alcove" "$folder/linked"
for program in "$folder/archive of/bin/alcove" "$folder/linked"; do
  env -i PATH=/usr/bin:/bin HOME="$folder" "$program" doctor | grep -qF "$folder/archive of/share/alcove/presets" || fail "$program has other presets than the archive's"
done
[ "$last" = packages ] || tests/package_bootstrap.sh "$folder/packages" "$build"
step "done"
