# Runs examples/ci/job.sh as it stands there: it approves its own pictures, passes, and fails where one has changed. Then holds
# docs/frames.schema.json against the program: it takes the lists that the program takes, and refuses those that it refuses.
#   ci_test.py PROGRAM PROJECT
# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
import xml.etree.ElementTree

import jsonschema

PROGRAM, PROJECT = sys.argv[1], pathlib.Path(sys.argv[2])
FRAME = PROJECT / "examples/bench/interior.gbuffer.exr"
GOOD = f'[[frame]]\nname = "a"\ninput = "{FRAME}"\nradius = 0.5\n'
LISTS = {
    "the example": (PROJECT / "examples/ci/frames.toml").read_text(),
    "a suite": (PROJECT / "examples/bench/suite.toml").read_text(),
    "a frame": GOOD,
    "limits": GOOD + "max-rmse = 1e-4\nmin-ssim = -1\n",
    "a limit of no name": GOOD + "max-rsme = 1e-4\n",
    "a limit out of its range": GOOD + "max-rmse = -1\n",
    "a limit in words": GOOD + 'max-rmse = "low"\n',
    "two references": GOOD + 'reference = ["a.exr", "b.exr"]\n',
    "three references": GOOD + 'reference = ["a.exr", "b.exr", "c.exr"]\n',
    "a reference of no name": GOOD + 'reference = ""\n',
    "no input": '[[frame]]\nname = "a"\n',
    "no name": f'[[frame]]\ninput = "{FRAME}"\n',
    "a folder as name": f'[[frame]]\nname = "../a"\ninput = "{FRAME}"\n',
    "a radius of 0": GOOD.replace("0.5", "0"),
    "no frame": 'title = "none"\n',
    "a frame that is no list": f'[frame]\nname = "a"\ninput = "{FRAME}"\n',
    "a key of no name": "[frames]\n" + GOOD,
}


def check_job(folder):
    shutil.copytree(PROJECT / "examples/ci", folder / "ci")
    (folder / "bench").symlink_to(PROJECT / "examples/bench")

    def job(*arguments):
        done = subprocess.run([folder / "ci/job.sh", folder / "out", *arguments], capture_output=True, text=True, check=False,
                              env=os.environ | {"ALCOVE": PROGRAM})
        return done.returncode, done.stdout + done.stderr

    code, said = job()
    assert code == 3 and "approved/interior.exr" in said and "job.sh" in said and "out --approve" in said, said
    results = xml.etree.ElementTree.parse(folder / "out/junit.xml").getroot()
    assert [case.find("error") is not None for case in results] == [True, True] and results.get("errors") == "2"
    code, said = job("--approve")
    assert code == 0 and "no approved pictures" not in said, said
    code, said = job()
    assert code == 0, said
    results = xml.etree.ElementTree.parse(folder / "out/junit.xml").getroot()
    assert results.get("tests") == "2" and results.get("failures") == "0"
    subprocess.run([PROGRAM, "run", PROJECT / "examples/bench/monkeys.gbuffer.exr", "--camera", PROJECT / "examples/bench/monkeys.camera.json",
                    "--radius", "0.4", "-o", folder / "ci/approved/monkeys.exr", "-q"], check=True)
    code, said = job()
    assert code == 6 and "frame monkeys: rmse" in said and "interior: " not in said.split("error:")[-1], said
    failed = [case.get("name") for case in xml.etree.ElementTree.parse(folder / "out/junit.xml").getroot() if case.find("failure") is not None]
    assert failed == ["monkeys"] and (folder / "out/junit.monkeys.error.png").exists() and (folder / "out/report.html").exists()


def check_schema(folder):
    schema = jsonschema.Draft202012Validator(json.loads((PROJECT / "docs/frames.schema.json").read_text(encoding="utf-8")))
    schema.check_schema(schema.schema)
    for what, text in LISTS.items():
        path = folder / "list.toml"
        path.write_text(text, encoding="utf-8")
        done = subprocess.run([PROGRAM, "compare", "{name}.exr", path], capture_output=True, text=True, check=False)
        takes = not any(mark in done.stderr for mark in ("[[frame]]", "the list has no", "of the list"))
        assert takes == schema.is_valid(tomllib.loads(text)), f"{what}: the program {'takes' if takes else 'refuses'} it: {done.stderr}"


with tempfile.TemporaryDirectory() as made:
    check_job(pathlib.Path(made))
    check_schema(pathlib.Path(made))
print("the job runs, and the schema is the program's")
