#!/usr/bin/env bash
# Makes the zip of a build for Windows, BUILD/alcove-VERSION-windows-x86_64.zip: what is installed, and the licences of all
# that the programs have in them. scripts/package.sh calls it for its word windows.
#   scripts/windows_zip.sh BUILD
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "$1")
version=$(awk '/^project\(alcove VERSION/ {print $3}' CMakeLists.txt)
name=alcove-$version-windows-x86_64
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
root=$folder/$name
for component in alcove library dev; do
  cmake --install "$build" --prefix "$root" --component "$component" --strip >/dev/null
done
rm -r "$root"/lib/pkgconfig "$root"/share/doc/libalcove* "$root/share/doc/alcove/changelog.gz"  # for no tool of Windows
licences=$root/share/doc/alcove/libraries
mkdir -p "$licences"
cp "$build"/libraries/licences/* "$licences/"
cp LICENSE "$root/LICENSE.txt"
{  # the first steps, without links; the rest is in the manual
  sed -n '/^## Windows$/,$p' docs/getting-started.md | sed -E 's/\[([^]]*)\]\([^)]*\)/\1/g; s/^## .*/Alcove on Windows/; s/VERSION/'"$version"'/g'
  printf '\nThe manual is share\\doc\\alcove\\README.md, beside docs and examples.\n'
} | sed 's/$/\r/' >"$root/README.txt"
# What windows has no loader for would not start: only its own libraries may be asked for.
for program in "$root"/bin/*; do
  if x86_64-w64-mingw32-objdump -p "$program" | sed -n 's/.*DLL Name: //p' |
    grep -viE '^(kernel32|advapi32|user32|psapi|msvcrt|ntdll|vulkan-1|shell32|ole32|ws2_32)\.dll$'; then
    echo "${program##*/} needs these libraries, which Windows does not have" >&2
    exit 1
  fi
done
rm -f "$build"/alcove-*-windows-x86_64.zip
find "$root" -exec touch -r CMakeLists.txt {} +
(cd "$folder" && find "$name" | LC_ALL=C sort | zip -9 -X -q "$build/$name.zip" -@)
(cd "$build" && stat -c '%s bytes: %n' "$name.zip")
