#!/usr/bin/env bash
# Quick start, tests and packages in a fresh Debian of any suite, as a newcomer finds them there: as root, with debootstrap. An hour or more.
#   tests/system.sh SUITE [FOLDER]         such as trixie; in FOLDER, which stays and is gone on with, or else in one that goes
#   ALCOVE_SYSTEM_TESTS='-R debug_view'    arguments of ctest
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
fail() {
  echo "tests/system.sh: $*" >&2
  exit 1
}
step() { echo "$(date +%T) $*"; }
. tests/debian.sh
suite=${1:?SUITE, such as trixie}
in_own_mounts "$@"
own_root "${2:-}"

make_debian "$suite"
mkdir -p "$root/alcove"
git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C "$root/alcove"
in_alcove() { inside env "ALCOVE_SYSTEM_TESTS=${ALCOVE_SYSTEM_TESTS:-}" sh -c "cd /alcove && $1"; }
step "quick start"
in_alcove examples/quickstart.sh
step "tests"
in_alcove 'scripts/setup.sh && ctest --test-dir build -LE long --output-on-failure -j "$(nproc)" $ALCOVE_SYSTEM_TESTS'
step "packages"
in_alcove 'scripts/package.sh && tests/package.sh build-package'
step "done"
