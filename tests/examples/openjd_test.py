# Checks examples/farm/alcove.openjd.json against the 2023-09 schema of Open Job Description with its chunking extension, as far as the template uses them,
# then runs its command as a worker would. Takes the program, the project's folder, a frame and its camera.
# SPDX-License-Identifier: BSD-3-Clause
import copy
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import jsonschema

PROGRAM, PROJECT, FRAME, CAMERA = sys.argv[1:5]


def record(required, **properties):
    return {"type": "object", "required": required, "properties": properties, "additionalProperties": False}


def text(longest, **more):
    return {"type": "string", "minLength": 1, "maxLength": longest, **more}


IDENTIFIER = text(64, pattern="^[A-Za-z_][A-Za-z0-9_]*$")
WHOLE = {"anyOf": [{"type": "integer"}, {"type": "string", "pattern": r"^(-?[0-9]+|.*\{\{.*\}\}.*)$"}]}
DESCRIPTION = text(2048)
PARAMETER = {"oneOf": [
    record(["name", "type"], name=IDENTIFIER, type={"const": "PATH"}, description=DESCRIPTION, default=text(1024), objectType={"enum": ["FILE", "DIRECTORY"]},
           dataFlow={"enum": ["NONE", "IN", "OUT", "INOUT"]}),
    record(["name", "type"], name=IDENTIFIER, type={"const": "STRING"}, description=DESCRIPTION, default=text(1024), allowedValues={"type": "array", "minItems": 1}),
    record(["name", "type"], name=IDENTIFIER, type={"const": "INT"}, description=DESCRIPTION, default=WHOLE, minValue=WHOLE, maxValue=WHOLE),
    record(["name", "type"], name=IDENTIFIER, type={"const": "FLOAT"}, description=DESCRIPTION, default={"type": "number"}, minValue={"type": "number"},
           maxValue={"type": "number"})]}
CHUNKS = record(["defaultTaskCount", "rangeConstraint"], defaultTaskCount=WHOLE, targetRuntimeSeconds=WHOLE, rangeConstraint={"enum": ["CONTIGUOUS", "NONCONTIGUOUS"]})
TASK_PARAMETER = record(["name", "type", "range", "chunks"], name=IDENTIFIER, type={"const": "CHUNK[INT]"}, chunks=CHUNKS,
                        range={"anyOf": [text(1024), {"type": "array", "minItems": 1, "maxItems": 1024}]})
CANCELATION = record(["mode", "notifyPeriodInSeconds"], mode={"const": "NOTIFY_THEN_TERMINATE"}, notifyPeriodInSeconds={"type": "integer", "minimum": 1, "maximum": 600})
ACTION = record(["command"], command=text(1024), args={"type": "array", "items": {"type": "string"}}, timeout={"type": "integer", "minimum": 1}, cancelation=CANCELATION)
STEP = record(["name", "script"], name=text(64), description=DESCRIPTION, script=record(["actions"], actions=record(["onRun"], onRun=ACTION)),
              parameterSpace=record(["taskParameterDefinitions"], combination=text(1280),
                                    taskParameterDefinitions={"type": "array", "minItems": 1, "maxItems": 16, "items": TASK_PARAMETER}))
TEMPLATE = record(["specificationVersion", "name", "steps"], specificationVersion={"const": "jobtemplate-2023-09"}, name=text(128), description=DESCRIPTION,
                  extensions={"type": "array", "minItems": 1, "items": {"enum": ["TASK_CHUNKING", "REDACTED_ENV_VARS", "FEATURE_BUNDLE_1", "EXPR"]}},
                  parameterDefinitions={"type": "array", "minItems": 1, "maxItems": 50, "items": PARAMETER}, steps={"type": "array", "minItems": 1, "items": STEP})


def refused(template):
    return not jsonschema.Draft7Validator(TEMPLATE).is_valid(template)


def check_template(template):
    jsonschema.validate(template, TEMPLATE)
    assert "TASK_CHUNKING" in template["extensions"], "CHUNK[INT] needs the extension"
    known = {"Param." + parameter["name"] for parameter in template["parameterDefinitions"]}
    for step in template["steps"]:
        names = known | {"Task.Param." + parameter["name"] for parameter in step["parameterSpace"]["taskParameterDefinitions"]}
        for name in re.findall(r"\{\{\s*(.*?)\s*\}\}", json.dumps(step)):
            assert name in names, f"{{{{{name}}}}} is not defined"
    # The schema refuses what it should.
    for path, value in [(["steps"], []), (["specificationVersion"], "1"), (["steps", 0, "script", "actions", "onRun", "command"], ""), (["steps", 0, "colour"], "red"),
                        (["steps", 0, "parameterSpace", "taskParameterDefinitions", 0, "chunks", "rangeConstraint"], "ANY")]:
        broken = copy.deepcopy(template)
        place = broken
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value
        assert refused(broken), path


def run_task(template, values):
    action = template["steps"][0]["script"]["actions"]["onRun"]
    arguments = [re.sub(r"\{\{\s*(.*?)\s*\}\}", lambda match: values[match[1]], argument) for argument in action["args"]]
    assert action["command"] == "alcove"
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


with open(f"{PROJECT}/examples/farm/alcove.openjd.json") as file:
    template = json.load(file)
check_template(template)
with tempfile.TemporaryDirectory(prefix="alcove-openjd-") as name:
    folder = pathlib.Path(name)
    for frame in range(1, 8):
        shutil.copy(FRAME, folder / f"f.{frame:04}.exr")
    values = {"Param." + parameter["name"]: str(parameter.get("default", "")) for parameter in template["parameterDefinitions"]}
    values |= {"Param.Input": f"{folder}/f.%04d.exr", "Param.Output": f"{folder}/ao.%04d.exr", "Param.Camera": CAMERA}
    for chunk, last in [("2-2", ["0002"]), ("1,3-7:2", ["0001", "0003", "0005", "0007"])]:
        out = run_task(template, values | {"Task.Param.Frame": chunk})
        assert "openjd_progress: 100.0" in out, out
        for number in last:
            assert (folder / f"ao.{number}.exr").exists(), (chunk, os.listdir(folder))
print("the template fits its schema, and its command computes its chunks")
