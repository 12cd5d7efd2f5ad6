#!/bin/sh
# Writes the program's option table into docs/options.md. Call it after a change of the options: scripts/docs-options.sh [build/alcove]
# SPDX-License-Identifier: BSD-3-Clause
set -eu
program=${1:-build/alcove}
cd "$(dirname "$0")/.."
table=$(mktemp)
trap 'rm -f "$table" "$table.md"' EXIT
"$program" run --help-markdown > "$table"
awk -v table="$table" '
  /^<!-- options -->$/ { print; while ((getline line < table) > 0) print line; skip = 1 }
  /^<!-- \/options -->$/ { skip = 0 }
  !skip' docs/options.md > "$table.md"
cat "$table.md" > docs/options.md
