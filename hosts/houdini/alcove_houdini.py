# Alcove in Houdini: writes a camera, for each frame of a range, as a camera file.
# SPDX-License-Identifier: BSD-3-Clause
#
# Written from documentation and tested against a stub of Houdini's API: it has NOT been run in Houdini.
# Put it into a folder of Python modules, such as ~/houdiniX.Y/pythonX.Ylibs. Select the camera; in a shelf tool or the Python Shell:
#     import alcove_houdini
#     alcove_houdini.export()
"""Cameras of Houdini for `alcove run --camera FILE`."""

import json
import math

import hou


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


def camera_at(node, frame):
    """The camera of a frame as fields of a camera file. The aperture lies across the picture's width; the screen window is a
    part of that picture, in shares of its width and height."""
    def at(name):
        return node.parm(name).evalAtFrame(frame)

    projection = node.parm("projection").evalAsStringAtFrame(frame)
    if projection not in ("perspective", "ortho"):
        raise ValueError("%s is %s: Alcove takes perspective and orthographic cameras" % (node.path(), projection))
    width, height = int(at("resx")), int(at("resy"))
    window = at("winsizex"), at("winsizey")
    per_width = at("focal") / at("aperture") if projection == "perspective" else 1 / at("orthowidth")
    matrix = node.worldTransformAtTime(hou.frameToTime(frame)).asTuple()  # for row vectors
    return {
        "resolution": [width, height],
        "projection": "orthographic" if projection == "ortho" else "perspective",
        "fx": per_width * width / window[0],
        "fy": per_width * width * at("aspect") / window[1],
        "cx": (0.5 - at("winx") / window[0]) * width,
        "cy": (0.5 + at("winy") / window[1]) * height,
        "world_to_camera": world_to_camera([matrix[0:3], matrix[4:7], matrix[8:11]], matrix[12:15]),
        "near": at("near"),
        "far": at("far"),
    }


def write_cameras(path, node, first, last, step=1):
    frames = [dict(frame=frame, **camera_at(node, frame)) for frame in range(first, last + 1, step)]
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"frames": frames}, file, indent=1)


def export():
    """Asks for a file, and writes the selected camera over the range of the playbar."""
    nodes = [node for node in hou.selectedNodes() if node.parm("aperture")]
    if len(nodes) != 1:
        raise ValueError("Select one camera")
    path = hou.ui.selectFile(title="Write cameras", pattern="*.json", chooser_mode=hou.fileChooserMode.Write)
    if path:
        first, last = (int(frame) for frame in hou.playbar.frameRange())
        write_cameras(hou.text.expandString(path), nodes[0], first, last)
