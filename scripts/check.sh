#!/usr/bin/env bash
# Checks beside the tests: the address, undefined-behaviour and thread sanitizers, clang-tidy, some seconds of fuzzing for each target; and the coverage of the tests.
#   scripts/check.sh              all parts but windows and coverage
#   scripts/check.sh PART...      only these parts: addresses (the address and undefined-behaviour sanitizers on tests of files, formats, frames, refusals, same
#                                 bits and the library), threads (the thread sanitizer on sequences), tidy, fuzzing; windows (installs packages.txt's [build]
#                                 and [windows])
#   scripts/check.sh all          all sources and all tests
#   scripts/check.sh coverage     only this: lines and branches of core/ and cli/ that the tests reach
# Builds are in build-fuzz/ (fuzzing, and the address sanitizer with clang), build-asan/ (without it), build-tsan/, build-tidy/ and build-coverage/. ALCOVE_STRICT=ON
# makes warnings in our code errors. Without clang, clang-tidy and fuzzing are left out with a message; if CI is set, that is an error.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

readers=(core/formats/{exr_check,exr_zip,sample_loops,image_io,open_image,png,row_reader,sequence}.cpp core/frame/{camera/header_camera,camera/camera,find/matte}.cpp core/base/{file,text}.cpp)
tests=(base/{text,new_file,memory_limit}_test
       formats/{file,file_names,open_image,bad_input,capture_formats,color,hostile,sequence,zip,zip_writer}_test
       frame/{camera,chan,resection,header_camera,frame_source,parts,inputs,readings,sources}_test
       run/{refusals,same_bits,shadow_run}_test api/{library,library_refusals}_test)
threaded=(run/{batch,faults}_test formats/{zip,zip_writer}_test)
for file in "${readers[@]}" $(printf 'tests/%s.cpp ' "${tests[@]}" "${threaded[@]}"); do
  [ -f "$file" ] || { echo "$0: there is no $file" >&2; exit 2; }
done
parts=${*:-addresses threads tidy fuzzing}
if [ "$parts" = all ]; then
  parts="addresses threads tidy fuzzing"
  mapfile -t readers < <(git ls-files 'core/*.cpp' 'cli/*.cpp')
  tests=()
fi
for part in $parts; do
  [[ " addresses threads tidy windows fuzzing coverage " = *" $part "* ]] || { echo "$0: there is no part $part" >&2; exit 2; }
done
does() { [[ " $parts " = *" $1 "* ]]; }

names_of() {  # a regular expression for the names of tests ROOM/NAME
  local names
  names=$(printf '|%s' "${@##*/}")
  echo "(${names:1})\$"
}
programs_of() {  # the programs of tests ROOM/NAME
  printf '%s_tests\n' "${@%%/*}" | sort -u
}

build() {  # folder, CMake's arguments, -- targets
  local folder=$1 arguments=()
  shift
  while [ "$1" != -- ]; do arguments+=("$1"); shift; done
  shift
  cmake -S . -B "$folder" -G Ninja -DCMAKE_UNITY_BUILD=ON -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" "${arguments[@]}" >/dev/null
  cmake --build "$folder" --target "$@" >"$folder/build.log" || { cat "$folder/build.log"; exit 1; }
}

step() { echo "$(date +%T) $*"; }

has_clang() {
  [ -x "$(command -v clang++)" ] && [ -x "$(command -v clang-tidy)" ] && return
  echo "$1 is left out: there is no clang (Debian packages clang, clang-tidy and libclang-rt-dev)"
  [ -z "${CI:-}" ] || exit 1
  return 1
}

if [ "$parts" = coverage ]; then
  step "coverage"
  [ -x "$(command -v gcovr)" ] || { echo "there is no gcovr (Debian package gcovr)"; exit 1; }
  build build-coverage -DALCOVE_COVERAGE=ON -- all
  find build-coverage -name '*.gcda' -delete
  failed=0
  ctest --test-dir build-coverage --output-on-failure -j "$(nproc)" >build-coverage/tests.log || failed=1
  tail -n 3 build-coverage/tests.log
  # These are the objects of library, module and program, and those of cli/ in tests; the tests' own objects would take gcov many times as long. With -j,
  # gcovr 5.2 waits for ever if gcov fails.
  mkdir -p build-coverage/lines
  gcovr --root . --filter core/ --filter cli/ --exclude-throw-branches --json build-coverage/coverage.json --html-details build-coverage/lines/index.html \
    build-coverage/CMakeFiles build-coverage/tests/CMakeFiles/*/__
  scripts/coverage_summary.py build-coverage/coverage.json
  step "all lines: build-coverage/lines/index.html; the tests: build-coverage/tests.log"
  exit "$failed"
fi

# With clang, fuzzing uses the same build.
sanitized=build-asan arguments=(-DALCOVE_SANITIZE=address,undefined)
fuzz_targets=(tests/fuzz/*_fuzz.cpp)
fuzz_targets=("${fuzz_targets[@]##*/}")
fuzz_targets=("${fuzz_targets[@]%.cpp}")
if { does addresses || does fuzzing; } && has_clang fuzzing; then
  sanitized=build-fuzz arguments=(-DCMAKE_CXX_COMPILER=clang++ -DALCOVE_FUZZ=ON)
fi

if does addresses; then
  step "address and undefined behaviour"
  # Leaks are not checked: lavapipe and OpenEXR leak too, and their libraries are unloaded by then, so leaks cannot be told apart. A test watches memory over many frames.
  export ASAN_OPTIONS=detect_leaks=0:detect_stack_use_after_return=1 UBSAN_OPTIONS=print_stacktrace=1
  if [ ${#tests[@]} = 0 ]; then
    build "$sanitized" "${arguments[@]}" -DALCOVE_TESTS= -- all
    ctest --test-dir "$sanitized" --output-on-failure -j "$(nproc)"
  else
    # shellcheck disable=SC2046
    build "$sanitized" "${arguments[@]}" -DALCOVE_TESTS="$(names_of "${tests[@]}")" -- $(programs_of "${tests[@]}") "${fuzz_targets[@]}"
    ctest --test-dir "$sanitized" --output-on-failure -j "$(nproc)" -R "^($(names_of "${tests[@]}")|.*_fuzz$)"
  fi
fi

if does threads; then
  step "threads"
  # Drivers and codecs are built without the sanitizer, which does not see all of their locks, so they are not watched.
  export TSAN_OPTIONS=ignore_noninstrumented_modules=1
  # shellcheck disable=SC2046
  build build-tsan -DALCOVE_SANITIZE=thread -DALCOVE_TESTS="$(names_of "${threaded[@]}")" -- $(programs_of "${threaded[@]}")
  ctest --test-dir build-tsan --output-on-failure -R "^$(names_of "${threaded[@]}")"
fi

if does tidy && has_clang clang-tidy; then
  step "clang-tidy"
  # clang-tidy cannot read GCC's precompiled headers. Without them, it also checks that every file includes the headers that it uses.
  cmake -S . -B build-tidy -G Ninja -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DBUILD_TESTING=OFF >/dev/null
  printf '%s\n' "${readers[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p build-tidy --extra-arg=-Wno-unknown-warning-option 2>/dev/null
fi

if does windows; then
  step "compiling for Windows what asks for files and the system, without code"
  scripts/setup.sh --only-packages build windows
  cmake -S . -B build-tidy -G Ninja -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DBUILD_TESTING=OFF >/dev/null
  # These headers of Linux' packages hold for Windows too; others of their folder do not.
  mkdir -p build-tidy/headers
  ln -sfn /usr/include/{OpenEXR,Imath,fmt,nlohmann,CLI,toml++,vulkan,vk_video,spirv,png.h,pngconf.h,pnglibconf.h,libdeflate.h,xxhash.h} build-tidy/headers
  git ls-files 'api/*.cpp' 'cli/*.cpp' 'core/*.cpp' | grep -vE '/(system|color|image_io)\.cpp$' |
    xargs grep -lE '<(cstdio|filesystem|fstream)>|base/system\.h' |
    xargs -P "$(nproc)" -n 1 x86_64-w64-mingw32-g++-posix -std=c++20 -fsyntax-only -Wall -Wextra -Werror -DIMATH_HALF_NO_LOOKUP_TABLE \
      -I. -Ibuild-tidy/generated -isystem build-tidy/headers -isystem build-tidy/headers/OpenEXR -isystem build-tidy/headers/Imath
fi

if does fuzzing && [ "$sanitized" = build-fuzz ]; then
  step "fuzzing"
  tests/fuzz/run.sh
fi
step "done"
