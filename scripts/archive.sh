#!/usr/bin/env bash
# Makes the archive of a build, BUILD/alcove-VERSION-linux-MACHINE.tar.xz: what is installed for users
# of the program, every library that it needs, with the C library and its loader, and lavapipe. scripts/package.sh
# calls it for its word archive; scripts/launcher.sh becomes bin/alcove.
#   scripts/archive.sh BUILD
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "$1")
version=$(awk '/^project\(alcove VERSION/ {print $3}' CMakeLists.txt)
name=alcove-$version-linux-$(uname -m)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
root=$folder/$name

cmake --install "$build" --prefix "$root" --component alcove --strip >/dev/null
mkdir -p "$root"/{libexec,lib/alcove,lib/system,share/vulkan/icd.d,share/doc/alcove/libraries}
mv "$root/bin/alcove" "$root/libexec/alcove"
install -m 755 scripts/launcher.sh "$root/bin/alcove"

manifest=$(echo /usr/share/vulkan/icd.d/lvp_icd*.json)
driver=$(sed -n 's/.*"library_path": *"\(.*\)".*/\1/p' "$manifest")
[ "${driver#/}" != "$driver" ] || driver=$(ldconfig -p | awk -v name="$driver" '$1 == name { print $NF; exit }')
sed "s,\(\"library_path\":\) *\".*\",\1 \"../../../lib/system/${driver##*/}\"," "$manifest" \
  >"$root/share/vulkan/icd.d/lavapipe.json"

libraries_of() { ldd "$@" | awk '$2 == "=>" { print $3 } $2 ~ /^\(/ && $1 ~ /^\// { print $1 }' | sort -u; }
program=$(libraries_of "$root/libexec/alcove")
# Drivers need parts of the C library that the program does not, all of the same version.
c_library=$(dpkg -L libc6 | grep -E '/l(d-linux.*|ib[^/]*)\.so\.[0-9]+$')
# Compiling calls nothing of two libraries that LLVM links, 56 MB with ICU: Z3 for static analysis, and libxml2 for
# manifests of Windows. Libraries of the same names stand in for them, in which every function ends the program.
needless='/lib(z3|xml2|icu[a-z]*|lzma)\.so\.'
stand_in() {  # what it stands in for, and who needs it
  comm -12 <(nm -D --defined-only "$1" | sed 's/.* //; s/@@*/ /' | sort) \
    <(nm -D --undefined-only "$2" | sed 's/.* //; s/@/ /' | sort) >"$folder/names"
  awk '{ print "void " $1 "(void) { __builtin_trap(); }" }' "$folder/names" >"$folder/empty.c"
  awk '{ names[$2] = names[$2] $1 "; " } END { for (one in names) print one " { global: " names[one] "};" }' \
    "$folder/names" >"$folder/empty.map"
  cc -w -fno-builtin -shared -s -nostdlib -Wl,-soname,"${1##*/}" -Wl,--version-script="$folder/empty.map" \
    "$folder/empty.c" -o "$root/lib/system/${1##*/}"
}
# lib/system has what drivers share with the program, so that the system's own may stand before it, and lib/alcove what
# is the program's alone.
grep -vE '/(ld-linux.*|lib(c|m|stdc\+\+|gcc_s|vulkan))\.so\.' <<<"$program" | xargs cp -Lt "$root/lib/alcove"
printf '%s\n' $program $(libraries_of "$driver") $c_library "$driver" | grep -vE "$needless" | while read -r library; do
  [ -e "$root/lib/alcove/${library##*/}" ] || cp -Lt "$root/lib/system" "$library"
done
# The licences of all of them, as Debian keeps them.
find "$root/lib" -type f -printf '*/%f\n' | grep -vE "$needless" | xargs dpkg -S | cut -d: -f1 | sort -u |
  while read -r package; do
    cp -L "/usr/share/doc/$package/copyright" "$root/share/doc/alcove/libraries/$package"
  done
llvm=$(libraries_of "$driver" | grep /libLLVM)
for library in $(libraries_of "$llvm" | grep -E '/lib(z3|xml2)\.'); do stand_in "$library" "$llvm"; done

tar -C "$folder" --sort=name --owner=0 --group=0 --numeric-owner --mtime="$(date -r CMakeLists.txt)" -c "$name" |
  xz -9e >"$build/$name.tar.xz"
(cd "$build" && stat -c '%s bytes: %n' "$name.tar.xz")
