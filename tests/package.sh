#!/usr/bin/env bash
# What is installed and packaged from a finished build, and whether it works elsewhere. Nothing is compiled.
#   tests/package.sh --install [BUILD]      `cmake --install` into a folder that is then moved: ctest's case `install`
#   tests/package.sh [BUILD]                also the Debian packages, by lintian, and the archive
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

# What lies below the prefix; a command of --help without a man page is missed here.
wanted() {
  printf '%s\n' bin/alcove lib/alcove/libalcove_image_io.so
  printf 'share/%s\n' bash-completion/completions/alcove fish/vendor_completions.d/alcove.fish zsh/vendor-completions/_alcove man/man1/alcove.1.gz
  "$build/alcove" --help | sed -n 's,^  \([a-z][a-z]*\)   .*,share/man/man1/alcove-\1.1.gz,p'
  printf 'share/alcove/hosts/%s\n' blender/alcove.py nuke/alcove_nuke.py nuke/menu.py maya/alcove_maya.py houdini/alcove_houdini.py \
    max/alcove_max.py python/pyproject.toml python/alcove/__init__.py python/alcove/py.typed
  find presets -name '*.toml' -printf 'share/alcove/%p\n'
  printf 'share/doc/alcove/%s\n' README.md CHANGELOG.md copyright examples/interior.{gbuffer.exr,beauty.exr,camera.json} \
    examples/farm/{README.md,alcove.openjd.json,slurm.sh}
  find docs -name '*.md' -o -name '*.png' -o -name '*.json' | sed 's,^,share/doc/alcove/,'
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
mkdir "$folder/elsewhere"
# Of the environment only where compiled kernels lie, and what sanitizers are told.
alone() { (cd "$folder/elsewhere" && env -i XDG_CACHE_HOME="${XDG_CACHE_HOME:-$folder/cache}" ASAN_OPTIONS="${ASAN_OPTIONS:-}" "$folder/moved/bin/alcove" "$@"); }
alone run "$examples/interior.gbuffer.exr" --camera "$examples/interior.camera.json" --beauty "$examples/interior.beauty.exr" --radius 0.35 --preset draft \
  -o ao.exr --composite composite.exr --preview ao.png --debug view-z
for file in ao.exr composite.exr ao.png ao.view-z.png; do
  [ -s "$folder/elsewhere/$file" ] || fail "the installed program wrote no $file"
done
alone doctor | grep -qF "$folder/moved/share/alcove/presets" || fail "the installed program has other presets than those installed: $(alone doctor)"
[ "$last" != install ] || exit 0

step "packages"
(cd "$folder" && cpack --config "$build/CPackConfig.cmake" -B "$folder/packages") >"$folder/cpack.log" || fail "cpack: $(cat "$folder/cpack.log")"
alcove=$(echo "$folder"/packages/alcove_*.deb) pictures=$(echo "$folder"/packages/alcove-pictures_*.deb)
module=lib/alcove/libalcove_image_io.so
{ grep -vx "$module" "$folder/wanted"; echo share/doc/alcove/changelog.gz; } >"$folder/wanted.alcove"
printf '%s\n' "$module" share/doc/alcove-pictures >"$folder/wanted.pictures"
files_of() { dpkg-deb --fsys-tarfile "$1" | tar -t | sed '/\/$/d; s,^\./usr/,,'; }
for package in alcove pictures; do
  files_of "${!package}" >"$folder/files"
  expect_files "${!package##*/}" "$folder/wanted.$package" "$folder/files"
done
tar -tf "$folder"/packages/alcove-*.tar.gz | sed '/\/$/d; s,^[^/]*/,,' >"$folder/files"
expect_files "the archive" "$folder/wanted" "$folder/files"
! dpkg-deb -f "$alcove" Depends | grep -q openimageio || fail "alcove depends on OpenImageIO"
dpkg-deb -f "$pictures" Depends | grep -qF "alcove (= $(dpkg-deb -f "$alcove" Version))" || fail "alcove-pictures takes any version of alcove"
# CPack 3.25 calls ldconfig for every shared object below /usr/lib, modules too.
as_root=()
[ "$(id -u)" != 0 ] || as_root=(--allow-root)
lintian "${as_root[@]}" --fail-on error,warning --suppress-tags maintscript-calls-ldconfig "$alcove" "$pictures" || fail "lintian: see above"
(cd "$folder/packages" && stat -c '%s bytes: %n' -- *.deb *.tar.gz)
[ "$last" = packages ] || tests/package_bootstrap.sh "$folder/packages" "$build"
step "done"
