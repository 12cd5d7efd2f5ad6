# The camera exporter of Maya against a stub of maya.cmds, and against the film gates of Maya's documentation.
# SPDX-License-Identifier: BSD-3-Clause
import sys
import types
import unittest

import camera_facts
from camera_facts import applied, inverse, stand_at, transposed


WIDE, FULL = (640, 360), (1.417, 1.417 * 9 / 16)  # a picture, and its part of the film with the usual settings


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


class Maya(camera_facts.CameraFacts):
    def setUp(self):
        super().setUp()
        self.scene = Scene()
        self.node = self.scene.selected[0]
        self.show(WIDE, *FULL)
        maya = types.ModuleType("maya")
        maya.cmds = stub(self.scene)
        sys.modules.update({"maya": maya, "maya.cmds": maya.cmds})
        self.script = camera_facts.script("maya/alcove_maya.py")

    def change(self, attributes):
        self.scene.camera.update(attributes)

    def show(self, resolution, width, height, centre=(0, 0), aspect=None):
        """The picture, and what it shows: a rectangle on the film in inches; of an orthographic camera one of the scene."""
        self.scene.resolution = {"width": resolution[0], "height": resolution[1],
                                 "deviceAspectRatio": aspect or resolution[0] / resolution[1]}
        self.shown = width, height, centre

    def host_pixel(self, frame=4):
        """Maya's film lies behind the lens. focalLength is in mm, and the camera's scale divides it."""
        focal = self.scene.camera["focalLength"] / 25.4 / self.scene.camera["cameraScale"]
        gate_width, gate_height, centre = self.shown
        width, height = self.scene.resolution["width"], self.scene.resolution["height"]

        def see(point):
            x, y, z, _ = applied(inverse(stand_at(frame, self.scene.scale)), point)
            film = (x, y) if self.scene.camera["orthographic"] else (focal * x / -z, focal * y / -z)
            u = (film[0] - (centre[0] - gate_width / 2)) / gate_width
            v = (film[1] - (centre[1] - gate_height / 2)) / gate_height
            return u * width, (1 - v) * height
        return see

    def test_each_film_fit_has_its_gate(self):
        tall = (300, 300)  # the film has 1.417 x 0.945 inches, 1.4995
        across, within, beyond = (0.945, 0.945), (1.417, 1.417), (0.945 * 640 / 360, 0.945)
        for resolution, fit, gate in (
                (WIDE, 0, FULL), (tall, 0, across),  # fill: the gate lies within the film
                (WIDE, 1, FULL), (tall, 1, within),  # horizontal
                (WIDE, 2, beyond), (tall, 2, across),  # vertical
                (WIDE, 3, beyond), (tall, 3, within)):  # overscan: the film lies within the gate
            with self.subTest(resolution=resolution, fit=fit):
                self.show(resolution, *gate)
                self.assert_sees(filmFit=fit)

    def test_film_offsets_move_the_gate(self):
        self.show(WIDE, *FULL, (0.2, -0.1))
        camera = self.assert_sees(horizontalFilmOffset=0.2, verticalFilmOffset=-0.1)
        self.assertLess(camera["cx"], 320)  # the film moves to the right, and what it shows to the left
        self.assertLess(camera["cy"], 180)

    def test_scales_of_the_film_and_the_camera_count_and_that_of_parents_does_not(self):
        gate = 1.417 / (1.5 * 0.8)
        self.show(WIDE, gate, gate * 9 / 16, (0.2, 0))
        self.scene.scale = 3.0
        self.assert_sees(preScale=1.5, postScale=0.8, cameraScale=1.3, horizontalFilmOffset=0.2)

    def test_squeezed_lenses_and_pixels_that_are_not_square(self):
        self.show((720, 576), 2.834, 2.834 * 9 / 16, (0.2, 0), aspect=16 / 9)
        camera = self.assert_sees(lensSqueezeRatio=2.0, filmFit=1, horizontalFilmOffset=0.1)
        self.assertAlmostEqual(camera["fy"] / camera["fx"], (16 / 9) / (720 / 576), places=9)

    def test_orthographic_cameras(self):
        for resolution, fit, shown in ((WIDE, 0, (12, 6.75)), (WIDE, 3, (12 * 640 / 360, 12)), ((300, 400), 0, (9, 12)),
                                       ((300, 400), 1, (12, 16)), (WIDE, 2, (12 * 640 / 360, 12))):
            with self.subTest(resolution=resolution, fit=fit):
                self.show(resolution, *shown)
                self.assert_sees(orthographic=True, filmFit=fit)

    def test_lengths_are_centimetres(self):
        """Matrices always are; what getAttr gives as a length is in the unit of the user."""
        self.scene.unit = "m"
        camera = self.camera(orthographic=True, orthographicWidth=0.12)
        self.assertAlmostEqual(camera["fx"], 640 / 12)
        self.assertAlmostEqual(camera["near"], 10)
        self.assertAlmostEqual(camera["far"], 100000)

    def test_every_frame_is_set(self):
        self.scene.asked = [self.path]
        self.assert_exports([3, 4, 5])
        self.assertEqual(self.scene.frame, 7)

    def test_what_is_not_taken_is_told(self):
        for words, attributes in (("roll", {"filmRollValue": 5.0}), ("translation", {"filmTranslateV": 0.1}), ("shake", {"shakeEnabled": True}),
                                  ("pan", {"panZoomEnabled": True, "renderPanZoom": True}), ("fit offset", {"filmFit": 1, "filmFitOffset": 0.1}),
                                  ("film offset", {"orthographic": True, "verticalFilmOffset": 0.1})):
            self.scene.camera = Scene().camera
            self.assert_refused(words, **attributes)
        self.assertEqual(self.scene.frame, 7)
        self.scene.camera = Scene().camera
        self.camera(panZoomEnabled=True, filmFitOffset=0.1)  # neither acts on what is rendered

    def test_a_camera_must_be_selected(self):
        def select(is_camera):
            self.scene.selected = ["|rig|camera|cameraShape"] if is_camera else []

        self.assert_needs_a_selection(select, lambda: setattr(self.scene, "asked", None))


unittest.main(argv=sys.argv[:1])
