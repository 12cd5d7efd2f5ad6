#!/usr/bin/env python3
"""Makes the seeds of the fuzz targets, seeds/TARGET/*: small inputs, mostly good, that reach as much of the readers as few bytes can.

What fuzzing once found lies beside them, named found-*, and is not made here. Formats: "OpenEXR File Layout"; Microsoft, "Programming Guide for DDS".
SPDX-License-Identifier: BSD-3-Clause
"""
import json
import math
import pathlib
import struct
import zlib

SEEDS = pathlib.Path(__file__).parent / "seeds"
WIDTH, HEIGHT = 8, 6


def write(target, name, data):
    folder = SEEDS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def text(name, value):
    return attribute(name, "string", value.encode())


def matrix(name, values):
    return attribute(name, "m44f", struct.pack("<16f", *values))


def channel_list(channels):
    """channels: (name, type) with type 0 integer, 1 half, 2 float; in the order of their names."""
    return b"".join(name.encode() + b"\0" + struct.pack("<iBBBBii", kind, 0, 0, 0, 0, 1, 1) for name, kind in channels) + b"\0"


def header(channels, compression=0, window=(0, 0, WIDTH - 1, HEIGHT - 1), extra=b""):
    box = struct.pack("<4i", *window)
    return (attribute("channels", "chlist", channel_list(channels)) + attribute("compression", "compression", bytes([compression])) +
            attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box) + attribute("lineOrder", "lineOrder", b"\0") +
            attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) +
            attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + extra + b"\0")


def value(name, x, y):
    """A floor that rises to the horizon: depth, and normals that face up."""
    if name.split(".")[-1] in ("Z", "depth") and "N" not in name:
        return 2 + 10 / (y + 1)
    return {"X": 0.0, "Y": 1.0, "Z": 0.0, "A": 1.0}.get(name.split(".")[-1], 0.25 + 0.05 * x)


def row(channels, y):
    codes = {0: "I", 1: "e", 2: "f"}
    return b"".join(struct.pack("<%d%s" % (WIDTH, codes[kind]), *[(int if kind == 0 else float)(value(name, x, y)) for x in range(WIDTH)])
                    for name, kind in channels)


def zipped(data):
    """Even bytes, then odd ones, as differences, deflated."""
    split = data[0::2] + data[1::2]
    packed = zlib.compress(bytes([split[0]] + [(split[i] - split[i - 1] + 128) % 256 for i in range(1, len(split))]))
    return packed if len(packed) < len(data) else data


def chunks(channels, compression):
    """(first line, bytes) of every chunk."""
    lines = {0: 1, 2: 1, 3: 16}[compression]
    for y in range(0, HEIGHT, lines):
        data = b"".join(row(channels, line) for line in range(y, min(HEIGHT, y + lines)))
        yield y, zipped(data) if compression else data


def exr(channels, compression=0, extra=b""):
    channels = sorted(channels)
    start = struct.pack("<ii", 20000630, 2) + header(channels, compression, extra=extra)
    bodies = [struct.pack("<ii", y, len(data)) + data for y, data in chunks(channels, compression)]
    offsets, at = b"", len(start) + 8 * len(bodies)
    for body in bodies:
        offsets += struct.pack("<Q", at)
        at += len(body)
    return start + offsets + b"".join(bodies)


def multi_part(parts, extra=b""):
    """parts: (name, channels) each."""
    parts = [(name, sorted(channels)) for name, channels in parts]
    start = struct.pack("<ii", 20000630, 2 | 0x1000)
    for name, channels in parts:
        start += header(channels, extra=text("name", name) + text("type", "scanlineimage") + attribute("chunkCount", "int", struct.pack("<i", HEIGHT)) + extra)
    start += b"\0"
    at, tables, bodies = len(start) + 8 * HEIGHT * len(parts), b"", b""
    for number, (_, channels) in enumerate(parts):
        for y, data in chunks(channels, 0):
            tables += struct.pack("<Q", at + len(bodies))
            bodies += struct.pack("<iii", number, y, len(data)) + data
    return start + tables + bodies


def tiled(channels, size=4):
    channels = sorted(channels)
    start = struct.pack("<ii", 20000630, 2 | 0x200) + header(channels, extra=attribute("tiles", "tiledesc", struct.pack("<IIB", size, size, 0)))
    codes, bodies = {1: "e", 2: "f"}, []
    for ty in range(math.ceil(HEIGHT / size)):
        for tx in range(math.ceil(WIDTH / size)):
            xs, ys = range(tx * size, min(WIDTH, tx * size + size)), range(ty * size, min(HEIGHT, ty * size + size))
            data = b"".join(struct.pack("<%d%s" % (len(xs), codes[kind]), *[value(name, x, y) for x in xs]) for y in ys for name, kind in channels)
            bodies.append(struct.pack("<5i", tx, ty, 0, 0, len(data)) + data)
    offsets, at = b"", len(start) + 8 * len(bodies)
    for body in bodies:
        offsets += struct.pack("<Q", at)
        at += len(body)
    return start + offsets + b"".join(bodies)


def layer(name, parts, kind=2):
    return [(name + "." + part, kind) for part in parts]


BLENDER = layer("ViewLayer.Depth", "Z") + layer("ViewLayer.Normal", "XYZ")
IDENTITY = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
CAMERAS = {
    "arnold": matrix("worldToCamera", IDENTITY) + matrix("worldToNDC", [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 1, 0, 0, -0.1, 0]) + text("arnold/version", "7"),
    "vray": matrix("cameraTransform", IDENTITY) + attribute("cameraFov", "float", struct.pack("<f", 1)) + attribute("cameraProjection", "int", struct.pack("<i", 0)),
    "redshift": matrix("rs/camera/transform", IDENTITY) + attribute("rs/camera/fov", "v2f", struct.pack("<2f", 60, 40)),
    "unreal": text("unreal/camera/curPos/x", "1") + text("unreal/camera/curRot/yaw", "30") + text("unreal/camera/FinalImage/fov", "60"),
    "standard": attribute("nominalFocalLength", "float", struct.pack("<f", 35)) + attribute("sensorOverallDimensions", "v2f", struct.pack("<2f", 36, 24)),
    "envmap": attribute("envmap", "envmap", b"\0"),
    "views": attribute("multiView", "stringvector", struct.pack("<i", 4) + b"left" + struct.pack("<i", 5) + b"right"),
    "script": text("<script>", "</script><b>\x1b[2J"),
}


DEEP = [("A", 1), ("Z", 2), ("ZBack", 2)]


def deep_row(y, columns):
    """The counts of a line, and its samples: 0 to 3 at a pixel, with volumes among them."""
    counts, samples = [(x + y) % 4 for x in columns], [[], [], []]
    for count in counts:
        for k in range(count):
            for channel, number in zip(samples, (1.0 if k else 0.6, 2.0 + k, 2.0 + k + k % 2)):
                channel.append(number)
    data = b"".join(struct.pack("<%d%s" % (len(numbers), "e" if kind == 1 else "f"), *numbers) for (_, kind), numbers in zip(DEEP, samples))
    return b"".join(struct.pack("<i", sum(counts[:i + 1])) for i in range(len(counts))), data


def deep_body(place, lines, columns, compression):
    rows = [deep_row(y, columns) for y in lines]
    table, data = b"".join(row[0] for row in rows), b"".join(row[1] for row in rows)
    pack = zipped if compression else bytes
    packed, samples = pack(table), pack(data) if data else b""
    return place + struct.pack("<QQQ", len(packed), len(samples), len(data)) + packed + samples


def deep(compression=0, size=0):
    """size: of tiles; 0: lines."""
    extra = text("type", "deeptile" if size else "deepscanline") + attribute("version", "int", struct.pack("<i", 1)) + text("name", "deep")
    if size:
        places = [(tx, ty) for ty in range(math.ceil(HEIGHT / size)) for tx in range(math.ceil(WIDTH / size))]
        bodies = [deep_body(struct.pack("<4i", tx, ty, 0, 0), range(ty * size, min(HEIGHT, ty * size + size)), range(tx * size, min(WIDTH, tx * size + size)), compression)
                  for tx, ty in places]
        extra += attribute("tiles", "tiledesc", struct.pack("<IIB", size, size, 0))
    else:
        bodies = [deep_body(struct.pack("<i", y), [y], range(WIDTH), compression) for y in range(HEIGHT)]
    extra += attribute("chunkCount", "int", struct.pack("<i", len(bodies)))
    start = struct.pack("<ii", 20000630, 2 | 0x800) + header(DEEP, compression, extra=extra)
    offsets, at = b"", len(start) + 8 * len(bodies)
    for body in bodies:
        offsets += struct.pack("<Q", at)
        at += len(body)
    return start + offsets + b"".join(bodies)


def counting_tile(first, channels=512):
    """One tile, a pixel wide, whose counts take 2^64 bytes, which is 0 of 64 bits: first as many of one sample, then the most that a count may be."""
    height, most, channels = 2 ** 22 + 2 ** 17, 2 ** 31 - 1, [("Z%04d" % i if i else "Z", 2) for i in range(channels)]
    counts, left = [1] * first, 2 ** 64 // (4 * len(channels)) - first
    counts += [most] * (left // most) + [left % most]
    table = struct.pack("<%di" % height, *counts, *[0] * (height - len(counts)))
    split = table[0::2] + table[1::2]
    packed = zlib.compress(bytes([split[0]]) + bytes((b - a + 128) % 256 for a, b in zip(split, split[1:])), 9)
    body = struct.pack("<4i", 0, 0, 0, 0) + struct.pack("<QQQ", len(packed), 0, 0) + packed
    extra = (text("type", "deeptile") + attribute("version", "int", struct.pack("<i", 1)) + text("name", "deep") +
             attribute("tiles", "tiledesc", struct.pack("<IIB", 1, height, 0)) + attribute("chunkCount", "int", struct.pack("<i", 1)))
    start = struct.pack("<ii", 20000630, 2 | 0x800) + header(channels, 2, (0, 0, 0, height - 1), extra)
    return start + struct.pack("<Q", len(start) + 8) + body


def deep_seeds():
    write("deep", "counts-beyond-the-end.exr", counting_tile(100000))
    write("deep", "counts-of-all-memory.exr", counting_tile(0))
    for name, data in {"lines": deep(), "zips": deep(2), "tiles": deep(0, 2), "zipped-tiles": deep(2, 4)}.items():
        write("deep", name + ".exr", data)


def exr_seeds():
    frames = {"blender": exr(BLENDER), "half": exr(layer("depth", "Z", 1) + layer("N", "XYZ", 1)), "zips": exr(BLENDER, 2), "zip": exr(BLENDER, 3),
              "integer": exr([("id", 0), ("Z", 2)]), "tiled": tiled(BLENDER), "position": exr(layer("P", "XYZ") + layer("N", "XYZ")),
              "parts": multi_part([("depth", [("Z", 2)]), ("normal", [("X", 2), ("Y", 2), ("Z", 2)])]),
              "script": exr(layer("<script>", "XYZ") + [("Z", 2)])}
    frames.update({name: exr([("Z", 2)] + layer("N", "XYZ"), extra=extra) for name, extra in CAMERAS.items() if name != "script"})
    frames["attributes"] = exr([("Z", 2)], extra=CAMERAS["script"] + attribute("d", "double", struct.pack("<d", 1)) + attribute("own", "mytype", b"123"))
    for name, data in frames.items():
        write("exr", name, data)


def dds_seeds():
    def dds(code, dx10, pixel):
        words = [124, 0x1007, 2, 2, 0, 0, 0] + [0] * 11 + [32, 4, 0x30315844 if dx10 else code, 0, 0, 0, 0, 0] + [0x1000, 0, 0, 0, 0]
        return b"DDS " + struct.pack("<31I", *words) + (struct.pack("<5I", code, 3, 0, 1, 0) if dx10 else b"") + pixel * 4
    for name, code, dx10, pixel in (("r32f", 41, True, struct.pack("<f", 1)), ("d24", 46, True, b"\0\0\x80\0"), ("r16", 56, True, b"\0\x80"),
                                    ("rgba16f", 10, True, struct.pack("<4e", 0, 1, 0, 1)), ("rgb10a2", 24, True, b"\1\2\3\4"), ("rgba8", 28, True, b"\1\2\3\4"),
                                    ("r32f-old", 114, False, struct.pack("<f", 1)), ("rgba32f-old", 116, False, struct.pack("<4f", 0, 1, 0, 1))):
        write("dds", name, dds(code, dx10, pixel))


def camera_seeds():
    plain = {"resolution": [64, 36], "fx": 60, "fy": 60.5, "cx": 32, "cy": 18}
    rotation = [[1, 0, 0, 0.5], [0, 0, 1, -2], [0, -1, 0, 3], [0, 0, 0, 1]]
    projection = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1.001, -0.1], [0, 0, -1, 0]]
    for name, more in {"plain": {}, "orthographic": {"projection": "orthographic", "pixel_aspect": 2}, "matrix": {"projection": projection, "reversed_z": True},
                       "world": {"world_to_camera": rotation, "depth": "planar", "normal_space": "world", "normal_encoding": "octahedral"},
                       "game": {"depth_kind": "device", "near": 0.1, "far": "inf", "camera_space": "left-handed, +z"},
                       "frames": {"frames": [{"frame": 0, "fx": 50}, {"frame": 1001, "world_to_camera": rotation}]}}.items():
        write("camera", name, json.dumps({**plain, **more}))


def text_seeds():
    for name, data in {"list": "l1001-1100x2,1200", "backwards": "l10-1x3 -5--1", "colon": "l1-9:2, 4", "printf": "nshot.%04d.exr", "hashes": "na/####.b",
                       "ats": "n@@@.exr", "houdini": "n$F4.exr", "nuke": "n<f4>.exr", "number": "nshot.0042.exr"}.items():
        write("frames", name, data)
    for name, data in {
            "rules": 'source = "cycles"\ndetect = ["Software=Blender*", "channel:ViewLayer.*"]\nlast = true\ndepth-channel = ["Depth.Z:planar"]\n'
                     'normal-channels = ["N:view"]\ndepth-kind = "device"\nnear = 0.1\nfar = 100\nreversed-z = true\nnormal-space = "world"\nnormal-encoding = "unorm"\n',
            "suite": 'title = "t"\nrepeats = 2\nreference-slices = 4\n[[frame]]\nname = "f"\ninput = "f.exr"\ncamera = "f.json"\nradius = 0.5\ntruth = ["a.exr"]\n'
                     '[[candidate]]\nname = "c"\npreset = "draft"\npower = 1.2\n[[sweep]]\nslices = [1, 2]\nsteps = [4, 8]\n',
            "limits": '[[limit]]\nframe = "f"\ncandidate = "c"\nrmse = 0.1\nestimator-rmse = 0.2\n',
            "values": 'a = """x\ny"""\nb = 0x1F\nc = 1e400\nd = -inf\ne = 1979-05-27\nf = {g = 1}\n"h.i" = \'j\'\n'}.items():
        write("toml", name, data)
    for name, data in {
            "estimator": 'estimator = "crytek"\nradius = [0.1, 0.5]\nslices = 2\nsteps = 16\nsamples = 8\nbias = 0.1\nfalloff = "linear"\n',
            "input": 'depth-kind = "device"\nnear = 0.1\nfar = "inf"\nreversed-z = true\nroi = "1,2,3,4"\nsky = 1000\nflip-normal = "xz"\n',
            "output": 'aov = "ao,normal"\ncompression = "piz"\nmulti-bounce = true\nframes = "1-10"\nchunk = "1/2"\nmemory = "512M"\nradius = 1\n',
            "wrong": 'slises = 2\nradius = -1\n'}.items():
        write("preset", name, data)


exr_seeds()
deep_seeds()
dds_seeds()
camera_seeds()
text_seeds()
