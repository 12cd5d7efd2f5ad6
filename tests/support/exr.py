# EXRs without compression, as arrays.
# SPDX-License-Identifier: BSD-3-Clause
import pathlib
import re
import struct

import numpy

TYPES = {1: numpy.dtype("<f2"), 2: numpy.dtype("<f4")}


def write_exr(path, planes):
    """Planes by their channels' names, as an EXR without compression."""
    height, width = next(iter(planes.values())).shape
    names = sorted(planes)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iiii", 1 if planes[name].dtype == numpy.float16 else 2, 0, 1, 1) for name in names)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = b"\x76\x2f\x31\x01\x02\0\0\0"
    for name, kind, value in (("channels", "chlist", channels + b"\0"), ("compression", "compression", b"\0"), ("dataWindow", "box2i", window),
                              ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
                              ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))):
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    head += b"\0"
    lines = []
    for y in range(height):
        data = b"".join(planes[name][y].tobytes() for name in names)
        lines.append(struct.pack("<ii", y, len(data)) + data)
    offsets, at = [], len(head) + 8 * height
    for line in lines:
        offsets.append(at)
        at += len(line)
    pathlib.Path(path).write_bytes(head + struct.pack(f"<{height}Q", *offsets) + b"".join(lines))


def read_exr(path):
    """The planes of an EXR without compression, by their channels' names."""
    data = pathlib.Path(path).read_bytes()
    fields, at = {}, 8
    while data[at]:
        words = []
        for _ in range(2):
            end = data.index(b"\0", at)
            words.append(data[at:end].decode())
            at = end + 1
        size = struct.unpack_from("<i", data, at)[0]
        fields[words[0]] = data[at + 4:at + 4 + size]
        at += 4 + size
    left, top, right, bottom = struct.unpack("<4i", fields["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels = [(name.decode(), TYPES[kind]) for name, kind in
                ((match.group(1), struct.unpack("<i", match.group(2))[0]) for match in re.finditer(rb"([^\0]+)\0(....)....\x01\0\0\0\x01\0\0\0", fields["channels"], re.S))]
    planes = {name: numpy.empty((height, width), kind) for name, kind in channels}
    for offset in struct.unpack_from(f"<{height}Q", data, at + 1):
        y = struct.unpack_from("<i", data, offset)[0] - top
        place = offset + 8
        for name, kind in channels:
            planes[name][y] = numpy.frombuffer(data, kind, width, place)
            place += kind.itemsize * width
    return planes
