# A fresh Debian in a folder, for scripts that source this: as root, with debootstrap, from the archives and through the proxies of this machine's apt.
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash disable=SC2154  # the script that sources it sets root and has fail()

# With mounts of its own, which end with the script. Pass on what the script was called with.
in_own_mounts() {
  [ "$(id -u)" = 0 ] || fail "only root can make a Debian in a folder"
  [ -x "$(command -v debootstrap)" ] || fail "there is no debootstrap (Debian package debootstrap)"
  if [ -n "${ALCOVE_OWN_MOUNTS:-}" ]; then return; fi
  ALCOVE_OWN_MOUNTS=yes exec unshare --mount --propagation private "$0" "$@"
}

# at_exit COMMAND: runs it when the script ends, before those that were passed earlier.
at_exit() {
  exit_commands="$1; ${exit_commands:-}"
  # shellcheck disable=SC2064  # expanded now
  trap "$exit_commands" EXIT
}

# own_root [FOLDER]: sets root to FOLDER, which stays, or else to one that goes with the script.
own_root() {
  root=${1:-$(mktemp -d)}
  mkdir -p "$root"
  root=$(realpath "$root")
  chmod 755 "$root"  # apt downloads as a user of its own
  [ -n "${1:-}" ] || at_exit 'umount -q "$root/proc" "$root/dev/shm" "$root/dev/pts" || true; rm -rf --one-file-system "$root" "$root.log"'
}

machine_sources() { apt-get indextargets --format 'deb $(REPO_URI) $(CODENAME) $(COMPONENT)' 'Identifier: Packages' 'Origin: Debian'; }

# make_debian [SUITE [ARCHITECTURE]]: in $root. Without a suite it is this machine's Debian, with all of its archives.
make_debian() {
  local sources mirror own_suite suite architecture=${2:-$(dpkg --print-architecture)}
  sources=$(machine_sources)
  read -r _ mirror own_suite _ <<<"$(grep -v -e security -e updates <<<"$sources" | head -n 1)"
  [ -n "${own_suite:-}" ] || fail "apt knows no archive of Debian: run apt-get update"
  suite=${1:-$own_suite}
  [ "$suite" = "$own_suite" ] || sources="deb $mirror $suite main"
  step "a fresh Debian ($suite, $architecture)"
  [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase --arch="$architecture" "$suite" "$root" "$mirror" >"$root.log" 2>&1 || fail "debootstrap: $(tail "$root.log")"
  mount -t proc proc "$root/proc"
  mount -t tmpfs tmpfs "$root/dev/shm"
  mount -t devpts devpts "$root/dev/pts"
  echo "$sources" >"$root/etc/apt/sources.list"
  # Proxies, and what this machine takes for valid; archives that have come stay, so that what is timed is no download.
  { apt-config dump | grep -E '^Acquire::(http|https|Check-)'; echo 'APT::Keep-Downloaded-Packages "true";'; } >"$root/etc/apt/apt.conf.d/99machine" || true
  cp /etc/resolv.conf /etc/hosts "$root/etc/"
  printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"  # no services
  chmod +x "$root/usr/sbin/policy-rc.d"
  inside apt-get update -qq || fail "apt-get update failed in the fresh Debian"
}

inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
install() { inside apt-get install -y -qq "$@" >"$root/log" 2>&1 || fail "apt-get install $*: $(cat "$root/log")"; }

# A user who may write nowhere else than in a folder of their own.
make_stranger() { rm -rf "$root/home/stranger" && mkdir -p "$root/home/stranger" && chown 1000:1000 "$root/home/stranger"; }
as_user() { chroot --userspec=1000:1000 "$root" env -i PATH=/usr/bin:/bin HOME=/home/stranger LC_ALL=C.UTF-8 sh -c "cd /home/stranger && $1"; }
