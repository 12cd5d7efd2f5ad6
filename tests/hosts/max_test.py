# The camera exporter of 3ds Max against a stub of pymxs, and against the field of view of its documentation.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import math
import sys
import types
import unittest

import camera_facts
from camera_facts import applied, inverse, stand_at, transposed


class Point:
    def __init__(self, x, y, z):
        self.x, self.y, self.z = x, y, z


class Matrix:
    """Four rows of three, for row vectors."""

    def __init__(self, column_matrix):
        rows = transposed(column_matrix)
        self.row1, self.row2, self.row3, self.row4 = (Point(*row[:3]) for row in rows)


class Target:
    """Lies a distance away in the direction in which the camera looks."""

    def __init__(self, stub, distance):
        self.stub, self.distance = stub, distance

    @property
    def transform(self):
        matrix = stand_at(self.stub.frame)
        place = [matrix[i][3] - self.distance * matrix[i][2] for i in range(3)]
        return Matrix([[1, 0, 0, place[0]], [0, 1, 0, place[1]], [0, 0, 1, place[2]], [0, 0, 0, 1]])


class Camera:
    """Properties that a class of cameras lacks are not there, as in pymxs."""

    def __init__(self, stub, **properties):
        self.stub, self.name, self.scale = stub, "Camera001", 1.0
        self.__dict__.update({"fov": 45.0, "target": None, **properties})

    @property
    def transform(self):
        return Matrix(stand_at(self.stub.frame, self.scale))


class Max(camera_facts.CameraFacts):
    def setUp(self):
        super().setUp()
        self.frame, self.width_at_target = 0, None
        pymxs = types.ModuleType("pymxs")

        @contextlib.contextmanager
        def at_time(frame):
            before, self.frame = self.frame, frame
            yield
            self.frame = before

        pymxs.attime = at_time
        time = types.SimpleNamespace
        self.node = Camera(self)
        self.rt = pymxs.runtime = types.SimpleNamespace(
            renderWidth=640, renderHeight=360, renderPixelAspect=1.0, Camera="camera", superClassOf=lambda node: "camera",
            selection=[self.node], getSaveFileName=lambda caption, types: self.path,
            animationRange=time(start=time(frame=10.0), end=time(frame=12.0)))
        sys.modules.update({"pymxs": pymxs, "pymxs.runtime": pymxs.runtime})
        self.script = camera_facts.script("max/alcove_max.py")

    def change(self, properties):
        self.node.__dict__.update(properties)

    def host_pixel(self, frame=4):
        """fov is the horizontal angle in degrees; pixels are as wide by their height as the renderer's settings say."""
        width, height = self.rt.renderWidth, self.rt.renderHeight

        def see(point):
            x, y, z, _ = applied(inverse(stand_at(frame, self.node.scale)), point)
            visible_width = self.width_at_target or 2 * -z * math.tan(math.radians(self.node.fov / 2))
            visible_height = visible_width * height / (width * self.rt.renderPixelAspect)
            return width * (0.5 + x / visible_width), height * (0.5 - y / visible_height)
        return see

    def test_field_of_view(self):
        self.assert_sees()
        self.rt.renderWidth, self.rt.renderHeight = 300, 500
        self.assert_sees(fov=70.0)

    def test_pixels_that_are_not_square_and_scale_that_takes_no_part(self):
        self.rt.renderPixelAspect = 1.5
        self.assert_sees(scale=2.54)

    def test_orthographic_cameras_see_as_wide_as_the_angle_is_at_the_target(self):
        self.width_at_target = 2 * 7 * math.tan(math.radians(22.5))
        self.assert_sees(orthoProjection=True, target=Target(self, 7.0))
        self.assert_sees(target=None, targetDistance=7.0)

    def test_every_frame_is_evaluated_at_its_time(self):
        self.assert_exports([10, 11, 12])

    def test_what_is_not_taken_is_told(self):
        for name in ("horizontal_shift", "vertical_shift", "vertical_tilt_correction", "auto_vertical_tilt_correction"):
            self.node = Camera(self)
            self.assert_refused("Camera001 has " + name, **{name: 0.1})
        self.node = Camera(self)
        self.camera(horizontal_shift=0.0, auto_vertical_tilt_correction=False)

    def test_a_camera_must_be_selected(self):
        def select(is_camera):
            self.rt.superClassOf = lambda node: "camera" if is_camera else "light"

        self.assert_needs_a_selection(select, lambda: setattr(self.rt, "getSaveFileName", lambda caption, types: None))


unittest.main(argv=sys.argv[:1])
