#!/usr/bin/env bash
# Sets up, builds, and runs every test but the labels long and hosts of ctest, in their short forms: see docs/testing.md.
#   tests/run.sh --hosts              also the label hosts: a browser, Blender, Slurm, and stubs of other programs
#   tests/run.sh --device NAME        on another Vulkan device
# ALCOVE_STRICT=ON makes warnings in our code errors, as continuous integration does.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

left_out='long|hosts'
while [ $# -gt 0 ]; do
  case $1 in
    --hosts) left_out=long ;;
    --device)
      export ALCOVE_TEST_DEVICE=${2:?--device NAME}
      shift
      ;;
    *) echo "$0: $1 is neither --hosts nor --device NAME" >&2; exit 2 ;;
  esac
  shift
done
scripts/setup.sh
ctest --test-dir build -LE "$left_out" --output-on-failure -j "$(nproc)"
