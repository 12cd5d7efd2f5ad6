#!/usr/bin/env python3
# The add-on in a real Blender, without a window: stills, an animation, composites, errors, and cameras against those that positions tell.
# SPDX-License-Identifier: BSD-3-Clause
"""blender_test.py PROGRAM SOURCE_FOLDER: exit code 77 where there is no Blender, which in CI is an error."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))
from exr import read_exr  # noqa: E402

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), sys.argv[2]
FOLDER = tempfile.mkdtemp(prefix="alcove-blender-")


def alcove(*words):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def path(name):
    return os.path.join(FOLDER, name)


class Blender(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        here = os.path.dirname(os.path.abspath(__file__))
        done = subprocess.run(
            ["blender", "-b", "--factory-startup", "--python-exit-code", "9", "--python", os.path.join(here, "blender_scene.py"),
             "--", os.path.join(SOURCE, "hosts/blender/alcove.py"), os.path.join(SOURCE, "docs/outputs.md"), FOLDER],
            env=dict(os.environ, ALCOVE=PROGRAM), capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        with open(path("facts.json"), encoding="utf-8") as file:
            cls.facts = json.load(file)

    def test_a_still_is_computed_and_loaded(self):
        self.assertEqual(self.facts["still"], ["FINISHED"])
        [(image, source, has_data)] = self.facts["image of the still"]
        self.assertEqual((image, source, has_data), (path("ao.0002.exr"), "FILE", True))
        self.assertEqual(self.facts["wired"], ["CompositorNodeMixRGB"])

    def test_its_nodes_lie_beside_the_others_in_a_frame_and_the_result_is_shown(self):
        self.assertEqual(self.facts["on top of each other"], [])
        self.assertEqual(self.facts["in the frame"], ["CompositorNodeImage", "CompositorNodeMixRGB"])
        self.assertEqual(self.facts["active"], "Alcove")
        if self.facts["has an editor"]:
            self.assertEqual(self.facts["shown"], [path("ao.0002.exr")])

    def test_the_radius_it_shows_is_what_the_program_proposes(self):
        command = alcove("inspect", path("frame.0002.exr"), "--camera", path("written.json")).splitlines()[-1].split()
        self.assertEqual(self.facts["proposed radius"], float(command[command.index("--radius") + 1]))
        self.assertEqual(self.facts["shown radius"], self.facts["proposed radius"])

    def test_nothing_of_the_users_changes(self):
        self.assertTrue(self.facts["output is the user's"])
        self.assertTrue(self.facts["the compositor that was there stays"])
        self.assertEqual(self.facts["frame stays"], 5)
        self.assertEqual(self.facts["handlers"], 0)
        self.assertEqual(self.facts["handlers at the end"], 0)

    def test_an_animation_is_computed_and_loaded(self):
        self.assertEqual(self.facts["animation"], ["FINISHED"])
        self.assertEqual(self.facts["images of the animation"], [["SEQUENCE", 1, 5]])
        for frame in range(1, 6):
            self.assertTrue(os.path.getsize(path("ao.%04d.exr" % frame)) > 0)

    def test_the_ao_is_that_of_the_command_line(self):
        for frame in (1, 4):
            alcove("run", path("frame.%04d.exr" % frame), "-o", path("again.exr"), "--camera", path("written.json"), "--radius",
                   "0.5", "--frames", str(frame), "-q")
            alcove("compare", path("again.exr"), path("ao.%04d.exr" % frame), "--max-rmse", "0")

    def test_a_composite_is_made(self):
        self.assertEqual(self.facts["composite"], ["FINISHED"])
        self.assertIn("ViewLayer.Combined.R", alcove("inspect", path("composite.0005.exr")))

    def test_the_node_group_of_a_sky_lights_as_the_program_does(self):
        self.assertEqual(self.facts["relit"], ["FINISHED"])
        alcove("run", path("frame.0003.exr"), "-o", path("lit.exr"), "--camera", path("written.json"), "--radius", "0.5", "--frames", "3",
               "--environment", path("sky.exr"), "-q")
        alcove("compare", path("relit.exr"), path("lit.exr"), "--channel", "R=relight.R,G=relight.G,B=relight.B", "--max-rmse", "0.001")

    def test_the_nodes_of_the_page_light_by_a_sun_and_darken_its_pass(self):
        shadows = read_exr(path("shadows.exr"))
        seen, normal = shadows["shadow-key.Y"].astype(float), [shadows["normal." + axis].astype(float) for axis in "XYZ"]
        cosine = sum(x * part for x, part in zip(numpy.array([0.5, -0.3, 0.8]) / 0.98 ** 0.5, normal))
        self.assertGreater(numpy.count_nonzero((seen == 0) & (cosine > 0.1)), 50, "there is no shadow")
        self.assertGreater(numpy.count_nonzero((seen == 1) & (cosine > 0.1)), 1000)
        relit, darkened = read_exr(path("relit by key.exr")), read_exr(path("darkened by key.exr"))
        with open(os.path.join(SOURCE, "docs/outputs.md"), encoding="utf-8") as file:
            page = file.read()
        [lit] = re.findall('temp_expr0 "(shadow_key.*?)"', page)
        lit = eval(re.sub(r"\w+\.[XYZ]", lambda name: "planes['%s']" % name.group(), lit),  # Nuke's
                   {"max": numpy.maximum, "planes": {"shadow_key.Y": seen, **{"normal." + axis: part for axis, part in zip("XYZ", normal)}}})
        for number, (channel, color, factor) in enumerate(zip("RGB", (3, 2.8, 2.5), (0.5, 0.25, 2))):
            light = color * seen * numpy.maximum(0, cosine)
            numpy.testing.assert_allclose(relit[channel], light, atol=2e-3)
            numpy.testing.assert_allclose(darkened[channel], factor * seen, atol=1e-3)
            [scale] = re.findall(r'expr%d "(\S+) \* lit"' % number, page)
            numpy.testing.assert_allclose(float(scale) * lit, light, atol=2e-3)

    def test_cameras_are_those_that_the_positions_tell(self):
        with open(path("written.json"), encoding="utf-8") as file:
            written = {entry["frame"]: entry for entry in json.load(file)["frames"]}
        with open(path("animation.json"), encoding="utf-8") as file:
            rendered = {entry["frame"]: entry for entry in json.load(file)["frames"]}
        self.assertEqual(sorted(written), [1, 2, 3, 4, 5])
        self.assertNotEqual(written[3]["fx"], written[4]["fx"])  # a marker switches cameras
        self.assertNotEqual(written[1]["world_to_camera"], written[2]["world_to_camera"])
        for frame, camera in written.items():
            alcove("inspect", path("frame.%04d.exr" % frame), "--write-camera", path("told.json"))
            with open(path("told.json"), encoding="utf-8") as file:
                told = json.load(file)
            self.assertEqual(camera["resolution"], [80, 60])
            self.assertEqual(camera, rendered[frame])
            for name in ("fx", "fy", "cx", "cy"):
                self.assertAlmostEqual(camera[name], told[name], delta=0.01)
            for row, other in zip(camera["world_to_camera"], told["world_to_camera"]):
                for x, y in zip(row, other):
                    self.assertAlmostEqual(x, y, delta=1e-4)

    def test_an_orthographic_camera_sees_what_blender_sees(self):
        camera, point = self.facts["orthographic"], self.facts["Suzanne"]
        self.assertEqual(camera["projection"], "orthographic")
        view = [sum(m * p for m, p in zip(row, point + [1])) for row in camera["world_to_camera"]]
        x, y, _ = self.facts["where Blender sees Suzanne"]
        self.assertAlmostEqual(camera["cx"] + camera["fx"] * view[0], 80 * x, delta=1e-3)
        self.assertAlmostEqual(camera["cy"] - camera["fy"] * view[1], 60 * (1 - y), delta=1e-3)

    def test_the_line_for_a_shot_makes_ao_of_its_vectors_and_cameras(self):
        with open(os.path.join(SOURCE, "docs/getting-started.md"), encoding="utf-8") as file:
            [line] = [line.split() for line in file if "--accumulate" in line]
        done = subprocess.run([PROGRAM, *line[1:], "--stats", "stats.json"], cwd=path("by hand"), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("warning", done.stderr)
        with open(path("by hand/stats.json"), encoding="utf-8") as file:
            frames = json.load(file)["frames"]
        self.assertEqual(len(frames), 5)
        self.assertGreater(frames[1]["frames_per_pixel"], 1.5, "three frames lie before the cut")
        for frame in frames:
            self.assertTrue(os.path.getsize(path("by hand/ao.%04d.exr" % frame["frame"])) > 0)

    def test_errors_reach_the_user(self):
        self.assertIn("ao.0006.exr", self.facts["error of the program"])
        self.assertIn("exit code 4", self.facts["error of the program"])
        self.assertIn("no camera", self.facts["error without a camera"])
        self.assertIn("preferences", self.facts["error without the program"])


if __name__ == "__main__":
    if not shutil.which("blender"):
        print("there is no blender: the add-on is not tested")
        sys.exit(1 if os.environ.get("CI") else 77)
    try:
        result = unittest.main(argv=sys.argv[:1], exit=False).result
    finally:
        shutil.rmtree(FOLDER)
    sys.exit(not result.wasSuccessful())
