# Alcove in Nuke: computes the AO of a Read node, with the camera of a Camera node or of the file, and loads it as a Read node.
# SPDX-License-Identifier: BSD-3-Clause
#
# Written from documentation, for Nuke 13 and later, and tested against a stub of Nuke's API: it has NOT been run in Nuke.
# Put it, with menu.py beside it, into ~/.nuke or a folder of NUKE_PATH.
"""Ambient occlusion of a Read node by the program `alcove`, found on the path or by the variable ALCOVE."""

import json
import math
import os
import re
import shlex
import shutil
import subprocess
import threading
import time

import nuke

CAMERAS = ("Camera", "Camera2", "Camera3", "Camera4")
OF_THE_FILE = "file"
PRESETS = ("standard", "draft", "production", "reference")
FRAME_IN_NAME = re.compile(r"[._]?(#+|%0?\d*d)")
POLL_S = 0.1


# ---- the camera ----


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


def camera_at(camera, picture, frame):
    """The camera of a frame as fields of a camera file, for pictures of a format. The horizontal aperture spans the
    format's width, whatever the vertical one is; the window moves in halves of that width, also upwards, and is then scaled."""
    def at(name, index=0):
        return camera[name].getValueAt(frame, index)

    projection = camera["projection_mode"].value().lower()
    if projection not in ("perspective", "orthographic"):
        raise ValueError("%s is %s: Alcove takes perspective and orthographic cameras" % (camera.name(), projection))
    if at("winroll") != 0:
        raise ValueError("%s has a window roll, which camera files cannot say" % camera.name())
    width, height = picture.width(), picture.height()
    half = width / 2 / at("win_scale", 0), width / 2 * picture.pixelAspect() / at("win_scale", 1)  # px
    lens = 2 * at("focal") / at("haperture")
    matrix = [at("world_matrix", index) for index in range(16)]  # rows, for column vectors
    fields = {
        "resolution": [width, height],
        "projection": projection,
        "fx": half[0] * lens,
        "fy": half[1] * lens,
        "cx": width / 2 - half[0] * at("win_translate", 0),
        "cy": height / 2 + half[1] * at("win_translate", 1),
        "world_to_camera": world_to_camera([matrix[0:12:4], matrix[1:12:4], matrix[2:12:4]], matrix[3:12:4]),
    }
    if 0 < at("near") < at("far"):
        fields.update(near=at("near"), far=at("far"))
    return fields


def write_cameras(path, camera, picture, frames):
    entries = [dict(frame=frame, **camera_at(camera, picture, frame)) for frame in frames]
    with open(path, "w", encoding="utf-8") as file:
        json.dump({"frames": entries}, file, indent=1)


def numbers_of(frames):
    """The numbers in a list of frames: 1001-1100, 1-9x2 or 1,5,9."""
    numbers = nuke.FrameRanges(frames.replace(",", " ")).toFrameList()
    if not numbers:
        raise ValueError("\"%s\" names no frame" % frames)
    return numbers


def require_frames_of_the_file(read):
    """Fails if the Read node shifts its frames: camera files go by the numbers in file names, and Camera nodes by the script's time."""
    shift = read["frame"].value().strip()
    starts_as_named = read["frame_mode"].value() in ("start at", "start_at") and shift == str(int(read["first"].value()))
    if shift not in ("", "0", "frame") and not starts_as_named:
        raise ValueError("%s shifts its frames: leave its frame field empty, and use a TimeOffset below it" % read.name())


# ---- the user's choices ----


def selected_read():
    reads = [node for node in nuke.selectedNodes() if node.Class() == "Read"]
    if len(reads) != 1:
        raise ValueError("Select one Read node, and the Camera node that it was rendered with, if there is one")
    return reads[0]


def source_of(read):
    """The name of the files, with #### or %04d for the frame number."""
    source = nuke.filename(read)
    if not source:
        raise ValueError("%s names no file" % read.name())
    if "%v" in source.lower():
        raise ValueError("%s reads a file for each view: name the files of one view" % read.name())
    return source


def camera_choices():
    """The choices of a camera, the proposal first: the selected Camera node, else the only one, else the file's."""
    names = [node.name() for node in nuke.allNodes() if node.Class() in CAMERAS]
    selected = [node.name() for node in nuke.selectedNodes() if node.Class() in CAMERAS]
    if len(selected) == 1 or len(names) == 1:
        first = (selected or names)[0]
        return [first, OF_THE_FILE] + [name for name in names if name != first]
    return [OF_THE_FILE] + names


def default_output(source):
    folder, name = os.path.split(source)
    return os.path.join(folder, "ao", os.path.splitext(name)[0] + ".exr").replace("\\", "/")


def ask_settings(read, source):
    """Asks for the settings; None if the user leaves the panel."""
    first, last = int(read["first"].value()), int(read["last"].value())
    panel = nuke.Panel("Alcove")
    panel.addSingleLineInput("Radius (0 = auto)", "0")
    panel.addEnumerationPulldown("Preset", " ".join(PRESETS))
    panel.addSingleLineInput("Frames", "%d-%d" % (first, last) if last > first else str(first))
    panel.addFilenameSearch("Output", default_output(source))
    panel.addEnumerationPulldown("Camera", " ".join(camera_choices()))
    panel.addSingleLineInput("More options", "")
    if not panel.show():
        return None
    return {
        "radius": panel.value("Radius (0 = auto)").strip(),
        "preset": panel.value("Preset"),
        "frames": panel.value("Frames").strip(),
        "output": panel.value("Output").replace("\\", "/"),
        "camera": panel.value("Camera"),
        "options": panel.value("More options") or "",
    }


# ---- the program ----


def program():
    found = shutil.which(os.environ.get("ALCOVE", "alcove"))
    if not found:
        raise ValueError("The program alcove is not on the path: install it, or name it in the variable ALCOVE")
    return found


def command_for(read, source, settings):
    """The command as a user would type it. Writes the camera file if a Camera node is chosen."""
    output, radius = settings["output"], settings["radius"]
    frames = numbers_of(settings["frames"])
    command = [program(), "run", source, "-o", output, "--radius", "auto" if radius in ("", "0") else radius,
               "--preset", settings["preset"], "--frames", re.sub(r"[,\s]+", ",", settings["frames"]),
               "--set", "ao-channels=rgb", "--progress", "percent"]
    if settings["camera"] != OF_THE_FILE:
        require_frames_of_the_file(read)
        os.makedirs(os.path.dirname(output) or ".", exist_ok=True)
        cameras = FRAME_IN_NAME.sub("", os.path.splitext(output)[0]) + ".camera.json"
        write_cameras(cameras, nuke.toNode(settings["camera"]), read["format"].value(), frames)
        command += ["--camera", cameras]
    return command + shlex.split(settings["options"])


def run_program(command, task):
    """Runs the program, reports its progress to the task, and gives its warnings; None if the user has cancelled, which ends
    it. Fails with the program's message."""
    percents, messages = [0], []

    def follow(stream):
        percents.extend(int(number) for line in stream for number in re.findall(r"(\d+)\s*%", line))

    pipe, nothing = subprocess.PIPE, subprocess.DEVNULL
    with subprocess.Popen(command, stdin=nothing, stdout=pipe, stderr=pipe, text=True, errors="replace") as running:
        listeners = [threading.Thread(target=follow, args=(running.stdout,)),
                     threading.Thread(target=messages.extend, args=(running.stderr,))]
        for listener in listeners:
            listener.start()
        is_cancelled = False
        try:
            while running.poll() is None:
                if task.isCancelled() and not is_cancelled:
                    is_cancelled = True
                    running.terminate()
                while percents:
                    task.setProgress(percents.pop(0))
                time.sleep(POLL_S)
        except BaseException:
            running.terminate()
            raise
        for listener in listeners:
            listener.join()
    if is_cancelled:
        return None
    lines = [line.strip() for line in messages if line.strip()]
    if running.returncode != 0:
        errors = [line for line in lines if "error" in line] or lines or ["it said nothing"]
        raise ValueError("%s (exit code %d)" % (errors[-1], running.returncode))
    for percent in percents + [100]:
        task.setProgress(percent)
    return [line for line in lines if "warning: " in line]


# ---- the nodes ----


def load_result(read, output, first, last):
    """Makes a Read node of the AO to the right of the source, or reloads the one that exists."""
    for node in nuke.allNodes():
        if node.Class() == "Read" and node["file"].value() == output:
            node["first"].setValue(min(first, node["first"].value()))
            node["last"].setValue(max(last, node["last"].value()))
            node["reload"].execute()
            return
    node = nuke.nodes.Read(file=output, first=first, last=last, raw=True)
    node.setXYpos(read.xpos() + 110, read.ypos())


def complain(failure):
    nuke.message("Alcove: %s" % failure)


def work(command, read, output, first, last):
    """Runs in a thread of its own: calls that touch nodes or windows go to the main thread."""
    try:
        warnings = run_program(command, nuke.ProgressTask("Alcove"))
        if warnings is not None:
            nuke.executeInMainThread(load_result, args=(read, output, first, last))
        if warnings:
            nuke.executeInMainThread(complain, args=("\n".join(warnings),))
    except (ValueError, OSError) as failure:
        nuke.executeInMainThread(complain, args=(failure,))


def compute():
    """The menu's command. Nuke goes on while the program runs. Returns the thread that waits for it."""
    try:
        read = selected_read()
        source = source_of(read)
        settings = ask_settings(read, source)
        if settings is None:
            return None
        command = command_for(read, source, settings)
        frames = numbers_of(settings["frames"])
    except (ValueError, OSError) as failure:
        complain(failure)
        return None
    thread = threading.Thread(target=work, args=(command, read, settings["output"], frames[0], frames[-1]), daemon=True)
    thread.start()
    return thread
