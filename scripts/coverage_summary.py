#!/usr/bin/env python3
"""Prints the lines and branches of core/ and cli/ that the tests reach, and the files with most unreached ones, from the JSON of gcovr.

  scripts/coverage_summary.py FILE.json [FILES]

SPDX-License-Identifier: BSD-3-Clause
"""
import json
import sys


def ranges(numbers):
    """Writes [1, 2, 3, 7] as "1-3, 7"."""
    runs = []
    for number in numbers:
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def share(reached, all):
    return f"{100 * reached / max(1, all):5.1f} % of {all}"


def main(path, most=12):
    with open(path, encoding="utf-8") as file:
        files = json.load(file)["files"]
    rows = []
    for entry in files:
        lines = [line for line in entry["lines"] if not line["gcovr/noncode"]]
        branches = [branch["count"] > 0 for line in lines for branch in line["branches"]]
        rows.append((entry["file"], len(lines), [line["line_number"] for line in lines if not line["count"]], len(branches), sum(branches)))
    for folder in ("core/", "cli/"):
        inside = [row for row in rows if row[0].startswith(folder)]
        lines, branches = sum(row[1] for row in inside), sum(row[3] for row in inside)
        print(f"{folder:<6} lines {share(lines - sum(len(row[2]) for row in inside), lines)}, branches {share(sum(row[4] for row in inside), branches)}")
    rows.sort(key=lambda row: -len(row[2]))
    for name, lines, missing, _, _ in rows[: int(most)]:
        if missing:
            print(f"{name}: {len(missing)} of {lines} lines: {ranges(missing)}")


main(*sys.argv[1:])
