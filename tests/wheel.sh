#!/usr/bin/env bash
# Installs the wheel by pip into a fresh Debian of another version, with another Python and without Alcove, and computes.
#   tests/wheel.sh [SUITE [FOLDER]]     SUITE: trixie unless given; FOLDER: where that Debian stays for the next time
# Builds the wheel first, if build-wheel/ has none. As root, with debootstrap, from where this machine's apt has its archives.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
fail() { echo "tests/wheel.sh: $*" >&2; exit 1; }
step() { echo "== $*"; }
. tests/debian.sh
in_own_mounts "$@"
compgen -G 'build-wheel/*.whl' >/dev/null || scripts/package.sh wheel
wheel=$(echo build-wheel/*.whl)
own_root "${2:-}"
make_debian "${1:-trixie}"
install python3-pip python3-numpy mesa-vulkan-drivers
make_stranger
cp "$wheel" "$root/home/stranger/"
step "pip install, to the first AO"
begun=$(date +%s)
as_user "python3 -m pip install --quiet --no-index --no-warn-script-location --break-system-packages $(basename "$wheel")" || fail "pip failed"
# shellcheck disable=SC2016
as_user 'python3 -c "
import alcove, numpy, platform
z = numpy.full((270, 480), 5, numpy.float32)
z[:, :200] = 4.6
ao = alcove.ao(z, radius=.5, fov=40)
assert ao[:, 300:].min() > .99 and ao[:, 200:204].max() < .95
print(\"Python\", platform.python_version(), \"AO\", ao[:, 202].mean())
"' || fail "no AO"
echo "$(($(date +%s) - begun)) s"
