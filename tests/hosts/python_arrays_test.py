# Arrays through the library give the bits of the program's own files; what is wrong is an exception; and what the library shows and loads.
# Takes the program, the library, the project's folder, a frame and its camera.
# SPDX-License-Identifier: BSD-3-Clause
import json
import multiprocessing
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

import numpy

PROGRAM, LIBRARY, PROJECT, FRAME, CAMERA = (os.path.abspath(word) for word in sys.argv[1:6])
sys.dont_write_bytecode = True
sys.path[:0] = [os.path.join(PROJECT, "hosts/python"), os.path.join(PROJECT, "tests/support")]
os.environ["ALCOVE"] = PROGRAM

import alcove  # noqa: E402
from exr import read_exr, write_exr  # noqa: E402


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory(prefix="alcove-arrays-")
        cls.folder = pathlib.Path(cls.kept.name)
        # The shipped frame as the program reads it.
        planes = cls.program(FRAME, "--camera", CAMERA, "--aov", "depth,normal", "--set", "aov-space=world")
        cls.depth = planes["Z"]
        cls.normal = numpy.stack([planes["normal." + axis] for axis in "XYZ"], axis=-1)
        cls.frame = cls.folder / "shot.0007.exr"
        write_exr(cls.frame, {"Z": cls.depth, **{"N." + axis: cls.normal[:, :, i] for i, axis in enumerate("XYZ")}})
        with open(CAMERA, encoding="utf-8") as file:
            cls.camera = {**json.load(file), "depth": "planar", "normal_space": "world"}
        cls.camera_file = cls.folder / "camera.json"
        cls.camera_file.write_text(json.dumps(cls.camera), encoding="utf-8")

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    @classmethod
    def program(cls, *words):
        made = cls.folder / "made.exr"
        done = subprocess.run([PROGRAM, "run", *map(str, words), "-o", str(made), "--type", "float", "--set", "compression=none", "-q"],
                              capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return read_exr(made)

    def same(self, array, plane):
        self.assertEqual((array.dtype, array.shape), (numpy.float32, plane.shape))
        numpy.testing.assert_array_equal(array.view(numpy.uint32), numpy.ascontiguousarray(plane).view(numpy.uint32))

    def test_ao_has_the_bits_of_the_program(self):
        theirs = self.program(self.frame, "--camera", self.camera_file, "--radius", "0.35")["Y"]
        ours = alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35)
        self.same(ours, theirs)
        self.assertLess(ours.min(), 0.5)
        self.same(alcove.ao(self.depth, self.normal, camera=str(self.camera_file), radius=0.35), theirs)

    def test_depth_alone_and_a_field_of_view_are_enough(self):
        flat = self.folder / "flat.exr"
        write_exr(flat, {"Z": self.depth})
        theirs = self.program(flat, "--fov", "65", "--radius", "0.35")["Y"]
        self.same(alcove.ao(self.depth, radius=0.35, fov=65), theirs)

    def test_arrays_may_lie_anyhow(self):
        wanted = alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35)
        together = numpy.zeros((*self.depth.shape, 7), numpy.float32)
        together[:, :, 2:5], together[:, :, 6] = self.normal, self.depth
        flipped = numpy.flipud(together).copy()[::-1]
        for depth, normal in ((together[:, :, 6], together[:, :, 2:5]), (flipped[:, :, 6], flipped[:, :, 2:5]),
                              (self.depth.astype(numpy.float64), self.normal.astype(">f4")), (self.depth[:, :, None], numpy.asfortranarray(self.normal)),
                              (self.depth.tolist(), self.normal)):
            self.same(alcove.ao(depth, normal, camera=self.camera, radius=0.35), wanted)
        wanted = alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35, material_ao=numpy.full_like(self.depth, 0.5))
        for half in (numpy.broadcast_to(numpy.float32(0.5), self.depth.shape), numpy.broadcast_to(numpy.full((1, self.depth.shape[1]), 0.5), self.depth.shape)):
            self.same(alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35, material_ao=half), wanted)
        self.same(alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35, ignore=numpy.zeros(self.depth.shape, bool)),
                  alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35))

    def test_half_floats_are_known_as_such(self):
        half = self.folder / "half.exr"
        write_exr(half, {"Z": self.depth.astype(numpy.float16), **{"N." + axis: self.normal[:, :, i] for i, axis in enumerate("XYZ")}})
        theirs = self.program(half, "--camera", self.camera_file, "--radius", "0.35")["Y"]
        for kind in (numpy.float16, ">f2"):
            self.same(alcove.ao(self.depth.astype(kind), self.normal, camera=self.camera, radius=0.35), theirs)

    def test_depth_that_was_rounded_is_measured(self):
        rounded = self.folder / "rounded.exr"
        depth = numpy.round(self.depth * 50) / 50
        write_exr(rounded, {"Z": depth})
        theirs = self.program(rounded, "--fov", "65", "--radius", "0.35", "--depth-kind", "planar")["Y"]
        with self.assertWarnsRegex(UserWarning, "depth was rounded"):
            self.same(alcove.ao(depth, radius=0.35, fov=65, depth_kind="planar"), theirs)
        with self.assertWarnsRegex(UserWarning, "changes in steps of 1"):
            millimetres = alcove.ao((self.depth * 1000).astype(numpy.uint16), radius=0.35, fov=65, depth_scale=0.001)
        self.assertLess(numpy.sqrt(numpy.mean((millimetres - alcove.ao(self.depth, radius=0.35, fov=65))**2)), 0.02)
        with self.assertWarnsRegex(UserWarning, "is it ray"):
            height, width = self.depth.shape
            y, x = numpy.mgrid[0:height, 0:width] + 0.5
            pixel = 2 * numpy.tan(numpy.radians(65 / 2)) / width
            alcove.ao(self.depth * numpy.hypot(1, numpy.hypot(x - width / 2, y - height / 2) * pixel), radius=0.35, fov=65)

    def test_many_results_have_the_bits_of_the_program(self):
        names = ["ao", "bent-normal", "transfer", "ao-scales", "confidence", "specular-occlusion", "normal", "depth"]
        theirs = self.program(self.frame, "--camera", self.camera_file, "--radius", "0.1,0.35", "--preset", "production", "--slices", "3", "--aov", ",".join(names))
        made = alcove.compute(self.depth, self.normal, camera=self.camera, radius=[0.1, 0.35], preset="production", slices=3, aov=names)
        for name, channels in (("ao", ["Y"]), ("bent-normal", ["bent.X", "bent.Y", "bent.Z"]), ("transfer", ["transfer%d.%s" % (k, c) for k in range(3) for c in "XYZ"]), ("ao-scales", ["scale1.Y", "scale2.Y"]), ("confidence", ["confidence.Y"]),
                               ("specular-occlusion", ["specular.Y"]), ("normal", ["normal.X", "normal.Y", "normal.Z"]), ("depth", ["Z"])):
            planes = [theirs[channel] for channel in channels]
            self.same(made[name], planes[0] if len(planes) == 1 else numpy.stack(planes, axis=-1))
        self.assertGreater(made["stats"]["compute_ms"], 0)
        self.assertTrue(made["stats"]["device"])

    def test_what_lies_behind_counts(self):
        behind = self.folder / "behind.exr"
        deeper = self.depth * numpy.float32(1.25)
        write_exr(behind, {"Z": deeper})
        theirs = self.program(self.frame, "--camera", self.camera_file, "--radius", "0.35", "--behind", behind, "--behind-kind", "backs")["Y"]
        self.same(alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35, behind=deeper, behind_kind="backs"), theirs)
        self.assertTrue((theirs != alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35)).any())

    def test_positions_and_animated_noise(self):
        height, width = self.depth.shape
        y, x = numpy.mgrid[0:height, 0:width] + 0.5
        view = numpy.stack([(x - self.camera["cx"]) / self.camera["fx"] * self.depth, (self.camera["cy"] - y) / self.camera["fy"] * self.depth,
                            -self.depth], axis=-1)
        matrix = numpy.array(self.camera["world_to_camera"])
        world = ((view - matrix[:3, 3]) @ matrix[:3, :3]).astype(numpy.float32)
        ours = alcove.ao(None, self.normal, camera=self.camera, radius=0.35, position=world, position_space="world")
        by_depth = alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35)
        self.assertLess(numpy.sqrt(numpy.mean((ours - by_depth)**2)), 2e-3)
        theirs = self.program(self.folder / "shot.####.exr", "--frames", "7", "--camera", self.camera_file, "--radius", "0.35", "--noise", "animated")["Y"]
        self.same(alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35, noise="animated", frame=7), theirs)
        self.assertTrue((alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.35, noise="animated", frame=8) != theirs).any())

    def test_nothing_stays_of_a_call_before(self):
        wanted = alcove.ao(self.depth, radius=0.35, fov=65)
        alcove.compute(self.depth, self.normal, camera=self.camera, radius=0.2, preset="draft", slices=4, material_ao=numpy.full_like(self.depth, 0.5),
                       behind=[self.depth * 2], aov=["ao", "depth"])
        self.same(alcove.ao(self.depth, radius=0.35, fov=65), wanted)
        with self.assertRaises(alcove.UsageError):
            alcove.ao(self.depth, self.normal, camera=self.camera, radius=0.2, matte=self.depth, steps="many")
        self.same(alcove.ao(self.depth, radius=0.35, fov=65), wanted)

    def test_what_is_wrong_is_an_exception(self):
        good = {"radius": 0.35, "fov": 65}
        for kind, sentence, arguments in (
                (alcove.UsageError, "give 'radius', the reach of occluders", {"fov": 65}), (alcove.UsageError, "no camera.* 'fov' ", {"radius": 0.35}),
                (alcove.UsageError, r"no option slizes \(did you mean slices", {**good, "slizes": 3}), (alcove.UsageError, "out of range", {**good, "slices": 100}),
                (alcove.UsageError, "not available in the library", {**good, "beauty": "b.exr"}), (alcove.UsageError, "there is no preset", {**good, "preset": "nothing"}),
                (alcove.UsageError, "there is no AOV", {**good, "aov": "oa"}), (alcove.InputError, "camera.json", {"radius": 1, "camera": "/nowhere/camera.json"}),
                (alcove.InputError, "fx", {"radius": 1, "camera": {"fy": 1}}), (alcove.UsageError, r"normal.*\(H, W, 3\)", {**good, "normal": self.depth}),
                (alcove.UsageError, "normal.*uint8", {**good, "normal": self.normal.astype(numpy.uint8)}), (alcove.UsageError, "masked", {**good, "matte": numpy.ma.array(self.depth)}),
                (alcove.UsageError, "threads is not available", {**good, "threads": 4}), (alcove.UsageError, "behind.*uint8", {**good, "behind": self.depth.astype(numpy.uint8)}),
                (alcove.UsageError, "whole number", {**good, "frame": "7"}), (alcove.UsageError, "too large", {**good, "frame": 2**40}), (alcove.UsageError, "zero byte", {**good, "device": "a\0b"}),
                (alcove.UsageError, "only one of them", {**good, "camera": self.camera}), (alcove.InputError, "normal.*'normal_space' world", {"radius": 0.35, "camera": self.camera, "normal": self.normal, "normal_space": "view"}),
                (alcove.InputError, "has 4 x 4 pixels", {**good, "matte": numpy.ones((4, 4))}), (alcove.UsageError, "complex", {**good, "matte": self.depth + 1j}),
                (alcove.DeviceError, "no-such", {**good, "device": "no-such"})):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(kind, sentence):
                alcove.compute(self.depth, **arguments)
        with self.assertRaisesRegex(alcove.UsageError, "no depth"):
            alcove.compute(None, **good)
        with self.assertRaisesRegex(alcove.UsageError, "uint8.*256 distances"):
            alcove.ao((self.depth * 20).astype(numpy.uint8), **good)
        with self.assertRaisesRegex(alcove.InputError, "divide integers"):
            alcove.ao((self.depth * 1000).astype(numpy.uint16), depth_kind="normalized", far=60, **good)
        with self.assertRaisesRegex(alcove.InputError, "give -depth"):
            alcove.ao(-self.depth[:, :], sky=1e8, **good)
        with self.assertRaisesRegex(alcove.UsageError, "compute"):
            alcove.ao(self.depth, aov="depth", **good)
        with self.assertRaisesRegex(alcove.UsageError, "dict"):
            alcove.run(FRAME, output=self.folder / "none.exr", camera=self.camera, radius=1)
        with self.assertRaisesRegex(alcove.UsageError, r"\(3,\)"):
            alcove.ao([1, 2, 3], **good)

    def test_threads_have_devices_of_their_own(self):
        found = {}

        def work(radius):
            found[radius] = alcove.ao(self.depth, radius=radius, fov=65)

        threads = [threading.Thread(target=work, args=(radius,)) for radius in (0.2, 0.35, 0.6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(found), [0.2, 0.35, 0.6])
        for radius, array in found.items():
            self.same(array, alcove.ao(self.depth, radius=radius, fov=65))

    def test_a_forked_process_has_a_device_of_its_own(self):
        alcove.ao(self.depth, radius=0.35, fov=65)
        child = multiprocessing.get_context("fork").Process(target=self.in_child)
        child.start()
        child.join(60)
        if child.exitcode is None:
            child.kill()
        self.assertEqual(child.exitcode, 0)

    def in_child(self):
        alcove.ao(self.depth, radius=0.2, fov=65)

    def test_what_may_be_wrong_is_a_warning(self):
        with self.assertWarnsRegex(UserWarning, "radius"):
            made = alcove.compute(self.depth, radius=100, fov=65)
        self.assertEqual(len(made["stats"]["notes"]), 1)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertEqual(alcove.compute(self.depth, radius=0.35, fov=65)["stats"]["notes"], [])

    def test_a_library_that_is_not_there_is_told(self):
        code = "import alcove, numpy; alcove.ao(numpy.ones((4, 4)), radius=1, fov=60)"
        done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=False,
                              env={**os.environ, "ALCOVE_LIBRARY": "/nowhere/libalcove.so", "PYTHONPATH": os.path.join(PROJECT, "hosts/python")})
        self.assertRegex(done.stderr, "DeviceError.*/nowhere/libalcove.so.*ALCOVE_LIBRARY")

    def test_the_library_shows_its_header_and_loads_no_file_formats(self):
        shown = subprocess.run(["nm", "-D", "--defined-only", LIBRARY], capture_output=True, text=True, check=True).stdout
        names = {line.split()[2].split("@")[0] for line in shown.splitlines()} - {"ALCOVE_0"}
        header = (pathlib.Path(PROJECT) / "api/alcove/alcove.h").read_text(encoding="utf-8")
        self.assertEqual(names, set(re.findall(r"^ALCOVE_API .*?\b(alcove_\w+)\(", header, re.M)))
        needed = subprocess.run(["readelf", "-d", LIBRARY], capture_output=True, text=True, check=True).stdout
        self.assertIn("[libvulkan.so.1]", needed)
        self.assertIn("[libalcove.so.0]", needed)
        self.assertNotRegex(needed.lower(), "openexr|imath|opencolorio|openimageio|png")


unittest.main(argv=sys.argv[:1])
