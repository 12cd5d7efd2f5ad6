#!/usr/bin/env bash
# Sets up, builds and runs every test, the presets' errors against ray tracing among them; then runs the tests of the device once more under the
# Vulkan validation layer with its checks of synchronization, where any message fails. (validation_test has every kernel there. The layer's
# GPU-assisted checks do not know push descriptors in Debian 12.)
#   tests/run.sh [--device NAME]      on another Vulkan device
#   tests/long.sh                     runs the long forms too
# ALCOVE_STRICT=ON makes warnings in our code errors, as continuous integration does.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

if [ "${1:-}" = --device ]; then
  export ALCOVE_TEST_DEVICE=${2:?--device NAME}
fi
scripts/setup.sh
ctest --test-dir build --output-on-failure -j "$(nproc)"
export VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
ALCOVE_TEST_VALIDATE=1 ctest --test-dir build --output-on-failure -R '^gpu_test$'
