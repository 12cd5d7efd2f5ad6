#!/usr/bin/env bash
# Sets up, builds and runs every test, in the forms that run with each change: tests/long.sh has the long ones, docs/testing.md says which.
#   tests/run.sh [--device NAME]      on another Vulkan device
# ALCOVE_STRICT=ON makes warnings in our code errors, as continuous integration does.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "${1:-}" = --device ]; then
  export ALCOVE_TEST_DEVICE=${2:?--device NAME}
fi
scripts/setup.sh
ctest --test-dir build -LE long --output-on-failure -j "$(nproc)"
