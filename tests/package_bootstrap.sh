#!/usr/bin/env bash
# A stranger's first minutes: installs packages into a fresh Debian that has no compiler, runs the README's commands there, and takes all away again.
# tests/package.sh --bootstrap calls it, as root; archives come from where this machine's apt has them.
#   tests/package_bootstrap.sh PACKAGES BUILD
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
packages=$1 build=$2
fail() {
  echo "tests/package_bootstrap.sh: $*" >&2
  exit 1
}
. tests/debian.sh
in_own_mounts "$@"

own_root
begin=$(date +%s)
step() { echo "$(date +%T) $*"; }
state() { inside dpkg-query -W -f '${db:Status-Abbrev}${Installed-Size}\n' | awk '$1 == "ii" { count++; size += $2 } END { printf "%d packages, %d MB\n", count, size / 1024 }'; }

make_debian
make_stranger
mkdir "$root/packages"
cp "$packages"/*.deb "$root/packages/"
alcove=/packages/$(basename "$packages"/alcove_*.deb) pictures=/packages/$(basename "$packages"/alcove-pictures_*.deb)
step "fresh: $(state)"
! inside sh -c 'command -v gcc c++ cmake' || fail "the fresh Debian has a compiler"
all_files() { inside find / -xdev -not -path '/var/cache/*' -not -path '/var/lib/*' -not -path '/var/log/*' -iname '*alcove*' -not -path '/packages/*' -not -path '/home/*'; }

install --no-install-recommends "$alcove"
step "alcove alone: $(state)"
examples=/usr/share/doc/alcove/examples
said=$(as_user "alcove run $examples/interior.gbuffer.exr --camera $examples/interior.camera.json --radius 0.35 -o none.exr" 2>&1) && fail "without a Vulkan driver a run ended well"
grep -q mesa-vulkan-drivers <<<"$said" || fail "without a Vulkan driver a run does not say what to install: $said"
inside apt-get purge -y -qq --autoremove alcove >/dev/null 2>&1

# As the README has it, with what is recommended.
install "$alcove"
as_user "cp -r $examples . && alcove run examples/interior.gbuffer.exr --camera examples/interior.camera.json --radius 0.35 -o ao.exr --preview ao.png" \
  >"$root/log" 2>&1 || fail "the first picture: $(cat "$root/log")"
step "with what is recommended: $(state)"
inside ldconfig -p | grep -q OpenImageIO && fail "alcove has brought OpenImageIO"

# Sequences are not shipped; all else must run.
commands=0
while read -r line; do
  as_user "$line" >"$root/log" 2>&1 || fail "README.md: $line: $(cat "$root/log")"
  commands=$((commands + 1))
done < <(grep -h '^    alcove ' README.md | grep -v -e '####' -e '%0')
[ "$commands" -ge 3 ] || fail "README.md has $commands commands that can be run"
as_user 'alcove run examples/interior.gbuffer.exr --camera examples/interior.camera.json --radius 0.35 --preset draft -o draft.exr --set debug=view-z &&
  alcove compare draft.exr ao.exr --report report.html && alcove doctor' >"$root/log" 2>&1 || fail "draft, compare and doctor: $(cat "$root/log")"
step "$commands commands of README.md, a page of compare and doctor, without alcove-pictures"

install "$pictures"
step "with alcove-pictures: $(state)"
as_user 'alcove compare draft.view-z.png draft.view-z.png' \
  >"$root/log" 2>&1 || fail "with alcove-pictures: $(cat "$root/log")"

version=$(dpkg-deb -f "$root$alcove" Version)+1
cpack --config "$build/CPackConfig.cmake" -G DEB -R "$version" -B "$packages/next" >"$root/log" 2>&1 || fail "cpack: $(cat "$root/log")"
mkdir "$root/packages/next"
cp "$packages"/next/*.deb "$root/packages/next/"
install /packages/next/{alcove,alcove-pictures}_"${version}_$(dpkg --print-architecture).deb"
for package in alcove alcove-pictures; do
  [ "$(inside dpkg-query -W -f '${Version}' "$package")" = "$version" ] || fail "$package is not upgraded to $version"
done
inside alcove presets >/dev/null || fail "after the upgrade alcove presets fails"
step "an upgrade"

inside apt-get remove -y -qq alcove >/dev/null 2>&1 || fail "apt-get remove alcove"
rm -rf "$root/home/stranger"
left=$(all_files)
[ -z "$left" ] || fail "left after removal: $left"
inside apt-get purge -y -qq alcove alcove-pictures >/dev/null 2>&1 || fail "apt-get purge"
left=$(all_files; inside dpkg-query -W 2>/dev/null | grep alcove || true)
[ -z "$left" ] || fail "left after purge: $left"
step "removed and purged; all in $(($(date +%s) - begin)) s"
