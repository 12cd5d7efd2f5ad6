#!/usr/bin/env python3
"""Draws the pictures of README.md and docs/ into docs/pictures/: scripts/pictures.py FRAMES [build/alcove]

FRAMES is the folder of the rendered test scenes. The pictures of the README are two halves of one frame side by side:
the beauty and the composite; or AO by Alcove and by ray tracing. Those of docs/settings.md are
the same part of a frame several times, by other settings and by ray tracing.
SPDX-License-Identifier: BSD-3-Clause
"""
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

GAP = 4  # px, white


def read_png(path):
    """Rows of an 8-bit RGB picture."""
    data = path.read_bytes()
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert (depth, kind) == (8, 2), f"{path}: no 8-bit RGB"
    packed, at = b"", 8
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at : at + 8])
        if name == b"IDAT":
            packed += data[at + 8 : at + 8 + size]
        at += size + 12
    raw, rows, before = zlib.decompress(packed), [], bytes(3 * width)
    for y in range(height):
        line = bytearray(raw[y * (3 * width + 1) : (y + 1) * (3 * width + 1)])
        method, row = line[0], line[1:]
        for i in range(3 * width):
            left = row[i - 3] if i >= 3 else 0
            corner = before[i - 3] if i >= 3 else 0
            up = before[i]
            nearest = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            row[i] = (row[i] + (0, left, up, (left + up) // 2, nearest)[method]) & 255
        rows.append(bytes(row))
        before = row
    return rows


def write_png(path, rows):
    width, height = len(rows[0]) // 3, len(rows)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    # Each row by its differences from the one above, which compress well.
    raw = b"\x00" + rows[0]
    for above, row in zip(rows, rows[1:]):
        raw += b"\x02" + bytes((a - b) & 255 for a, b in zip(row, above))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


def beside(pictures, columns, rows):
    """The same part of each picture."""
    gap = b"\xff" * 3 * GAP
    return [gap.join(p[y][3 * columns[0] : 3 * columns[1]] for p in pictures) for y in range(*rows)]


class Scene:
    """A rendered frame and its truth."""

    def __init__(self, frames, program, scratch, name, radius):
        self.frames, self.program, self.scratch, self.name, self.radius = frames, program, scratch, name, radius

    def run(self, *options):
        """Runs Alcove into ao.exr, in production quality unless the options say otherwise."""
        frame, camera = (self.frames / f"{self.name}.{end}" for end in ("gbuffer.exr", "camera.json"))
        command = [self.program, "run", frame, "--camera", camera, "-o", self.scratch / "ao.exr", "--set", "overwrite=true", "-q"]
        command += [] if "--preset" in options else ["--preset", "production"]
        command += [] if "--radius" in options else ["--radius", self.radius]
        subprocess.run([str(word) for word in [*command, *options]], check=True)

    def composite(self, beauty, *options):
        """The picture as displays show it."""
        preview = self.scratch / "preview.png"
        self.run("--beauty", beauty, "--composite", self.scratch / "comp.exr", "--preview", preview, *options)
        return read_png(preview)

    def shown(self, ao, channel):
        """The AO through the transform of all pictures: as a beauty without AO in it."""
        return self.composite(ao, "--set", "beauty-channels=" + ",".join([channel] * 3), "--intensity", "0", "--preset", "draft")

    def ao(self, *options):
        self.run(*options)
        (self.scratch / "ao.exr").rename(self.scratch / "shown.exr")
        return self.shown(self.scratch / "shown.exr", "Y")

    def truth(self):
        """The sky, 0 in the files of truth, becomes white as in Alcove's AO."""
        return [bytes(row).replace(b"\0", b"\xff") for row in self.shown(self.frames / f"{self.name}.ao.R.a.exr", "AO")]


def main():
    pictures = pathlib.Path("docs/pictures")
    pictures.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        program = sys.argv[2] if len(sys.argv) > 2 else "build/alcove"
        given = (pathlib.Path(sys.argv[1]), program, pathlib.Path(folder))
        interior, foliage = Scene(*given, "interior", "0.35"), Scene(*given, "foliage", "0.2")
        colonnade = Scene(*given, "colonnade", "0.75")

        def draw(name, parts, columns, rows):
            write_png(pictures / f"{name}.png", beside(parts, columns, rows))

        raster = interior.frames / "interior.raster.exr"
        whole = (180, 780), (0, 540)
        draw("interior", [interior.composite(raster, "--intensity", "0"), interior.composite(raster)], *whole)
        draw("interior-ao", [interior.ao(), interior.truth()], *whole)
        draw("radius", [interior.ao("--radius", r) for r in ("0.1", "0.35", "1")], (420, 780), (150, 450))
        draw("preset", [foliage.ao("--preset", p) for p in ("draft", "standard", "production")] + [foliage.truth()], (300, 560), (220, 460))
        estimators = [colonnade.ao("--preset", "standard", "--estimator", e) for e in ("gtao", "bitmask", "hbao", "crytek")]
        draw("estimator", estimators + [colonnade.truth()], (380, 600), (200, 440))
        draw("thickness", [foliage.ao("--thickness", x) for x in ("auto", "0.01", "infinite")] + [foliage.truth()], (300, 560), (220, 460))


if __name__ == "__main__":
    main()
