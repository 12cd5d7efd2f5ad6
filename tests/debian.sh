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

machine_sources() { apt-get indextargets --format 'deb $(REPO_URI) $(CODENAME) $(COMPONENT)' 'Identifier: Packages' 'Origin: Debian'; }

# make_debian [SUITE]: in $root. Without a suite it is this machine's Debian, with all of its archives.
make_debian() {
  local sources mirror own_suite suite
  sources=$(machine_sources)
  read -r _ mirror own_suite _ <<<"$(grep -v -e security -e updates <<<"$sources" | head -n 1)"
  [ -n "${own_suite:-}" ] || fail "apt knows no archive of Debian: run apt-get update"
  suite=${1:-$own_suite}
  [ "$suite" = "$own_suite" ] || sources="deb $mirror $suite main"
  step "a fresh Debian ($suite)"
  [ -e "$root/etc/debian_version" ] || debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" 2>&1 || fail "debootstrap: $(tail "$root.log")"
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
