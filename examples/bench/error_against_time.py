#!/usr/bin/env python3
"""Draws docs/pictures/error-against-time.svg from error_against_time.csv, and prints the table of docs/performance.md:
examples/bench/error_against_time.py

Each row of the CSV file is a candidate. `yardsticks` is its time; with `yardsticks_most` it is a range. The columns of
the scenes hold RMSE against ray tracing. Rows of one family are joined by a line. `label` is the place of the name: above, below or right.
SPDX-License-Identifier: BSD-3-Clause
"""
import csv
import math
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
SCENES = ("monkeys", "colonnade", "foliage", "machine", "interior", "terrain")
COLOR = {"Alcove": "#0b62a8", "XeGTAO": "#b4460f", "textbook": "#555555"}
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 420, 70, 30, 40, 60  # px
LEAST_TIME, MOST_TIME, MOST_ERROR = 0.8, 200, 0.15                  # yardsticks, yardsticks, RMSE


def x_of(yardsticks):
    share = math.log(yardsticks / LEAST_TIME) / math.log(MOST_TIME / LEAST_TIME)
    return LEFT + share * (WIDTH - LEFT - RIGHT)


def y_of(error):
    return HEIGHT - BOTTOM - error / MOST_ERROR * (HEIGHT - TOP - BOTTOM)


def line(x1, y1, x2, y2, style):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {style}/>'


def text(x, y, words, style=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" {style}>{words}</text>'


def axes():
    grid = 'stroke="#dddddd"'
    for i in range(8):
        y = y_of(0.02 * i)
        yield line(LEFT, y, WIDTH - RIGHT, y, grid if i else 'stroke="#333333"')
        yield text(LEFT - 8, y + 4, f"{0.02 * i:.2f}"[1:] if i else "0", 'text-anchor="end"')
    for time in (1, 2, 5, 10, 20, 50, 100):
        yield line(x_of(time), TOP, x_of(time), HEIGHT - BOTTOM, grid)
        yield text(x_of(time), HEIGHT - BOTTOM + 18, str(time), 'text-anchor="middle"')
    yield text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 16, "device time in yardsticks (logarithmic)", 'text-anchor="middle"')
    yield text(LEFT - 50, TOP - 16, "RMSE against ray tracing, mean of six scenes; lower is better")


def candidate(row):
    """The mark and the name of a row, and the middle of its mark."""
    color, time = COLOR[row["family"]], float(row["yardsticks"])
    most = float(row["yardsticks_most"] or time)
    x, y = x_of(math.sqrt(time * most)), y_of(row["error"])
    marks = [line(x_of(time), y, x_of(most), y, f'stroke="{color}" stroke-width="11" stroke-linecap="round"')]
    dx, dy, anchor = {"above": (0, -13, "middle"), "below": (-7, 24, "start"), "right": (12, 5, "start")}[row["label"]]
    marks.append(text(x + dx, y + dy, row["name"], f'fill="{color}" text-anchor="{anchor}" font-weight="bold" paint-order="stroke" stroke="white" stroke-width="4"'))
    return marks, (x, y)


def main():
    with open(HERE / "error_against_time.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    print("| | yardsticks |", " | ".join(SCENES), "| mean |\n|" + "---|" * (len(SCENES) + 3))
    for row in rows:
        row["error"] = sum(float(row[scene]) for scene in SCENES) / len(SCENES)
        time = row["yardsticks"] + (f' to {row["yardsticks_most"]}' if row["yardsticks_most"] else "")
        mean = f'{row["error"]:.4f}'.lstrip("0")
        name = f'`{row["name"]}`' if row["family"] == "Alcove" else row["name"]
        print(f'| {name} | {time} |', " | ".join(row[scene] for scene in SCENES), f"| {mean} |")
    shapes, joined = list(axes()), []
    for family, color in COLOR.items():
        drawn = [candidate(row) for row in rows if row["family"] == family]
        points = " ".join(f"{x:.1f},{y:.1f}" for _, (x, y) in drawn)
        joined.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-opacity="0.4" stroke-width="2"/>')
        joined += [mark for marks, _ in drawn for mark in marks]
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" '
    svg += 'font-family="sans-serif" font-size="14" fill="#333333">\n<rect width="100%" height="100%" fill="white"/>\n'
    picture = HERE.parents[1] / "docs/pictures/error-against-time.svg"
    picture.write_text(svg + "\n".join(shapes + joined) + "\n</svg>\n")


if __name__ == "__main__":
    main()
