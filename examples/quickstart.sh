#!/usr/bin/env bash
# From a fresh machine to AO and a composite of a real frame: installs what is missing, builds the program and no tests, runs it,
# and says where the results lie.
#   examples/quickstart.sh [OUTPUT_FOLDER]
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/quickstart}

scripts/setup.sh --only-program
mkdir -p "$out"
echo "Computing AO of examples/interior.gbuffer.exr"
build/alcove run examples/interior.gbuffer.exr --beauty examples/interior.beauty.exr --camera examples/interior.camera.json --radius 0.35 \
  -o "$out/ao.exr" --composite "$out/composite.exr" --preview "$out/preview.png" --stats "$out/stats.json"
echo "AO:        $out/ao.exr"
echo "composite: $out/composite.exr"
echo "preview:   $out/preview.png"
