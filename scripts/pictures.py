#!/usr/bin/env python3
"""Draws the pictures of README.md into docs/pictures/: scripts/pictures.py FRAMES [build/alcove]

FRAMES is the folder of the rendered test scenes. Each picture is two halves of one frame side by side: what there was
before, and what Alcove makes of it; or AO by Alcove, and by ray tracing.
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


def beside(left, right, first, last):
    """The columns from first to last of both."""
    return [a[3 * first : 3 * last] + b"\xff" * 3 * GAP + b[3 * first : 3 * last] for a, b in zip(left, right)]


def main():
    frames = pathlib.Path(sys.argv[1])
    program = sys.argv[2] if len(sys.argv) > 2 else "build/alcove"
    pictures = pathlib.Path("docs/pictures")
    pictures.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)

        def picture(scene, radius, *options):
            """The preview of a run in production quality."""
            command = [program, "run", frames / f"{scene}.gbuffer.exr", "--camera", frames / f"{scene}.camera.json"]
            command += ["--radius", radius, "--preset", "production", "-o", scratch / "ao.exr", "--overwrite", "-q"]
            command += ["--preview", scratch / "preview.png", *options]
            subprocess.run([str(word) for word in command], check=True)
            return read_png(scratch / "preview.png")

        def with_beauty(beauty, *options):
            return picture("interior", "0.35", "--beauty", beauty, "--composite", scratch / "comp.exr", *options)

        def shown(ao, channel):
            """AO as it is, through the same transform as all pictures: a beauty that no AO is put into."""
            return with_beauty(ao, "--beauty-channels", ",".join([channel] * 3), "--intensity", "0")

        raster = frames / "interior.raster.exr"
        flat, comp = with_beauty(raster, "--intensity", "0"), with_beauty(raster)
        write_png(pictures / "interior.png", beside(flat, comp, 180, 780))
        ours = scratch / "ours.exr"
        (scratch / "ao.exr").rename(ours)
        truth = frames / "interior.ao.R.a.exr"
        write_png(pictures / "interior-ao.png", beside(shown(ours, "Y"), shown(truth, "AO"), 180, 780))


if __name__ == "__main__":
    main()
