# docs/camera.schema.json takes the camera files that the program takes, and refuses those that it refuses; and the sample of docs/hosts.md
# writes one. Takes the program, the project's folder, a frame and its camera.
# SPDX-License-Identifier: BSD-3-Clause
import copy
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import jsonschema

PROGRAM, PROJECT, FRAME, CAMERA = (os.path.abspath(word) for word in sys.argv[1:5])
SCHEMA = json.loads((pathlib.Path(PROJECT) / "docs/camera.schema.json").read_text(encoding="utf-8"))
GOOD = json.loads(pathlib.Path(CAMERA).read_text(encoding="utf-8"))


def changed(**fields):
    """The camera with other fields; None takes one away."""
    camera = {**copy.deepcopy(GOOD), **fields}
    return {name: value for name, value in camera.items() if value is not None}


def in_frames(**fields):
    return {"frames": [{"frame": 1, **changed(**fields)}]}


MATRIX = [[1.4, 0, 0, 0], [0, 2.5, 0, 0], [0, 0, -1, -0.2], [0, 0, -1, 0]]
TURNED = [[0, 1, 0, 3], [-1, 0, 0, 0], [0, 0, 1, 2.5], [0, 0, 0, 1]]
CASES = {
    "the example": GOOD,
    "no matrix": changed(world_to_camera=None, normal_space=None),
    "no focal length": changed(fx=None),
    "a matrix instead": changed(fx=None, fy=None, cx=None, cy=None, projection=MATRIX),
    "a matrix beside some": changed(fx=None, projection=MATRIX),
    "a word instead": changed(fx=None, fy=None, cx=None, cy=None, projection="perspective"),
    "a focal length of 0": changed(fx=0),
    "a text for a number": changed(fy="666"),
    "a principal point far away": changed(cx=-2000.5),
    "a principal point beyond all": changed(cx=1e10),
    "no resolution": changed(resolution=None),
    "a resolution of three": changed(resolution=[960, 540, 1]),
    "a resolution in halves": changed(resolution=[960.5, 540]),
    "a resolution of 0": changed(resolution=[0, 540]),
    "orthographic": changed(projection="orthographic"),
    "another projection": changed(projection="fisheye"),
    "three rows": changed(world_to_camera=TURNED[:3]),
    "rows of three": changed(world_to_camera=[row[:3] for row in TURNED]),
    "a text in a matrix": changed(world_to_camera=[["a", 0, 0, 0]] + TURNED[1:]),
    "a left-handed camera": changed(camera_space="left-handed"),
    "no handed camera": changed(camera_space="upside down"),
    "a planar depth with more words": changed(depth="planar: along the axis"),
    "no kind of depth": changed(depth="deep"),
    "clip planes": changed(near=0.1, far="inf"),
    "a near plane at 0": changed(near=0),
    "a far plane of no number": changed(far="far"),
    "a near plane of null": changed(near=0.5, far=10),
    "reversed depth": changed(reversed_z=True),
    "reversed depth as a number": changed(reversed_z=1),
    "view normals": changed(normal_space="view"),
    "normals nowhere": changed(normal_space="object"),
    "octahedral normals": changed(normal_encoding="octahedral"),
    "normals of an unknown kind": changed(normal_encoding="spherical"),
    "a pixel aspect of 0": changed(pixel_aspect=0),
    "frames": in_frames(),
    "frames that lack a focal length": {"frames": [{"frame": 1, "cx": 1}], **changed()},
    "frames without a number": {"frames": [changed()]},
    "a number of a frame as a text": {"frames": [{"frame": "1", **changed()}]},
    "frames that are none": {"frames": {}, **changed()},
    "a list": [GOOD],
}


def program_takes(camera, path):
    """Whether the file is read; what follows from it for this frame does not matter."""
    path.write_text(json.dumps(camera), encoding="utf-8")
    done = subprocess.run([PROGRAM, "inspect", FRAME, "--camera", str(path), "--frames", "1", "--write-camera", str(path) + ".written"],
                          capture_output=True, text=True, check=False)
    refused = "camera field" in done.stdout + done.stderr or "not a JSON object" in done.stdout + done.stderr
    assert refused or done.returncode == 0, done.stdout + done.stderr
    return not refused


def sample_writes_the_example(folder):
    """The page's sample, as it stands there, writes the example's camera from its matrix, whatever its scale."""
    page = (pathlib.Path(PROJECT) / "docs/hosts.md").read_text(encoding="utf-8")
    [sample] = [code for code in page.split("```python\n")[1:] if "matrix_at" in code]
    os.chdir(folder)
    exec(sample.split("```")[0], {"matrix_at": lambda frame: [[*(3 * x for x in row[:3]), row[3]] for row in GOOD["camera_to_world"]]})
    cameras = json.loads(pathlib.Path("cameras.json").read_text(encoding="utf-8"))
    schema.validate(cameras)
    assert [entry.pop("frame") for entry in cameras["frames"]] == list(range(1001, 1011))
    for entry in cameras["frames"]:
        for name, value in entry.items():
            difference = max(abs(a - b) for a, b in zip(numbers(value), numbers(GOOD[name]), strict=True))
            assert difference < 1e-5, "%s is %s, not %s" % (name, value, GOOD[name])


def numbers(value):
    return [number for item in value for number in numbers(item)] if isinstance(value, list) else [value]


jsonschema.Draft202012Validator.check_schema(SCHEMA)
schema = jsonschema.Draft202012Validator(SCHEMA)
taken = 0
with tempfile.TemporaryDirectory() as folder:
    sample_writes_the_example(folder)
    for name, camera in CASES.items():
        path = pathlib.Path(folder) / "camera.json"
        by_schema, by_program = schema.is_valid(camera), program_takes(camera, path)
        assert by_schema == by_program, "%s: the schema %s it, and the program %s it" % (
            name, *("takes" if takes else "refuses" for takes in (by_schema, by_program)))
        taken += by_program
        written = str(path) + ".written"
        if os.path.exists(written):
            schema.validate(json.loads(pathlib.Path(written).read_text(encoding="utf-8")))
            os.remove(written)
assert 10 < taken < len(CASES) - 10, taken
print("%d files taken, %d refused, by both" % (taken, len(CASES) - taken))
