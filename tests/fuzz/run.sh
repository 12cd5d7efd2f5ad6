#!/usr/bin/env bash
# Builds the fuzz targets with clang into build-fuzz/ and runs each, two at a time; what a target finds stays in build-fuzz/found and fails the run.
#   tests/fuzz/run.sh [SECONDS [TARGET...]]      60 seconds each, all targets; each run goes on from the inputs of the last
#   ALCOVE_FUZZ_SEED=1 tests/fuzz/run.sh         from tests/fuzz/seeds alone; runs of one revision try nearly the same inputs in the same order
# A finding is mended, and its input, made small with `TARGET_fuzz -minimize_crash=1`, joins tests/fuzz/seeds as found-*, where every test run replays it.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:-60}
targets=("${@:2}")
[ ${#targets[@]} -gt 0 ] || targets=(exr dds camera frames toml preset inspect)
cmake -S . -B build-fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DALCOVE_FUZZ=ON -DALCOVE_STRICT="${ALCOVE_STRICT:-OFF}" >/dev/null
cmake --build build-fuzz --target "${targets[@]/%/_fuzz}" >build-fuzz/build.log || { cat build-fuzz/build.log; exit 1; }
mkdir -p build-fuzz/found

# Leaks are not looked for: OpenEXR has some where it refuses a header, and to look after each of these takes longer than all else.
fuzz() {
  local target=$1 seconds=$2 seeds=tests/fuzz/seeds/$1
  [ "$target" != inspect ] || seeds=tests/fuzz/seeds/exr
  local corpus=build-fuzz/corpus/$1 seed=${ALCOVE_FUZZ_SEED:-0} at_fixed_addresses=()
  if [ "$seed" != 0 ]; then
    corpus=build-fuzz/seeded/$1
    rm -rf "$corpus"
    if setarch -R true 2>/dev/null; then at_fixed_addresses=(setarch -R); fi  # libFuzzer takes values that the program compares into its inputs
  fi
  mkdir -p "$corpus"
  if ! ALCOVE_PRESETS=$PWD/presets "${at_fixed_addresses[@]}" "build-fuzz/tests/fuzz/${target}_fuzz" -seed="$seed" -max_total_time="$seconds" \
    -max_len=8192 -timeout=60 -rss_limit_mb=3000 -detect_leaks=0 -artifact_prefix="build-fuzz/found/$target-" -print_final_stats=1 "$corpus" "$seeds" >"build-fuzz/$target.log" 2>&1; then
    tail -n 60 "build-fuzz/$target.log"
    return 1
  fi
  echo "$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "build-fuzz/$target.log") inputs in $seconds s"
}
export -f fuzz
printf '%s\n' "${targets[@]}" | xargs -P 2 -I{} bash -c "fuzz {} $seconds"
