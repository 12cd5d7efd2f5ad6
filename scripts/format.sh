#!/usr/bin/env bash
# Lays out every source of ours as .clang-format says. GLSL is close enough to C++ for the same rules.
#   scripts/format.sh           in place
#   scripts/format.sh --check   names the files that would change, and fails if there are any (Debian package clang-format)
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
cd "$(dirname "$0")/.."

# GLSL's includes have an order: a file may need what stands above it.
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
