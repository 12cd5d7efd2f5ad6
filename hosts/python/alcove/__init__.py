# Alcove for Python: the program's commands as functions.
# SPDX-License-Identifier: BSD-3-Clause
"""Ambient occlusion of rendered frames. Pure Python, from 3.9 on.

Files, by the program `alcove`, without any other package:

    import alcove

    alcove.run("shot.####.exr", output="ao/shot.####.exr", radius=0.5, preset="production", resume=True,
               progress=lambda event: print(event["event"], event.get("frame")))
    alcove.inspect("frame.exr")["camera"]["fx"]

Arrays, by the library libalcove, with numpy:

    ao = alcove.ao(depth, radius=0.5, fov=40)                            # (H, W), float32, 1 = open
    made = alcove.compute(depth, normal, camera="shot.json", frame=1001, radius=[0.1, 0.5], aov=["ao", "bent-normal"])

Options are those of the command line, by the same names with `_` for `-`: `slices=4` is `--slices 4`. True sets a flag;
False and None leave an option out. A list becomes words with commas; `behind` and `behind_channel` repeat the option for each
value.
"""

import collections
import json
import os
import shutil
import subprocess
import threading
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional

if TYPE_CHECKING:
    import numpy

__all__ = ["Error", "FramesFailed", "UsageError", "InputError", "OutputError", "DeviceError", "ComparisonError", "run", "inspect",
           "compare", "version", "program", "ao", "compute"]

# Each value of such an option is given by itself, since file names may hold commas.
_REPEATED = ("behind", "behind_channel")
_ONLY_OPTIONS = ("preset", "dry-run", "print-config", "write-camera")  # options that are not settings


class Error(Exception):
    """The program failed. `code` is its exit code, `events` holds its events until then."""

    code = 0

    def __init__(self, message: str, events: Optional[List[Dict[str, Any]]] = None):
        super().__init__(message)
        self.events = events or []


class FramesFailed(Error):
    """Some frames of a run failed; `events` says which."""

    code = 1


class UsageError(Error):
    """Options are unknown, contradict each other, or lack another."""

    code = 2


class InputError(Error):
    """An input is missing or makes no sense."""

    code = 3


class OutputError(Error):
    """An output could not be written."""

    code = 4


class DeviceError(Error):
    """There is no device, or it was lost."""

    code = 5


class ComparisonError(Error):
    """A comparison exceeds its limits."""

    code = 6


_ERRORS = {kind.code: kind for kind in (FramesFailed, UsageError, InputError, OutputError, DeviceError, ComparisonError)}


def program() -> str:
    """The path of the program: that in the variable ALCOVE, else the one on the path. Fails with DeviceError."""
    # If the package was installed with Alcove, the program may lie in the same prefix.
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../../../bin/alcove")
    found = shutil.which(os.environ.get("ALCOVE", "alcove")) or ("ALCOVE" not in os.environ and shutil.which(beside))
    if not found:
        raise DeviceError("the program alcove is not on the path: install it, or name it in the variable ALCOVE")
    return found


def _words(options: Dict[str, Any], of_frames: bool = True) -> List[str]:
    """Options as words of the command line, such that no value is taken for an option. `of_frames`: for run and inspect, whose
    options are settings except for a few."""
    words = []
    for name, value in options.items():
        key = name.rstrip("_").replace("_", "-")
        is_setting = of_frames and key not in _ONLY_OPTIONS
        option = "--set=" + key if is_setting else "--" + key
        if value is None or value is False:
            continue
        if value is True:
            words.append(option + "=true" if is_setting else option)
        elif isinstance(value, (list, tuple)):
            values = [_text(part) for part in value]
            words += [f"{option}={part}" for part in (values if name in _REPEATED else [",".join(values)])]
        else:
            words.append(f"{option}={_text(value)}")
    return words


def _text(value: Any) -> str:
    return repr(float(value)) if isinstance(value, float) else os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def _message(code: int, errors_text: str) -> str:
    lines = [line for line in errors_text.splitlines() if line.strip()]
    errors = [line for line in lines if "error" in line] or lines or [f"alcove ended with exit code {code}"]
    prefix = "alcove: error: "
    for number, line in enumerate(lines):
        if line.startswith(prefix) and line.endswith(":"):  # a list, and the complete command
            return " ".join(part.strip() for part in [line[len(prefix):]] + lines[number + 1:])
    return errors[-1][len(prefix):] if errors[-1].startswith(prefix) else errors[-1]


def _fail(code: int, errors_text: str, events: Optional[List[Dict[str, Any]]] = None) -> None:
    raise _ERRORS.get(code, Error)(_message(code, errors_text), events)


def _output_of(*words: str) -> str:
    done = subprocess.run([program(), *words], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        _fail(done.returncode, done.stderr)
    return done.stdout


def run(input: Optional[str] = None, *, output: str, progress: Optional[Callable[[Dict[str, Any]], None]] = None,
        **options: Any) -> Dict[str, Any]:
    """Computes a frame, or a sequence whose names have a pattern such as `####`, and returns the totals of the run: the
    counts `done`, `kept`, `failed`, `warned`, `dropped` and `missing`, and `frames`, the events of each.

    input: an EXR file, or None if `depth` or `position` names one. output: the AO's EXR file.
    progress: is called with each event of --log-json as it comes, in this thread: `begin`, `frame` and `end`. An exception
    in it stops the program, which leaves nothing partial, and passes on to the caller.
    options: those of `alcove run`. Fails with a kind of Error by the program's exit code.
    """
    if isinstance(options.get("camera"), dict):
        raise UsageError("camera: a dict is for arrays; run() takes the path of a camera file")
    if "log_json" in options:
        raise UsageError("log_json is taken by progress: use that")
    words = [program(), "run", *([] if input is None else [os.fspath(input)]), "--output", os.fspath(output),
             "--log-json", "-", *_words({"progress": "none", **options})]
    events: List[Dict[str, Any]] = []
    error_lines: "collections.deque[str]" = collections.deque(maxlen=200)
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True) as running:
        listener = threading.Thread(target=lambda: error_lines.extend(running.stderr), daemon=True)
        listener.start()
        try:
            for line in running.stdout:
                events.append(json.loads(line))
                if progress:
                    progress(events[-1])
        except BaseException:
            running.terminate()
            raise
        code = running.wait()
        listener.join()
    if code != 0:
        _fail(code, "".join(error_lines), events)
    totals = dict(events[-1]) if events else {}
    totals.pop("event", None)
    totals["frames"] = [event for event in events if event["event"] == "frame"]
    return totals


def inspect(input: Optional[str] = None, **options: Any) -> Dict[str, Any]:
    """The contents of a frame or a sequence, and its reading, as `alcove inspect --json` prints them. Fails as run() does."""
    return json.loads(_output_of("inspect", *([] if input is None else [os.fspath(input)]), "--json", *_words(options)))


def compare(result: str, reference: str, **options: Any) -> Dict[str, Any]:
    """The measures of `alcove compare --json`: rmse, ssim and others. A broken limit, such as max_rmse=0.01, fails
    with ComparisonError; other failures are those of run()."""
    return json.loads(_output_of("compare", os.fspath(result), os.fspath(reference), "--json", *_words(options, of_frames=False)))


def version() -> str:
    """The program's version, such as 0.2.0."""
    return _output_of("--version").split()[1]


def ao(depth: Optional["numpy.ndarray"] = None, normal: Optional["numpy.ndarray"] = None, *, camera: Any = None, radius: Any = None,
       **options: Any) -> "numpy.ndarray":
    """The ambient occlusion of a frame in arrays: (H, W), float32, visibility from 0 to 1, 1 = open. It is the result
    `ao` of compute()."""
    if "aov" in options:
        raise UsageError("aov: ao() gives the AO alone; compute() gives others")
    return compute(depth, normal, camera=camera, radius=radius, aov="ao", **options)["ao"]


def compute(depth: Optional["numpy.ndarray"] = None, normal: Optional["numpy.ndarray"] = None, *, camera: Any = None,
            aov: Any = "ao", frame: int = 0, **options: Any) -> Dict[str, Any]:
    """Computes the results that `aov` names for a frame in arrays: arrays of (H, W), or (H, W, C) if a result has several
    components, float32. It adds `stats`: compute_ms (of the device), sky_pixels, repaired_depth, repaired_normals, radius,
    device.

    depth: (H, W), planar and positive in scene units, upper left pixel first; other kinds by depth_kind. 0, infinite and
        NaN are sky. float16 and float32 are read in place, with any strides; other types are converted to float32. Integers of 8 bits
        are too few distances and refused; divide those of 16 bits by 65535 for kinds within 0 to 1.
    normal: (H, W, 3), or (H, W, 2) by normal_encoding; None: reconstructed from depth. If the camera has a position,
        normal_space must be "world" or "view", here or in the camera. normal_encoding is "signed" by default.
    camera: the fields of a camera file as a dict (without resolution: that of the arrays), or its path, with the entry of
        `frame`; or instead fov=DEGREES (horizontal), vertical_fov=DEGREES, focal_px=PIXELS, focal=MM and aperture=MM, or ortho_width=UNITS.
    frame: the frame's number; noise="animated" depends on it.
    position: (H, W, 3) instead of depth. behind: an array of depth behind the first surface, or a list of them.
    material_ao, matte, occluders, ignore: (H, W), numbers or bool. albedo: (H, W, 3), or one number.
    options: those of `alcove run` that are not about files: radius (required; "auto" proposes one), preset, slices, ...

    Fails with UsageError, InputError or DeviceError, also if the pixels contradict depth, normals or camera; doubts are
    warnings. Other threads go on meanwhile. The first call of a thread opens its own device, which stays open. After a fork
    the child opens its own.
    """
    from . import _arrays  # numpy and the library are loaded on first use
    return _arrays.compute(depth, normal, camera, aov, frame, options)
