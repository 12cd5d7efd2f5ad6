# Passes arrays to the C library and back, by ctypes.
# SPDX-License-Identifier: BSD-3-Clause
"""The implementation of alcove.ao() and alcove.compute()."""

import ctypes
import json
import operator
import os
import re
import threading
import warnings
from typing import Any, Dict, List, Optional

import numpy

from . import _ERRORS, DeviceError, Error, InputError, UsageError, _text, program

_NAME = "libalcove.so.0"
_PLANES = ("position", "material_ao", "matte", "occluders", "ignore")  # besides behind, which may be several, and albedo, which may be a number
_STATS = ("compute-ms", "sky-pixels", "repaired-depth", "repaired-normals", "radius")


class _Layout(ctypes.Structure):
    """The alcove_layout of alcove/alcove.h."""

    _fields_ = [("width", ctypes.c_int), ("height", ctypes.c_int), ("components", ctypes.c_int), ("type", ctypes.c_int),
                ("pixel_stride", ctypes.c_ssize_t), ("row_stride", ctypes.c_ssize_t), ("component_stride", ctypes.c_ssize_t)]


def _paths() -> List[str]:
    """The possible paths of the library: that of the variable ALCOVE_LIBRARY, beside the built or installed program, or the
    system's."""
    if os.environ.get("ALCOVE_LIBRARY"):
        return [os.environ["ALCOVE_LIBRARY"]]
    try:
        folder = os.path.dirname(os.path.realpath(program()))
    except DeviceError:
        return [_NAME]
    beside = [os.path.join(folder, place, _NAME) for place in ("", "../lib")]
    return [path for path in beside if os.path.exists(path)] + [_NAME]


def _load() -> ctypes.CDLL:
    """Loads the library. Fails with DeviceError."""
    reasons = []
    for path in _paths():
        try:
            library = ctypes.CDLL(path)
            break
        except OSError as error:
            reasons.append(str(error))
    else:
        raise DeviceError(f"the library of alcove cannot be loaded ({'; '.join(reasons)}): install it, or name it in the variable "
                          "ALCOVE_LIBRARY")
    handle, text, layout = ctypes.c_void_p, ctypes.c_char_p, ctypes.POINTER(_Layout)
    for name, result, arguments in (
            ("new", handle, []), ("free", None, [handle]), ("set", ctypes.c_int, [handle, text, text]),
            ("preset", ctypes.c_int, [handle, text]), ("plane", ctypes.c_int, [handle, text, ctypes.c_void_p, layout]),
            ("camera_json", ctypes.c_int, [handle, text]), ("run", ctypes.c_int, [handle, ctypes.c_int]),
            ("components", ctypes.c_int, [handle, text]), ("get", ctypes.c_int, [handle, text, ctypes.c_void_p, layout]),
            ("number", ctypes.c_double, [handle, text]), ("notes", text, [handle]), ("device", text, [handle]), ("error", text, [handle])):
        function = getattr(library, "alcove_" + name)
        function.restype, function.argtypes = result, arguments
    return library


def _as_plane(name: str, values: Any) -> numpy.ndarray:
    """Gives (H, W, C) of half floats or floats in this machine's byte order, copied only if needed."""
    if isinstance(values, numpy.ma.MaskedArray):
        raise UsageError(f"{name}: a masked array; fill it first, depth with 0 where there is nothing")
    array = numpy.asarray(values)
    shape = "(H, W, 3)" if name in ("normal", "position", "albedo") else "(H, W)"
    if array.ndim not in (2, 3) or 0 in array.shape or array.ndim == 2 and shape != "(H, W)" or array.ndim == 3 and array.shape[2] > 3:
        raise UsageError(f"{name}: an array of {numpy.shape(values)}, where {shape} belongs")
    if array.ndim == 2:
        array = array[:, :, None]
    if array.dtype.kind not in "fiub" or array.dtype.kind in "iub" and name == "normal":
        raise UsageError(f"{name}: an array of {array.dtype}, where {'floats belong' if name == 'normal' else 'numbers belong'}")
    if array.dtype.kind != "f" and array.dtype.itemsize == 1 and name in ("depth", "behind", "position"):
        raise UsageError(f"{name}: an array of {array.dtype} holds 256 distances at most, too few for AO: give floats, or uint16")
    is_half = array.dtype.kind == "f" and array.dtype.itemsize == 2
    array = array.astype(numpy.float16 if is_half else numpy.float32, copy=False)
    # A value that is repeated by a stride of 0 needs a copy, since 0 means packed to the library.
    has_shared = any(stride == 0 and count > 1 for stride, count in zip(array.strides, array.shape))
    return numpy.ascontiguousarray(array) if has_shared else array


def _layout_of(array: numpy.ndarray) -> _Layout:
    height, width, components = array.shape
    rows, pixels, planes = array.strides
    return _Layout(width, height, components, 1 if array.dtype == numpy.float16 else 0, pixels, rows, planes)


class _Session:
    """A handle of the library. It is reused after clear(), which resets the options and planes of the last frame."""

    def __init__(self) -> None:
        self.library = _load()
        self.handle = self.library.alcove_new()
        if not self.handle:
            raise MemoryError("alcove_new")
        self.set_options: List[bytes] = []
        self.set_planes: List[bytes] = []

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.library.alcove_free(self.handle)

    def check(self, code: int) -> None:
        if code != 0:
            kind = _ERRORS.get(code) if code > 1 else None
            raise (kind or Error)(_in_keywords(self.library.alcove_error(self.handle)))

    def clear(self) -> None:
        for name in self.set_options:
            self.library.alcove_set(self.handle, name, None)
        for name in self.set_planes:
            self.library.alcove_plane(self.handle, name, None, None)
        self.library.alcove_preset(self.handle, None)
        self.library.alcove_camera_json(self.handle, None)
        self.set_options, self.set_planes = [], []

    def set(self, name: str, value: Any) -> None:
        if value is None or value is False:
            return
        if isinstance(value, numpy.ndarray):
            value = value.tolist()
        if value is True:
            words = "true"
        elif isinstance(value, (list, tuple)):
            words = ",".join(_text(part) for part in value)
        else:
            words = _text(value.item() if isinstance(value, numpy.generic) else value)
        option = name.rstrip("_").replace("_", "-").encode()
        if "\0" in words:
            raise UsageError(f"{name}: a text with a zero byte")
        self.check(self.library.alcove_set(self.handle, option, words.encode()))
        self.set_options.append(option)

    def plane(self, name: str, values: Any) -> None:
        array = _as_plane(name, values)
        plane = name.replace("_", "-").encode()
        self.set_planes.append(plane)
        self.check(self.library.alcove_plane(self.handle, plane, array.ctypes.data, ctypes.byref(_layout_of(array))))

    def result(self, name: str, height: int, width: int) -> numpy.ndarray:
        components = self.library.alcove_components(self.handle, name.encode())
        array = numpy.empty((height, width, components), numpy.float32)
        self.check(self.library.alcove_get(self.handle, name.encode(), array.ctypes.data, ctypes.byref(_layout_of(array))))
        return array[:, :, 0] if components == 1 else array


def _in_keywords(text: bytes) -> str:
    """A sentence of the library, with options under their Python names."""
    return re.sub(r"'([a-z]+(?:-[a-z]+)*)'", lambda match: match.group(0).replace("-", "_"), text.decode("utf-8", "replace"))


_of_thread = threading.local()
_before_fork: List[Any] = []  # sessions of the parent process: neither used nor freed


def _forget() -> None:
    _before_fork.append(_of_thread.__dict__.pop("session", None))


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget)


def _session() -> _Session:
    if not hasattr(_of_thread, "session"):
        _of_thread.session = _Session()
    return _of_thread.session


def _camera_text(camera: Any, width: int, height: int) -> Optional[bytes]:
    """The text of a camera file. Fields that do not say their resolution are those of arrays of this size."""
    if camera is None:
        return None
    if not isinstance(camera, dict):
        try:
            with open(camera, "rb") as file:
                return file.read()
        except OSError as error:
            raise InputError(f"{os.fspath(camera)}: {error.strerror} (camera)") from error
    return json.dumps({"resolution": [width, height], **camera}, default=lambda value: value.tolist()).encode()  # numpy's numbers and matrices


def compute(depth: Any, normal: Any, camera: Any, aov: Any, frame: int, options: Dict[str, Any]) -> Dict[str, Any]:
    try:
        frame = operator.index(frame)
    except TypeError as error:
        raise UsageError(f"frame: {frame!r} is no whole number") from error
    if abs(frame) >= 2**31:
        raise UsageError(f"frame: {frame} is too large a number")
    names = [word.strip() for word in (aov.split(",") if isinstance(aov, str) else aov)]
    session = _session()
    session.clear()
    planes = {"depth": depth, "normal": normal, **{name: options.pop(name, None) for name in _PLANES}}
    behind = options.pop("behind", None)
    albedo = options.get("albedo")
    if albedo is not None and numpy.ndim(albedo) > 0:
        planes["albedo"] = options.pop("albedo")
    presets = options.pop("preset", None)
    for name, values in planes.items():
        if values is not None:
            session.plane(name, values)
    for values in behind if isinstance(behind, (list, tuple)) else [] if behind is None else [behind]:
        session.plane("behind", values)
    for preset in presets.split(",") if isinstance(presets, str) else presets or []:
        session.check(session.library.alcove_preset(session.handle, preset.strip().encode()))
    first = depth if depth is not None else planes["position"]
    if first is None:
        raise UsageError("there is no depth, and no position")
    height, width = numpy.shape(first)[:2]
    session.check(session.library.alcove_camera_json(session.handle, _camera_text(camera, width, height)))
    session.set("aov", names)
    for name, value in options.items():
        session.set(name, value)
    session.check(session.library.alcove_run(session.handle, frame))
    made: Dict[str, Any] = {name: session.result(name, height, width) for name in names}
    made["stats"] = {name.replace("-", "_"): session.library.alcove_number(session.handle, name.encode()) for name in _STATS}
    made["stats"]["notes"] = _in_keywords(session.library.alcove_notes(session.handle)).splitlines()
    for note in made["stats"]["notes"]:
        warnings.warn(f"alcove: {note}", stacklevel=4)
    made["stats"]["device"] = session.library.alcove_device(session.handle).decode("utf-8", "replace")
    return made
