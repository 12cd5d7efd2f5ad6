#!/usr/bin/env bash
# What tests alone do not show: the address, undefined-behaviour and thread sanitizers, clang-tidy, some seconds of fuzzing for each target; and what no test reaches.
#   scripts/check.sh           what reads others' bytes, every estimator, and sequences, as continuous integration does
#   scripts/check.sh all       all sources and all tests
#   scripts/check.sh coverage  only this: lines and branches of core/ and cli/ that the tests reach
# Builds are in build-fuzz/ (fuzzing, and the address sanitizer with clang), build-asan/ (without it), build-tsan/, build-tidy/ and build-coverage/. ALCOVE_STRICT=ON
# makes warnings in our code errors. Without clang, clang-tidy and fuzzing say so and are left out, unless CI is set.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

readers=(core/formats/{exr_header,exr_zip,exr_zip_writer,zip_chunk,sample_loops,dds,image_io,open_image,png,sequence}.cpp core/frame/{header_camera,camera,cryptomatte}.cpp core/base/{file,text}.cpp)
tests=({text,new_file,memory_limit}_test
       {file,file_names,open_image,bad_input,capture_formats,color,hostile,layouts,sequence,zip,zip_writer}_test
       {camera,chan,resection,header_camera,gbuffer,parts,evidence,inputs,readings,sources}_test
       {refusals,region,matte,compare,inspect,options}_test
       {gpu,property,confidence,library,library_refusals}_test)
if [ "${1:-}" = all ]; then
  readers=(core/*/*.cpp cli/*.cpp)
  tests=(all)
fi

build() {  # folder, CMake's arguments, -- targets
  local folder=$1 arguments=()
  shift
  while [ "$1" != -- ]; do arguments+=("$1"); shift; done
  shift
  cmake -S . -B "$folder" -G Ninja -DCMAKE_UNITY_BUILD=ON -DALCOVE_TEST_CACHE="$PWD/build/cache" -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" "${arguments[@]}" >/dev/null
  cmake --build "$folder" --target "$@" >"$folder/build.log" || { cat "$folder/build.log"; exit 1; }
}

step() { echo "$(date +%T) $*"; }

has_clang() {
  [ -x "$(command -v clang++)" ] && [ -x "$(command -v clang-tidy)" ] && return
  echo "$1 is left out: there is no clang (Debian packages clang, clang-tidy and libclang-rt-dev)"
  [ -z "${CI:-}" ] || exit 1
  return 1
}

if [ "${1:-}" = coverage ]; then
  step "coverage"
  [ -x "$(command -v gcovr)" ] || { echo "there is no gcovr (Debian package gcovr)"; exit 1; }
  build build-coverage -DALCOVE_COVERAGE=ON -- all
  find build-coverage -name '*.gcda' -delete
  failed=0
  ctest --test-dir build-coverage --output-on-failure -j "$(nproc)" >build-coverage/tests.log || failed=1
  tail -n 3 build-coverage/tests.log
  # Library, module and program, and what of cli/ tests hold themselves; not the tests' own objects, which take gcov many times as long. With -j, gcovr 5.2
  # waits for ever where gcov fails.
  mkdir -p build-coverage/lines
  gcovr --root . --filter core/ --filter cli/ --exclude-throw-branches --json build-coverage/coverage.json --html-details build-coverage/lines/index.html \
    build-coverage/CMakeFiles build-coverage/tests/CMakeFiles/*/__
  scripts/coverage_summary.py build-coverage/coverage.json
  step "all lines: build-coverage/lines/index.html; the tests: build-coverage/tests.log"
  exit "$failed"
fi

# With clang, fuzzing takes the same build.
sanitized=build-asan arguments=(-DALCOVE_SANITIZE=address,undefined) fuzz_targets=()
replays=(tests/fuzz/*_fuzz.cpp)
replays=("${replays[@]##*/}")
replays=("${replays[@]%.cpp}")
if has_clang fuzzing; then
  sanitized=build-fuzz arguments=(-DCMAKE_CXX_COMPILER=clang++ -DALCOVE_FUZZ=ON)
  fuzz_targets=("${replays[@]}")
elif [ "${1:-}" != all ]; then
  tests+=("${replays[@]}")
fi

step "address and undefined behaviour"
# Leaks are not looked for: what lavapipe and OpenEXR lose cannot be told apart, as their libraries are gone by then. Memory over many frames is a test.
export ASAN_OPTIONS=detect_leaks=0:detect_stack_use_after_return=1 UBSAN_OPTIONS=print_stacktrace=1
build "$sanitized" "${arguments[@]}" -- "${tests[@]}" ${fuzz_targets[@]+"${fuzz_targets[@]}"}
selected=$(printf '|%s' "${tests[@]}")
[ "${1:-}" != all ] || selected='|.'
ctest --test-dir "$sanitized" --output-on-failure -j "$(nproc)" -R "^(${selected:1})"

step "threads"
# What drivers and codecs do among themselves is not watched: they are built without it, and their locks are not all seen.
export TSAN_OPTIONS=ignore_noninstrumented_modules=1
build build-tsan -DALCOVE_SANITIZE=thread -- batch_test faults_test zip_test zip_writer_test
ctest --test-dir build-tsan --output-on-failure -R '^(batch_test|faults_test|zip_test|zip_writer_test)$'

if has_clang clang-tidy; then
  step "clang-tidy"
  # It does not read GCC's precompiled headers; without them it also sees that every file includes what it uses.
  cmake -S . -B build-tidy -G Ninja -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DBUILD_TESTING=OFF >/dev/null
  printf '%s\n' "${readers[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p build-tidy --extra-arg=-Wno-unknown-warning-option 2>/dev/null
fi

if [ ${#fuzz_targets[@]} -gt 0 ]; then
  step "fuzzing"
  tests/fuzz/run.sh
fi
step "done"
