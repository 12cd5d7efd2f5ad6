#!/usr/bin/env bash
# How long a stranger takes to the first picture, and how much comes with it, in a fresh Debian of any suite: from a
# package that was built there, or from the archive. The archive must give the bits of the program that it was made of,
# load no library of a Debian 11, write nothing outside its folder but the cache, and load the system's drivers, too.
# As root, with debootstrap, from where this machine's apt has its archives.
#   tests/first_picture.sh SUITE FILE [FOLDER]
# FILE is BUILD/alcove_*.deb or BUILD/alcove-*.tar.xz; FOLDER stays, and is used again.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
fail() {
  echo "tests/first_picture.sh: $*" >&2
  exit 1
}
step() { echo "$(date +%T) $*"; }
. tests/debian.sh
suite=${1:?SUITE, such as trixie} file=$(realpath "${2:?FILE}")
in_own_mounts "$@"
own_root "${3:-}"
case $file in *arm64*|*aarch64*) architecture=arm64 ;; *) architecture= ;; esac
make_debian "$suite" $architecture
make_stranger
seconds() {  # how long a command takes
  local start=$EPOCHREALTIME
  "$@" || return
  awk -v start="$start" -v end="$EPOCHREALTIME" 'BEGIN { printf "%.1f s\n", end - start }'
}
system() {
  inside dpkg-query -W -f '${Installed-Size}\n' |
    awk '{ size += $1 } END { printf "%d packages, %d MB\n", NR, size / 1024 }'
}
frame() { echo "run $1/interior.gbuffer.exr --camera $1/interior.camera.json --radius 0.35 -o ao.exr"; }
name=${file##*/}

case $name in
  *.deb)
    cp "$file" "$root/home/stranger/"
    install="apt-get install -y -qq /home/stranger/$name"
    downloaded=$(seconds inside sh -c "$install -d >/log 2>&1") || fail "$(cat "$root/log")"
    before=$(system)
    first_picture() {
      inside sh -c "$install >/log 2>&1" && as_user "alcove $(frame /usr/share/doc/alcove/examples)" >"$root/log" 2>&1
    }
    taken=$(seconds first_picture) || fail "$(cat "$root/log")"
    step "$suite, $name: $downloaded to download, $taken to install and to the first picture; $before, then $(system)"
    inside apt-get purge -y -qq --autoremove alcove >/dev/null 2>&1
    ;;
  *.tar.xz)
    install xz-utils
    folder=${name%.tar.xz}
    examples=$folder/share/doc/alcove/examples home=$root/home/stranger
    touch "$root/begin"
    first_picture() { as_user "tar -xJ && $folder/bin/alcove $(frame "$examples")" <"$file" >"$root/log" 2>&1; }
    taken=$(seconds first_picture) || fail "$(cat "$root/log")"
    size="$(stat -c %s "$file") bytes, $(du -sm "$home/$folder" | cut -f1) MB unpacked"
    step "$suite, $name: $taken to unpack and to the first picture; $size"

    if [ -z "$architecture" ]; then  # the program itself runs here
      mv "$home/ao.exr" "$root/inside.exr"
      (cd "$home" && eval "'${file%/*}/alcove' $(frame "$examples")") 2>"$root/log" || fail "$(cat "$root/log")"
      cmp "$root/inside.exr" "$home/ao.exr" || fail "it has other bits than the program that it was made of"
    fi
    rm "$home/ao.exr"
    watched="LD_DEBUG=libs LD_DEBUG_OUTPUT=/home/stranger/loads $folder/bin/alcove"
    as_user "$watched $(frame "$examples")" >"$root/log" 2>&1
    # The shell of the launcher is the same process before it.
    loaded=$(awk -v own="/$folder/lib/" 'FNR == 1 { is_own = 0 } index($0, own) { is_own = 1 }
      is_own && /calling init: / { print $NF }' "$home"/loads.* | sort -u)
    grep -q libvulkan_lvp <<<"$loaded" || fail "lavapipe was not loaded: $loaded"
    of_system=$(grep -v "/$folder/" <<<"$loaded" || true)
    [ "$suite" != bullseye ] || [ -z "$of_system" ] || fail "of the system: $of_system"
    step "$(wc -l <<<"$loaded") libraries loaded; of the system: ${of_system:-none}"
    rm "$home"/{ao.exr,loads.*}
    left=$(inside find / -xdev -newer /begin ! -type d ! -path "/home/stranger/$folder/*" \
      ! -path '/home/stranger/.cache/*' ! -name log ! -name inside.exr)
    [ -z "$left" ] || fail "outside its folder it left $left"

    # Manifests of the system's drivers are found, and the libraries of each load beside ours, whichever are older.
    install --no-install-recommends mesa-vulkan-drivers
    said=$(as_user "VK_LOADER_DEBUG=error,driver $folder/bin/alcove devices" 2>&1)
    drivers=("$root"/usr/share/vulkan/icd.d/*.json)
    for driver in "${drivers[@]#"$root"}"; do
      grep -q "Found ICD manifest file $driver" <<<"$said" || fail "$driver is not found: $said"
    done
    ! grep -E 'Failed loading|not found' <<<"$said" || fail "a driver of the system does not load"
    step "${#drivers[@]} drivers of the system load, too"
    inside apt-get purge -y -qq --autoremove mesa-vulkan-drivers >/dev/null 2>&1
    ;;
esac
