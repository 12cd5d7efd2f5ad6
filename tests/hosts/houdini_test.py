# The camera exporter of Houdini against a stub of hou, and against the lens and the screen window of Houdini's documentation.
# SPDX-License-Identifier: BSD-3-Clause
import sys
import types
import unittest

import camera_facts
from camera_facts import applied, inverse, stand_at, transposed

FRAMES_PER_SECOND = 25


class Parm:
    """A parameter, whose value may be a function of the frame."""

    def __init__(self, value):
        self.value = value

    def evalAtFrame(self, frame):
        return self.value(frame) if callable(self.value) else self.value

    def evalAsStringAtFrame(self, frame):
        return str(self.evalAtFrame(frame))


class Matrix:
    """For row vectors, as Houdini's are."""

    def __init__(self, rows):
        self.rows = rows

    def asTuple(self):
        return tuple(x for row in self.rows for x in row)


class Camera:
    def __init__(self):
        self.scale = 1.0
        self.parms = {"projection": "perspective", "orthowidth": 8.0, "focal": 50.0, "aperture": 41.4214, "resx": 640, "resy": 360,
                      "aspect": 1.0, "winx": 0.0, "winy": 0.0, "winsizex": 1.0, "winsizey": 1.0, "near": 0.01, "far": 1000.0}

    def path(self):
        return "/obj/cam1"

    def parm(self, name):
        return Parm(self.parms[name]) if name in self.parms else None

    def worldTransformAtTime(self, time):
        return Matrix(transposed(stand_at(time * FRAMES_PER_SECOND + 1, self.scale)))


class Houdini(camera_facts.CameraFacts):
    def setUp(self):
        super().setUp()
        self.node = Camera()
        hou = types.ModuleType("hou")
        hou.frameToTime = lambda frame: (frame - 1) / FRAMES_PER_SECOND
        hou.selectedNodes = lambda: (self.node,)
        hou.fileChooserMode = types.SimpleNamespace(Write="write")
        hou.ui = types.SimpleNamespace(selectFile=lambda title, pattern, chooser_mode: "$HIP/cameras.json")
        hou.text = types.SimpleNamespace(expandString=lambda text: text.replace("$HIP", str(self.folder)))
        hou.playbar = types.SimpleNamespace(frameRange=lambda: (2.0, 4.0))
        self.hou = sys.modules["hou"] = hou
        self.script = camera_facts.script("houdini/alcove_houdini.py")

    def change(self, parms):
        self.node.parms.update(parms)

    def host_pixel(self, frame=4):
        """Houdini's picture is 0 to 1 wide and high, upwards; the aperture is its width, and its height follows from resolution
        and pixel aspect. Of it the screen window is shown, which lies about 0.5 + win and is winsize wide and high."""
        at = {name: Parm(value).evalAtFrame(frame) for name, value in self.node.parms.items()}

        def see(point):
            x, y, z, _ = applied(inverse(stand_at(frame, self.node.scale)), point)
            across, divisor = (at["aperture"] / at["focal"], -z) if at["projection"] == "perspective" else (at["orthowidth"], 1)
            upwards = across * at["resy"] / (at["resx"] * at["aspect"])
            picture = 0.5 + x / divisor / across, 0.5 + y / divisor / upwards
            window = [(picture[i] - (0.5 + at[win] - at[size] / 2)) / at[size]
                      for i, (win, size) in enumerate((("winx", "winsizex"), ("winy", "winsizey")))]
            return window[0] * at["resx"], (1 - window[1]) * at["resy"]
        return see

    def test_cameras_see_as_houdini_does(self):
        for parms in ({}, {"resx": 300, "resy": 500, "focal": 24.0}, {"aspect": 2.0, "winsizex": 0.5}):
            with self.subTest(parms=parms):
                self.assert_sees(**parms)
        camera = self.assert_sees(projection="ortho", winx=0.1, winsizey=0.5, aspect=1.5)
        self.assertEqual(camera["projection"], "orthographic")

    def test_screen_window(self):
        camera = self.assert_sees(winx=0.1, winy=-0.05, winsizex=0.8, winsizey=0.6)
        self.assertLess(camera["cx"], 320)  # the window moves to the right, and what it shows to the left
        self.assertLess(camera["cy"], 180)

    def test_scale_of_parents_takes_no_part_and_clip_planes_do(self):
        self.node.scale = 0.25
        camera = self.assert_sees(near=0.5, far=80.0)
        self.assertEqual((camera["near"], camera["far"]), (0.5, 80))

    def test_every_frame_has_its_lens_and_place(self):
        self.node.parms["focal"] = lambda frame: 40 + frame
        self.assert_exports([2, 3, 4])

    def test_what_is_not_taken_is_told(self):
        self.assert_refused("/obj/cam1 is sphere", projection="sphere")
        for words, x, y in (("sheared", [1, 0, 0, 0], [0.5, 1, 0, 0]), ("mirrored", [-1, 0, 0, 0], [0, 1, 0, 0]),
                            ("nothing", [0, 0, 0, 0], [0, 1, 0, 0])):
            self.node.worldTransformAtTime = lambda time: Matrix([x, y, [0, 0, 1, 0], [0, 0, 0, 1]])
            self.assert_refused(words, projection="perspective")

    def test_a_camera_must_be_selected(self):
        def select(is_camera):
            self.hou.selectedNodes = lambda: (self.node,) if is_camera else ()

        self.assert_needs_a_selection(select, lambda: setattr(self.hou.ui, "selectFile", lambda **asked: ""))

    def test_all_hosts_take_scale_away_by_the_same_lines(self):
        """Each script is one file, so that it is easy to install; what they share must not drift apart."""
        def lines_of(path):
            text = (camera_facts.HOSTS / path).read_text(encoding="utf-8")
            return text[text.index("def world_to_camera"):].split("\n\n\n")[0]
        here = lines_of("houdini/alcove_houdini.py")
        self.assertGreater(len(here.splitlines()), 8)
        for path in ("nuke/alcove_nuke.py", "maya/alcove_maya.py", "max/alcove_max.py"):
            self.assertEqual(lines_of(path), here, path)


unittest.main(argv=sys.argv[:1])
