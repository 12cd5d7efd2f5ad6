# The camera exporter of Maya against a stub of maya.cmds, and against the film gates of Maya's documentation.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import tempfile
import types
import unittest

import camera_facts
from camera_facts import applied, inverse, stand_at, transposed


class Scene:
    """What the stub's functions answer from."""

    def __init__(self):
        self.frame = 7.0
        self.unit = "cm"
        self.selected = ["|rig|camera|cameraShape"]
        self.asked = []
        self.scale = 1.0
        self.resolution = {"width": 640, "height": 360, "deviceAspectRatio": 640 / 360}
        self.camera = {
            "orthographic": False, "orthographicWidth": 12.0, "filmFit": 0, "filmFitOffset": 0.0, "filmRollValue": 0.0,
            "filmTranslateH": 0.0, "filmTranslateV": 0.0, "shakeEnabled": False, "panZoomEnabled": False, "renderPanZoom": False,
            "horizontalFilmAperture": 1.417, "verticalFilmAperture": 0.945, "horizontalFilmOffset": 0.0, "verticalFilmOffset": 0.0,
            "focalLength": 35.0, "lensSqueezeRatio": 1.0, "cameraScale": 1.0, "preScale": 1.0, "postScale": 1.0,
            "nearClipPlane": 0.1, "farClipPlane": 1000.0,
        }


def stub(scene):
    cmds = types.ModuleType("maya.cmds")

    def get_attr(name):
        node, _, attribute = name.partition(".")
        if node == "defaultResolution":
            return scene.resolution[attribute]
        assert node == "|rig|camera|cameraShape", node
        if attribute == "worldMatrix[0]":  # 16 numbers, for row vectors
            return [x for row in transposed(stand_at(scene.frame, scene.scale)) for x in row]
        return scene.camera[attribute]

    def current_time(*frame, query=False, edit=False):
        assert query or (edit and len(frame) == 1)
        if edit:
            scene.frame = float(frame[0])
        return scene.frame

    def list_nodes(selection, dag, type, long):
        assert selection and dag and type == "camera" and long
        return scene.selected

    cmds.getAttr = get_attr
    cmds.currentTime = current_time
    cmds.currentUnit = lambda query, linear: scene.unit
    cmds.ls = list_nodes
    cmds.fileDialog2 = lambda **asked: scene.asked
    cmds.playbackOptions = lambda query, **end: 3.0 if "minTime" in end else 5.0
    return cmds


class Maya(camera_facts.CameraFacts, unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="alcove-maya-")
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "cameras.json")
        self.scene = Scene()
        maya = types.ModuleType("maya")
        maya.cmds = stub(self.scene)
        sys.modules.update({"maya": maya, "maya.cmds": maya.cmds})
        self.script = camera_facts.script("maya/alcove_maya.py")

    def camera(self, frame=4, **attributes):
        self.scene.camera.update(attributes)
        self.script.write_cameras(self.path, self.scene.selected[0], frame, frame)
        return self.entry(self.path, frame)

    def host_pixel(self, gate_width, gate_height, centre=(0, 0), frame=4):
        """Maya's film lies in inches behind the lens; the resolution gate is a rectangle on it. focalLength is in mm, and the
        camera's scale divides it."""
        focal = self.scene.camera["focalLength"] / 25.4 / self.scene.camera["cameraScale"]
        width, height = self.scene.resolution["width"], self.scene.resolution["height"]

        def see(point):
            x, y, z, _ = applied(inverse(stand_at(frame, self.scene.scale)), point)
            film = (focal * x / -z, focal * y / -z)
            u = (film[0] - (centre[0] - gate_width / 2)) / gate_width
            v = (film[1] - (centre[1] - gate_height / 2)) / gate_height
            return u * width, (1 - v) * height
        return see

    def test_each_film_fit_has_its_gate(self):
        wide, high = 640, 300  # wider and higher than the film, which has 1.417 x 0.945 inches, 1.4995
        for resolution, fit, gate in (
                ((wide, 360), 0, (1.417, 1.417 * 360 / wide)),  # fill: the gate lies within the film
                ((300, high), 0, (0.945, 0.945)),
                ((wide, 360), 1, (1.417, 1.417 * 360 / wide)),  # horizontal
                ((300, high), 1, (1.417, 1.417)),
                ((wide, 360), 2, (0.945 * wide / 360, 0.945)),  # vertical
                ((300, high), 2, (0.945, 0.945)),
                ((wide, 360), 3, (0.945 * wide / 360, 0.945)),  # overscan: the film lies within the gate
                ((300, high), 3, (1.417, 1.417))):
            with self.subTest(resolution=resolution, fit=fit):
                self.scene.resolution = {"width": resolution[0], "height": resolution[1],
                                         "deviceAspectRatio": resolution[0] / resolution[1]}
                self.assert_sees_as(self.camera(filmFit=fit), self.host_pixel(*gate))

    def test_film_offsets_move_the_gate(self):
        camera = self.camera(horizontalFilmOffset=0.2, verticalFilmOffset=-0.1)
        self.assert_sees_as(camera, self.host_pixel(1.417, 1.417 * 9 / 16, (0.2, -0.1)))
        self.assertLess(camera["cx"], 320)  # the film moves to the right, and what it shows to the left
        self.assertLess(camera["cy"], 180)

    def test_scales_of_the_film_and_the_camera(self):
        camera = self.camera(preScale=1.5, postScale=0.8, cameraScale=1.3, horizontalFilmOffset=0.2)
        gate = 1.417 / (1.5 * 0.8)
        self.assert_sees_as(camera, self.host_pixel(gate, gate * 9 / 16, (0.2, 0)))

    def test_squeezed_lenses_and_pixels_that_are_not_square(self):
        self.scene.resolution = {"width": 720, "height": 576, "deviceAspectRatio": 16 / 9}
        camera = self.camera(lensSqueezeRatio=2.0, filmFit=1, horizontalFilmOffset=0.1)
        self.assert_sees_as(camera, self.host_pixel(2.834, 2.834 * 9 / 16, (0.2, 0)))
        self.assertAlmostEqual(camera["fy"] / camera["fx"], (16 / 9) / (720 / 576), places=9)

    def test_scale_of_parents_takes_no_part(self):
        self.scene.scale = 3.0
        self.assert_sees_as(self.camera(), self.host_pixel(1.417, 1.417 * 9 / 16))

    def test_orthographic_cameras(self):
        for resolution, fit, shown in (((640, 360), 0, (12, 6.75)), ((640, 360), 3, (12 * 640 / 360, 12)), ((300, 400), 0, (9, 12)),
                                       ((300, 400), 1, (12, 16)), ((640, 360), 2, (12 * 640 / 360, 12))):
            with self.subTest(resolution=resolution, fit=fit):
                self.scene.resolution = {"width": resolution[0], "height": resolution[1],
                                         "deviceAspectRatio": resolution[0] / resolution[1]}

                def see(point):
                    x, y, _, _ = applied(inverse(stand_at(4)), point)
                    return resolution[0] * (0.5 + x / shown[0]), resolution[1] * (0.5 - y / shown[1])
                self.assert_sees_as(self.camera(orthographic=True, filmFit=fit), see)

    def test_lengths_are_centimetres(self):
        """Matrices always are; what getAttr gives as a length is in the unit of the user."""
        self.scene.unit = "m"
        camera = self.camera(orthographic=True, orthographicWidth=0.12)
        self.assertAlmostEqual(camera["fx"], 640 / 12)
        self.assertAlmostEqual(camera["near"], 10)
        self.assertAlmostEqual(camera["far"], 100000)

    def test_every_frame_is_set(self):
        self.scene.asked = [self.path]
        self.script.export()
        self.assertEqual([entry["frame"] for entry in self.entries(self.path)], [3, 4, 5])
        for frame in (3, 5):
            self.assert_sees_as(self.entry(self.path, frame), self.host_pixel(1.417, 1.417 * 9 / 16, frame=frame))
        self.assertEqual(self.scene.frame, 7)

    def test_what_is_not_taken_is_told(self):
        for attributes, what in (({"filmRollValue": 5.0}, "roll"), ({"filmTranslateV": 0.1}, "translation"), ({"shakeEnabled": True}, "shake"),
                                 ({"panZoomEnabled": True, "renderPanZoom": True}, "pan"), ({"filmFit": 1, "filmFitOffset": 0.1}, "fit offset"),
                                 ({"orthographic": True, "verticalFilmOffset": 0.1}, "film offset")):
            self.scene.camera = Scene().camera
            with self.subTest(what=what), self.assertRaisesRegex(ValueError, what):
                self.camera(**attributes)
        self.assertEqual(self.scene.frame, 7)
        self.assertFalse(os.path.exists(self.path))
        self.scene.camera = Scene().camera
        self.camera(panZoomEnabled=True, filmFitOffset=0.1)  # neither acts on what is rendered

    def test_a_camera_must_be_selected(self):
        self.scene.selected = []
        with self.assertRaisesRegex(ValueError, "Select"):
            self.script.export()
        self.scene.selected, self.scene.asked = ["|rig|camera|cameraShape"], None  # the dialog is left
        self.script.export()
        self.assertFalse(os.path.exists(self.path))


unittest.main(argv=sys.argv[:1])
