#!/usr/bin/env bash
# Builds the fuzz targets with clang into build-fuzz/ and runs each, two at a time; what a target finds stays in build-fuzz/found and fails the run.
#   tests/fuzz/run.sh [TARGET...]             a fixed number of inputs each, about 10 seconds, from tests/fuzz/seeds and a fixed random seed alone: one
#                                             revision gives one result. No TARGET: all
#   tests/fuzz/run.sh --seconds N [TARGET...] so long each; each run goes on from the inputs of the last
# A finding is mended, and its input, made small with `TARGET_fuzz -minimize_crash=1`, joins tests/fuzz/seeds as found-*, where every test run replays it.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/../.."

export seconds=0
if [ "${1:-}" = --seconds ]; then
  seconds=${2:?--seconds N}
  shift 2
fi
targets=("$@")
if [ ${#targets[@]} = 0 ]; then
  targets=(tests/fuzz/*_fuzz.cpp)
  targets=("${targets[@]##*/}")
  targets=("${targets[@]%_fuzz.cpp}")
fi
cmake -S . -B build-fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_UNITY_BUILD=ON -DALCOVE_FUZZ=ON -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" >/dev/null
cmake --build build-fuzz --target "${targets[@]/%/_fuzz}" >build-fuzz/build.log || { cat build-fuzz/build.log; exit 1; }
mkdir -p build-fuzz/found

# Inputs that a target tries in about 10 seconds on one core.
runs_of() {
  case $1 in
    exr) echo 4500 ;;
    deep) echo 1000 ;;
    picture) echo 300000 ;;
    camera) echo 40000 ;;
    frames) echo 5000 ;;
    toml) echo 40000 ;;
    preset) echo 800 ;;
    inspect) echo 1200 ;;
    zip) echo 4500 ;;
  esac
}

# Leaks are not looked for: OpenEXR has some where it refuses a header, and to look after each of these takes longer than all else.
fuzz() {
  local target=$1 seeds=tests/fuzz/seeds/$1 corpus=build-fuzz/corpus/$1 at_fixed_addresses=() length=(-seed=0 -max_total_time="$seconds")
  [[ ! $target =~ ^(inspect|zip)$ ]] || seeds=tests/fuzz/seeds/exr
  if [ "$seconds" = 0 ]; then
    corpus=build-fuzz/seeded/$1
    rm -rf "$corpus"
    length=(-seed=1 -runs="$(runs_of "$target")")
    if setarch -R true 2>/dev/null; then at_fixed_addresses=(setarch -R); fi  # libFuzzer takes values that the program compares into its inputs
  fi
  mkdir -p "$corpus"
  if ! ALCOVE_PRESETS=$PWD/presets "${at_fixed_addresses[@]}" "build-fuzz/tests/fuzz/${target}_fuzz" "${length[@]}" \
    -max_len=8192 -timeout=60 -rss_limit_mb=3000 -detect_leaks=0 -artifact_prefix="build-fuzz/found/$target-" -print_final_stats=1 "$corpus" "$seeds" >"build-fuzz/$target.log" 2>&1; then
    tail -n 60 "build-fuzz/$target.log"
    return 1
  fi
  echo "$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "build-fuzz/$target.log") inputs, $(sed -n 's/^Done.* in \([0-9]*\) second.*/\1/p' "build-fuzz/$target.log") s"
}
export -f fuzz runs_of
printf '%s\n' "${targets[@]}" | xargs -P 2 -I{} bash -c "fuzz {}"
