#!/usr/bin/env bash
# A job of continuous integration: AO of the frames of a list, against approved pictures. Keep OUTPUT_FOLDER as the job's
# artifact, also if the job fails: it has the page, the JUnit file and the pictures.
#   examples/ci/job.sh OUTPUT_FOLDER            0: all is as approved; 6: a limit is broken; else docs/compare-and-bench.md
#   examples/ci/job.sh OUTPUT_FOLDER --approve  the new pictures are the approved ones from now on
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
list=$(dirname "$0")/frames.toml out=$1 alcove=${ALCOVE:-alcove}

approved=$(dirname "$0")/approved
[ -d "$approved" ] || [ "${2:-}" = --approve ] ||
  echo "$approved: there are no approved pictures yet: look at $out, then call $0 $out --approve" >&2
"$alcove" run "$list" -o "$out/{name}.exr" --device cpu
if [ "${2:-}" = --approve ]; then
  mkdir -p "$approved"
  cp "$out"/*.exr "$approved"
fi
"$alcove" compare "$out/{name}.exr" "$list" --max-rmse 1e-4 --report "$out/report.html" --junit "$out/junit.xml"
