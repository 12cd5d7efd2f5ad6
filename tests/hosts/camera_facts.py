# What the tests of cameras share: Alcove's conventions, written once more, and matrices that hosts keep.
# SPDX-License-Identifier: BSD-3-Clause
import importlib.util
import json
import math
import pathlib
import sys
import tempfile
import unittest

import jsonschema

sys.dont_write_bytecode = True  # beside the scripts
HOSTS = pathlib.Path(__file__).resolve().parents[2] / "hosts"
SCHEMA = jsonschema.Draft202012Validator(json.loads((HOSTS.parent / "docs/camera.schema.json").read_text(encoding="utf-8")))

# Points in front of cameras that stand_at() gives.
POINTS = [(0.3, -0.2, 0.1), (-1.2, 0.7, 0.4), (0.9, 1.1, -0.6), (0, 0, 0)]


def script(path):
    """A script of hosts/ as a module; the stub of its host must be there."""
    spec = importlib.util.spec_from_file_location(pathlib.Path(path).stem, HOSTS / path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(matrix):
    """By Gauss and Jordan: knows nothing of rotations."""
    rows = [list(row) + [float(i == j) for j in range(4)] for i, row in enumerate(matrix)]
    for i in range(4):
        pivot = max(range(i, 4), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for r in range(4):
            if r != i:
                rows[r] = [x - rows[r][i] * y for x, y in zip(rows[r], rows[i])]
    return [row[4:] for row in rows]


def transposed(matrix):
    return [list(column) for column in zip(*matrix)]


def applied(matrix, point):
    """The product with a column vector."""
    return [sum(a * b for a, b in zip(row, [*point, 1])) for row in matrix]


def stand_at(frame, scale=1.0):
    """The transform of a camera to the world, for column vectors: some 5 units away from the origin, which it nearly looks at,
    turned about all axes; it moves with the frame."""
    yaw, pitch, roll = 0.4 + 0.1 * frame, -0.25, 0.15
    turns = [
        [[math.cos(yaw), 0, math.sin(yaw), 0], [0, 1, 0, 0], [-math.sin(yaw), 0, math.cos(yaw), 0], [0, 0, 0, 1]],
        [[1, 0, 0, 0], [0, math.cos(pitch), -math.sin(pitch), 0], [0, math.sin(pitch), math.cos(pitch), 0], [0, 0, 0, 1]],
        [[math.cos(roll), -math.sin(roll), 0, 0], [math.sin(roll), math.cos(roll), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        [[scale, 0, 0, 0], [0, scale, 0, 0], [0, 0, scale, 0], [0, 0, 0, 1]],
    ]
    matrix = [[float(i == j) for j in range(4)] for i in range(4)]
    for turn in turns:
        matrix = product(matrix, turn)
    for i in range(3):
        matrix[i][3] = 5 * matrix[i][2] / scale + (0.2, 0.1, -0.3)[i]
    return matrix


def pixel(camera, point):
    """Where Alcove sees a point of the world: px from the left and the upper edge."""
    x, y, z, _ = applied(camera["world_to_camera"], point)
    divisor = 1 if camera["projection"] == "orthographic" else -z
    return camera["cx"] + camera["fx"] * x / divisor, camera["cy"] - camera["fy"] * y / divisor


class CameraFacts(unittest.TestCase):
    """Of a host whose `script` writes the cameras of `node`. It has change(settings) and host_pixel(frame), which gives the host's
    own formulas for the pixel of a point."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="alcove-hosts-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.path = str(self.folder / "cameras.json")

    def camera(self, frame=4, **settings):
        self.change(settings)
        self.script.write_cameras(self.path, self.node, frame, frame)
        return self.entry(self.path, frame)

    def assert_sees(self, frame=4, **settings):
        """With these settings, points of the world land where the host's own formulas put them."""
        camera = self.camera(frame, **settings)
        self.assert_sees_as(camera, self.host_pixel(frame))
        return camera

    def assert_exports(self, frames):
        self.script.export()
        self.assertEqual([entry["frame"] for entry in self.entries(self.path)], frames)
        for frame in (frames[0], frames[-1]):
            self.assert_sees_as(self.entry(self.path, frame), self.host_pixel(frame))

    def assert_refused(self, words, **settings):
        with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
            self.camera(**settings)
        self.assertFalse(pathlib.Path(self.path).exists())

    def assert_needs_a_selection(self, select, leave_dialog):
        """select(False) selects no camera, select(True) one."""
        select(False)
        with self.assertRaisesRegex(ValueError, "Select"):
            self.script.export()
        select(True)
        leave_dialog()
        self.script.export()
        self.assertFalse(pathlib.Path(self.path).exists())

    def entries(self, path):
        """The cameras of a file that the schema takes."""
        written = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        SCHEMA.validate(written)
        return written["frames"]

    def entry(self, path, frame):
        """The camera of a frame."""
        [entry] = [entry for entry in self.entries(path) if entry["frame"] == frame]
        for name in ("resolution", "fx", "fy", "cx", "cy", "world_to_camera"):
            self.assertIn(name, entry)
        return entry

    def assert_rigid(self, camera):
        """Lengths and angles in the camera's space are those of the world, and right and left are not exchanged."""
        rows = [row[:3] for row in camera["world_to_camera"][:3]]
        for i in range(3):
            for j in range(3):
                self.assertAlmostEqual(sum(a * b for a, b in zip(rows[i], rows[j])), float(i == j), places=9)
        (a, b, c), (d, e, f), (g, h, i) = rows
        self.assertGreater(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g), 0)
        self.assertEqual(camera["world_to_camera"][3], [0, 0, 0, 1])

    def assert_sees_as(self, camera, host_pixel):
        """Points of the world land where the host's own formulas put them."""
        self.assert_rigid(camera)
        seen = [pixel(camera, point) for point in POINTS]
        for point, (x, y) in zip(POINTS, seen):
            host_x, host_y = host_pixel(point)
            self.assertAlmostEqual(x, host_x, delta=1e-6, msg="x of %s" % (point,))
            self.assertAlmostEqual(y, host_y, delta=1e-6, msg="y of %s" % (point,))
        # What is compared must depend on the camera: points are well apart.
        self.assertGreater(max(x for x, _ in seen) - min(x for x, _ in seen), 20)
        self.assertGreater(max(y for _, y in seen) - min(y for _, y in seen), 20)
