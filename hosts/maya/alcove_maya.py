# Alcove in Maya: writes a camera, for each frame of a range, as a camera file.
# SPDX-License-Identifier: BSD-3-Clause
#
# Written from documentation and tested against a stub of Maya's API: it has NOT been run in Maya.
# Put it into a folder of scripts, such as ~/maya/scripts. Select the camera; in the Script Editor (Python):
#     import alcove_maya
#     alcove_maya.export()
"""Cameras of Maya for `alcove run --camera FILE`."""

import json
import math

from maya import cmds

FILL, HORIZONTAL, VERTICAL, OVERSCAN = range(4)  # filmFit
MM_PER_INCH = 25.4
CM_PER_UNIT = {"mm": 0.1, "cm": 1, "m": 100, "km": 100000, "in": 2.54, "ft": 30.48, "yd": 91.44, "mi": 160934.4}


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


def shown_width(film_width, film_height, fit, aspect):
    """The width of film that a picture of this aspect ratio shows, or would show on a larger film."""
    film_aspect = film_width / film_height
    by_width = fit == HORIZONTAL or (fit == FILL and film_aspect < aspect) or (fit == OVERSCAN and film_aspect > aspect)
    return film_width if by_width else film_height * aspect


def refuse_what_is_not_taken(get, is_orthographic):
    refused = {
        "a film fit offset": get("filmFit") in (HORIZONTAL, VERTICAL) and get("filmFitOffset") != 0,
        "a film roll": get("filmRollValue") != 0,
        "a film translation": get("filmTranslateH") != 0 or get("filmTranslateV") != 0,
        "a shake": get("shakeEnabled"),
        "a 2D pan or zoom that is rendered": get("panZoomEnabled") and get("renderPanZoom"),
        "a film offset or camera scale, and is orthographic": is_orthographic and (
            get("horizontalFilmOffset") != 0 or get("verticalFilmOffset") != 0 or get("cameraScale") != 1),
    }
    for what, is_there in refused.items():
        if is_there:
            raise ValueError("The camera has %s, which this script does not take" % what)


def camera_now(shape):
    """The camera of the current frame as fields of a camera file. Lengths are centimetres, as Maya keeps them."""
    def get(name):
        return cmds.getAttr(shape + "." + name)

    is_orthographic = bool(get("orthographic"))
    refuse_what_is_not_taken(get, is_orthographic)
    width, height = int(cmds.getAttr("defaultResolution.width")), int(cmds.getAttr("defaultResolution.height"))
    aspect = cmds.getAttr("defaultResolution.deviceAspectRatio")
    cm = CM_PER_UNIT[cmds.currentUnit(query=True, linear=True)]
    if is_orthographic:
        film = (get("orthographicWidth") * cm,) * 2
        focal = 1  # no distance divides
        offset = 0, 0
    else:
        squeeze = get("lensSqueezeRatio")
        film = get("horizontalFilmAperture") * squeeze, get("verticalFilmAperture")
        focal = get("focalLength") / MM_PER_INCH / get("cameraScale")
        offset = get("horizontalFilmOffset") * squeeze, get("verticalFilmOffset")
    shown = shown_width(*film, get("filmFit"), aspect) / (get("preScale") * get("postScale"))
    per_length = width / shown, height * aspect / shown  # px
    matrix = get("worldMatrix[0]")  # for row vectors
    return {
        "resolution": [width, height],
        "projection": "orthographic" if is_orthographic else "perspective",
        "fx": per_length[0] * focal,
        "fy": per_length[1] * focal,
        "cx": width / 2 - per_length[0] * offset[0],
        "cy": height / 2 + per_length[1] * offset[1],
        "world_to_camera": world_to_camera([matrix[0:3], matrix[4:7], matrix[8:11]], matrix[12:15]),
        "near": get("nearClipPlane") * cm,
        "far": get("farClipPlane") * cm,
    }


def write_cameras(path, shape, first, last, step=1):
    """Writes the camera of each frame, at the time of that frame; restores the current frame at the end."""
    current = cmds.currentTime(query=True)
    frames = []
    try:
        for frame in range(first, last + 1, step):
            cmds.currentTime(frame, edit=True)
            frames.append(dict(frame=frame, **camera_now(shape)))
    finally:
        cmds.currentTime(current, edit=True)
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"frames": frames}, file, indent=1)


def export():
    """Asks for a file, and writes the selected camera over the range of the time slider."""
    shapes = cmds.ls(selection=True, dag=True, type="camera", long=True) or []
    if len(shapes) != 1:
        raise ValueError("Select one camera")
    chosen = cmds.fileDialog2(fileFilter="Cameras (*.json)", fileMode=0, caption="Write cameras")
    if chosen:
        first, last = (int(cmds.playbackOptions(query=True, **{end: True})) for end in ("minTime", "maxTime"))
        write_cameras(chosen[0], shapes[0], first, last)
