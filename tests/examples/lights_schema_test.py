# docs/lights.schema.json takes the lights files that the program takes, and refuses those that it refuses. Takes the program, the project's
# folder, a frame and its camera.
# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import jsonschema

PROGRAM, PROJECT, FRAME, CAMERA = (os.path.abspath(word) for word in sys.argv[1:5])
SCHEMA = json.loads((pathlib.Path(PROJECT) / "docs/lights.schema.json").read_text(encoding="utf-8"))

SUN = {"name": "key", "kind": "sun", "direction": [0, 1, 1]}
LAMP = {"name": "lamp", "kind": "point", "position": [0, 1, 1]}


def of(light, **fields):
    return {"lights": [{name: value for name, value in {**light, **fields}.items() if value is not None}]}


CASES = {
    "a sun": of(SUN),
    "a soft sun": of(SUN, angular_diameter=0.5, space="world"),
    "a lamp": of(LAMP, radius=0.1, space="view"),
    "both": {"lights": [SUN, LAMP]},
    "none": {"lights": []},
    "a world whose y is up": {**of(SUN), "up": "y"},
    "a world whose x is up": {**of(SUN), "up": "x"},
    "too many": {"lights": [{**SUN, "name": str(i)} for i in range(17)]},
    "no list": {"lights": SUN},
    "another field at the top": {**of(SUN), "light": 1},
    "a misspelt field": of(SUN, angular_diamater=1),
    "a sun with a radius": of(SUN, radius=1),
    "a lamp with a direction": of(LAMP, direction=[0, 0, 1]),
    "no name": of(SUN, name=None),
    "a name with a dot": of(SUN, name="key.1"),
    "no kind": of(SUN, kind=None),
    "another kind": of(SUN, kind="spot"),
    "no direction": of(SUN, direction=None),
    "a direction of two": of(SUN, direction=[0, 1]),
    "a direction of texts": of(SUN, direction=["0", "1", "2"]),
    "a wide sun": of(SUN, angular_diameter=180),
    "a radius below 0": of(LAMP, radius=-1),
    "another space": of(LAMP, space="object"),
    "frames": of(SUN, direction=None, frames=[{"frame": 0, "direction": [1, 0, 0]}]),
    "a direction without length": of(SUN, direction=[0, 0.0, -0.0]),
    "a very short direction": of(SUN, direction=[0, 1e-300, 0]),
    "a direction of two that frames replace": of(SUN, direction=[0, 1], frames=[{"frame": 0, "direction": [1, 0, 0]}]),
    "a frame with a point": of(SUN, frames=[{"frame": 0.0}]),
    "half a frame": of(SUN, frames=[{"frame": 0.5}]),
    "a frame beyond 32 bits": of(SUN, frames=[{"frame": 0}, {"frame": 4294967296}]),
    "a frame beyond 64 bits": of(SUN, frames=[{"frame": 0}, {"frame": 18446744073709551616}]),
    "the last frame there is": of(SUN, frames=[{"frame": 0}, {"frame": 2147483647}]),
    "frames of which one has no direction": of(SUN, direction=None, frames=[{"frame": 0, "direction": [1, 0, 0]}, {"frame": 1}]),
    "lamps that move": of(LAMP, position=None, frames=[{"frame": 0, "position": [1, 0, 0]}]),
    "a lamp with a diameter in a frame": of(LAMP, frames=[{"frame": 0, "angular_diameter": 1}]),
    "frames without a number": of(SUN, frames=[{"direction": [1, 0, 0]}]),
    "frames with a name": of(SUN, frames=[{"frame": 0, "name": "b"}]),
}

jsonschema.Draft202012Validator.check_schema(SCHEMA)
failures, taken = [], 0
with tempfile.TemporaryDirectory() as folder:
    path = pathlib.Path(folder) / "lights.json"
    for name, lights in CASES.items():
        path.write_text(json.dumps(lights), encoding="utf-8")
        valid = jsonschema.Draft202012Validator(SCHEMA).is_valid(lights)
        run = subprocess.run([PROGRAM, "run", FRAME, "--camera", CAMERA, "--radius", "1", "-o", folder + "/ao.exr", "--lights", str(path), "--dry-run"],
                             capture_output=True, text=True)
        taken += run.returncode == 0
        if valid != (run.returncode == 0):
            failures.append(f"{name}: the schema says {valid}, the program {run.returncode}: {run.stderr.strip()}")
print("\n".join(failures) or f"{len(CASES)} files, {taken} taken")
sys.exit(1 if failures or taken < 5 else 0)
