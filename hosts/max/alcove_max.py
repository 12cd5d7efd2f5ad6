# Alcove in 3ds Max: writes a camera, for each frame of a range, as a camera file.
# SPDX-License-Identifier: BSD-3-Clause
#
# Written from documentation and tested against a stub of pymxs: it has NOT been run in 3ds Max.
# Put it into a folder of scripts, such as <3ds Max>/scripts/python. Select the camera; in the Listener (Python):
#     import alcove_max
#     alcove_max.export()
"""Cameras of 3ds Max for `alcove run --camera FILE`."""

import json
import math

import pymxs
from pymxs import runtime as rt

# The effect of these on the picture is not certain enough: the script fails if the camera has one of them.
NOT_TAKEN = ("horizontal_shift", "vertical_shift", "horizontal_tilt_correction", "vertical_tilt_correction",
             "auto_vertical_tilt_correction")


def world_to_camera(axes, position):
    """The rows of world_to_camera, from a camera's axes in the world (right, up, backwards) and its position; scale is ignored."""
    lengths = [math.sqrt(sum(x * x for x in axis)) for axis in axes]
    if min(lengths) == 0:
        raise ValueError("The camera is scaled to nothing")
    right, up, back = units = [[x / length for x in axis] for axis, length in zip(axes, lengths)]
    if any(abs(sum(a * b for a, b in zip(*pair))) > 1e-4 for pair in ((right, up), (up, back), (back, right))):
        raise ValueError("The camera is sheared: take the scale off its parents")
    cross = [right[i - 2] * up[i - 1] - right[i - 1] * up[i - 2] for i in range(3)]
    if sum(a * b for a, b in zip(cross, back)) < 0:
        raise ValueError("The camera is mirrored: take the negative scale off it or its parents")
    return [unit + [-sum(a * b for a, b in zip(unit, position))] for unit in units] + [[0, 0, 0, 1]]


def numbers(point):
    return [point.x, point.y, point.z]


def target_distance(camera):
    target = getattr(camera, "target", None)
    if target is None:
        return camera.targetDistance
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(numbers(camera.transform.row4), numbers(target.transform.row4))))


def camera_now(camera):
    """The camera of the current frame as fields of a camera file. fov is the angle of the picture's width; an orthographic
    camera sees the width of that angle at its target."""
    for name in NOT_TAKEN:
        if getattr(camera, name, 0):
            raise ValueError("%s has %s, which this script does not take; a pass of positions tells the camera, too" %
                             (camera.name, name))
    width, height = int(rt.renderWidth), int(rt.renderHeight)
    half_width = math.tan(math.radians(camera.fov) / 2)  # at a distance of 1
    is_orthographic = bool(getattr(camera, "orthoProjection", False))
    if is_orthographic:
        half_width *= target_distance(camera)
    transform = camera.transform  # for row vectors
    return {
        "resolution": [width, height],
        "projection": "orthographic" if is_orthographic else "perspective",
        "fx": width / 2 / half_width,
        "fy": width / 2 / half_width * rt.renderPixelAspect,
        "cx": width / 2,
        "cy": height / 2,
        "world_to_camera": world_to_camera([numbers(row) for row in (transform.row1, transform.row2, transform.row3)],
                                           numbers(transform.row4)),
    }


def write_cameras(path, camera, first, last, step=1):
    frames = []
    for frame in range(first, last + 1, step):
        with pymxs.attime(frame):
            frames.append(dict(frame=frame, **camera_now(camera)))
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"frames": frames}, file, indent=1)


def export():
    """Asks for a file, and writes the selected camera over the active segment of time."""
    cameras = [node for node in rt.selection if rt.superClassOf(node) == rt.Camera]
    if len(cameras) != 1:
        raise ValueError("Select one camera")
    path = rt.getSaveFileName(caption="Write cameras", types="Cameras (*.json)|*.json|")
    if path:
        segment = rt.animationRange
        write_cameras(path, cameras[0], int(segment.start.frame), int(segment.end.frame))
