#!/usr/bin/env bash
# What takes too long to run with each change: every test in its long form and with lavapipe's own threads, random frames of all axes at once, and fuzzing
# from where the last run ended. docs/testing.md says what each adds. Half an hour or more; continuous integration does not call it.
#   tests/long.sh [--device NAME]        on another Vulkan device
#   ALCOVE_STABILITY_DRAWS=2000          random frames; 500 without it
#   ALCOVE_FUZZ_SECONDS=600              of each of seven targets, two at a time; 300 without it, 0: no fuzzing
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "${1:-}" = --device ]; then
  export ALCOVE_TEST_DEVICE=${2:?--device NAME}
fi
draws=${ALCOVE_STABILITY_DRAWS:-500}
unset ALCOVE_STABILITY_DRAWS
step() { echo "$(date +%T) $*"; }

step "build"
scripts/setup.sh
scripts/setup.sh --only-packages long
step "every test in its long form"
ALCOVE_TEST_LONG=1 ALCOVE_TEST_THREADS=1 ctest --test-dir build --output-on-failure -j "$(nproc)" --timeout 7200
step "$draws random frames"
ALCOVE_STABILITY_DRAWS=$draws build/tests/stability_test --gtest_filter=Grid.all_axes_at_once
seconds=${ALCOVE_FUZZ_SECONDS:-300}
if [ "$seconds" != 0 ]; then
  step "fuzzing, $seconds s a target"
  tests/fuzz/run.sh --seconds "$seconds"
fi
step "done"
