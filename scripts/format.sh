#!/usr/bin/env bash
# Formats every source of ours by .clang-format. GLSL is close enough to C++ for the same rules.
#   scripts/format.sh           in place
#   scripts/format.sh --check   names the files that would change, and fails if there are any
# It needs the Debian package clang-format.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

# The order of GLSL's includes matters: a file may need those above it.
formatted() {
  case $1 in
    *.comp|*.glsl) clang-format --sort-includes=false --assume-filename="$1.cpp" <"$1" ;;
    *) clang-format --assume-filename="$1" <"$1" ;;
  esac
}

changed=0
while read -r file; do
  if [ "${1:-}" = --check ]; then
    formatted "$file" | cmp -s - "$file" || { echo "$file"; changed=1; }
  else
    text=$(formatted "$file")
    printf '%s\n' "$text" | cmp -s - "$file" || printf '%s\n' "$text" >"$file"
  fi
done < <(git ls-files 'core/*.cpp' 'core/*.h' 'api/*.cpp' 'api/*.h' 'cli/*.cpp' 'cli/*.h' 'kernels/*.h' 'kernels/*.comp' 'kernels/*.glsl' 'tests/*.cpp' 'tests/*.h')
exit "$changed"
