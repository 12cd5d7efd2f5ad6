#!/usr/bin/env bash
# What takes too long to run with each change: every test in its long form and with lavapipe's own threads, random frames of all axes at once, sanitizers, clang-tidy, and fuzzing
# from where the last run ended. docs/testing.md says what each adds. Half an hour or more; continuous integration does not call it.
#   tests/long.sh [--device NAME]        on another Vulkan device
#   ALCOVE_STABILITY_DRAWS=2000          random frames; 500 without it
#   ALCOVE_FUZZ_SECONDS=600              of each target, two at a time; 300 without it, 0: no fuzzing
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
step "the newest validation layer, Chromium's, also in the kernels"
layer=$PWD/build/validation
mkdir -p "$layer"
cat >"$layer/layer.json" <<'END'
{"file_format_version": "1.2.0", "layer": {"name": "VK_LAYER_KHRONOS_validation", "type": "GLOBAL",
 "library_path": "/usr/lib/chromium/libVkLayer_khronos_validation.so", "api_version": "1.4.0",
 "implementation_version": "1", "description": "Chromium's",
 "instance_extensions": [{"name": "VK_EXT_debug_utils", "spec_version": "2"}]}}
END
printf 'khronos_validation.%s\n' validate_sync=true gpuav_enable=true gpuav_validate_trace_ray=false \
  gpuav_mesh_shading=false message_id_filter=VALIDATION-SETTINGS,WARNING-Setting-Limit-Adjusted >"$layer/vk_layer_settings.txt"
# Not by ctest, which sets VK_LAYER_ENABLES: the layer takes either that or settings.
XDG_CACHE_HOME=$layer ALCOVE_TEST_VALIDATE=1 ALCOVE_TEST_THREADS=1 VK_LAYER_PATH=$layer \
  VK_LAYER_SETTINGS_PATH=$layer/vk_layer_settings.txt build/tests/gpu_tests validation_test

step "kernels that are not optimized"
# What takes away dead code stays, since the host binds no block that only such code names.
passes="--merge-return;--inline-entry-points-exhaustive;--eliminate-dead-functions;--eliminate-local-single-store;--ccp"
passes+=";--eliminate-dead-branches;--eliminate-dead-code-aggressive"
cmake -S . -B build-plain -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON \
  -DALCOVE_SPIRV_PASSES="$passes" >/dev/null
cmake --build build-plain --target alcove >build-plain/build.log || { cat build-plain/build.log; exit 1; }
export ALCOVE_PRESETS=$PWD/presets
for preset in draft standard production reference source/forfun-{crytek,hbao}; do
  for program in build build-plain; do
    $program/alcove run examples/interior.gbuffer.exr --camera examples/interior.camera.json --radius 0.35 --preset "$preset" -q \
      --aov ao,confidence -o "$program/kernels.exr"
  done
  cmp build/kernels.exr build-plain/kernels.exr
done

step "the address sanitizer on files, frames, runs and the library, the thread sanitizer, and clang-tidy"
scripts/check.sh addresses threads tidy

seconds=${ALCOVE_FUZZ_SECONDS:-300}
if [ "$seconds" != 0 ]; then
  step "fuzzing, $seconds s a target"
  tests/fuzz/run.sh --seconds "$seconds"
fi
step "done"
