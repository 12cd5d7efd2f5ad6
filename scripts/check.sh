#!/usr/bin/env bash
# What tests alone do not show: clang-tidy, the address, undefined-behaviour and thread sanitizers, and a minute of fuzzing a target.
#   scripts/check.sh           what reads others' bytes
#   scripts/check.sh sanitize  the same without fuzzing; as continuous integration does, which must not find by chance what no change has broken
#   scripts/check.sh all       all sources and all tests; on 2 cores clang-tidy alone takes ten minutes then
# Builds are in build-asan/, build-tsan/ and build-fuzz/. ALCOVE_STRICT=ON makes warnings in our code errors. Without clang, which only the first and the
# last step need, both say so and are left out, unless CI is set.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

readers=(core/exr_header.cpp core/dds.cpp core/camera.cpp core/sequence.cpp core/file.cpp core/text.cpp)
tests=(file_test camera_test gbuffer_test text_test sequence_test layouts_test sources_test capture_formats_test hostile_test bad_input_test
       {exr,dds,camera,frames,toml,preset,inspect}_fuzz)
if [ "${1:-}" = all ]; then
  readers=(core/*.cpp core/gpu/*.cpp cli/*.cpp)
  tests=(all)
fi

build() {  # folder, CMake's arguments, -- targets
  local folder=$1 arguments=()
  shift
  while [ "$1" != -- ]; do arguments+=("$1"); shift; done
  shift
  cmake -S . -B "$folder" -G Ninja -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" "${arguments[@]}" >/dev/null
  cmake --build "$folder" --target "$@" >"$folder/build.log" || { cat "$folder/build.log"; exit 1; }
}

step() { echo "$(date +%T) $*"; }

has_clang() {
  [ -x "$(command -v clang++)" ] && [ -x "$(command -v clang-tidy)" ] && return
  echo "$1 is left out: there is no clang (Debian packages clang, clang-tidy and libclang-rt-dev)"
  [ -z "${CI:-}" ] || exit 1
  return 1
}

step "address and undefined behaviour"
# Leaks are not looked for: what lavapipe and OpenEXR lose cannot be told apart, as their libraries are gone by then. Memory over many frames is a test.
export ASAN_OPTIONS=detect_leaks=0:detect_stack_use_after_return=1 UBSAN_OPTIONS=print_stacktrace=1
build build-asan -DALCOVE_SANITIZE=address,undefined -- "${tests[@]}"
selected=$(printf '|%s' "${tests[@]}")
[ "${1:-}" != all ] || selected='|.'
ctest --test-dir build-asan --output-on-failure -j "$(nproc)" -R "^(${selected:1})"

if [ "${1:-}" = all ]; then  # what oneTBB hands from thread to thread is reported too: reports are to be read, not counted
  step "threads"
  build build-tsan -DALCOVE_SANITIZE=thread -- alcove batch_test
  export TSAN_OPTIONS="suppressions=$PWD/tests/sanitizers/threads.txt ignore_noninstrumented_modules=1"
  build-tsan/tests/batch_test --gtest_brief=1 --gtest_filter='*threads_chunks*:*one_by_one*' || true
fi

if has_clang clang-tidy; then
  step "clang-tidy"
  printf '%s\n' "${readers[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p build-asan --extra-arg=-Wno-unknown-warning-option 2>/dev/null
fi

if [ "${1:-}" != sanitize ] && has_clang fuzzing; then
  step "fuzzing"
  tests/fuzz/run.sh 60
fi
step "done"
