# Runs examples/farm/README.md's commands for GNU parallel and Snakemake as they stand there, and kills a task on its
# first try; or compiles the job type of Flamenco by Node, with stubs of Flamenco's own functions, and runs its tasks.
# The union of all tasks must have the bits of one local run.
#   farm_test.py parallel|snakemake|flamenco PROGRAM PROJECT FRAME CAMERA
# It exits with 77 where the system is missing, but not in CI. SPDX-License-Identifier: BSD-3-Clause
import filecmp
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SYSTEM, PROGRAM, PROJECT, FRAME, CAMERA = sys.argv[1:6]
FRAMES = "1001-1024"
NAMES = [f"shot.{frame}.exr" for frame in range(1001, 1025)]

# In the place of the program: ends the second part of eight by SIGKILL as soon as some frame is done, but once only.
KILLED_ONCE = """#!/bin/sh
case "$*" in
  *"--chunk 2/8"*)
    if mkdir killed 2>/dev/null; then
      "$PROGRAM" "$@" &
      while [ -e /proc/$! ] && ! ls ao/*.exr >/dev/null 2>&1; do sleep .02; done
      kill -9 $!
      exit 137
    fi ;;
esac
exec "$PROGRAM" "$@"
"""
FLAMENCO = """
const fs = require("fs"), vm = require("vm"), [file, settings] = process.argv.slice(1);
const numbers = text => text.split(",").flatMap(part => {
  const [first, last] = part.split("-").map(Number);
  return Array.from({length: (last || first) - first + 1}, (_, index) => first + index);
});
const tasks = [], world = {
  frameChunker: (frames, size) => {
    const all = numbers(frames), chunks = [];
    for (let at = 0; at < all.length; at += size) chunks.push(`${all[at]}-${all[Math.min(at + size, all.length) - 1]}`);
    return chunks;
  },
  author: {
    Task: (name, type) => ({name, type, commands: [], addCommand(command) { this.commands.push(command); }}),
    Command: (name, parameters) => ({name, parameters}),
  },
};
vm.runInNewContext(fs.readFileSync(file, "utf8") + "; this.type = JOB_TYPE; this.compile = compileJob;", world);
const given = JSON.parse(settings), all = {};
for (const setting of world.type.settings) {
  if (!["string", "int32", "float", "bool"].includes(setting.type)) throw `${setting.key} is of type ${setting.type}`;
  if (setting.required && !(setting.key in given)) throw `${setting.key} is required`;
  all[setting.key] = setting.key in given ? given[setting.key] : setting.default;
  if (all[setting.key] === undefined) throw `${setting.key} has no value`;
}
world.compile({settings: all, addTask: task => tasks.push(task)});
console.log(JSON.stringify(tasks));
"""


def command_of(begin):
    """The command of the README whose line begins so, with the lines that continue it, for fewer frames."""
    text = pathlib.Path(PROJECT, "examples/farm/README.md").read_text()
    command = re.search(r"^    (" + begin + r"(?:.*\\\n)*.*)", text, re.M)[1]
    return command.replace("1001-1100", FRAMES).replace("examples/farm/", f"{PROJECT}/examples/farm/")


def run(folder, command):
    environment = os.environ | {"PATH": f"{folder}/bin:{os.environ['PATH']}", "PROGRAM": PROGRAM, "HOME": str(folder)}
    done = subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, (command, done.returncode, done.stdout, done.stderr)


def run_flamenco(folder):
    settings = {"frames": FRAMES, "chunk_size": 7, "input": f"{folder}/shot.%04d.exr", "camera": CAMERA,
                "output": f"{folder}/ao/shot.%04d.exr", "alcove": PROGRAM}
    done = subprocess.run(["node", "-e", FLAMENCO, f"{PROJECT}/examples/farm/alcove.flamenco.js", json.dumps(settings)],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    tasks = json.loads(done.stdout)
    parts = []
    for task in tasks:
        (command,) = task["commands"]
        assert command["name"] == "exec" and set(command["parameters"]) == {"exe", "args"}, command
        exe, args = command["parameters"]["exe"], command["parameters"]["args"]
        subprocess.run([exe, *args], check=True, capture_output=True)
        parts.append(args[args.index("--frames") + 1])
    assert parts == ["1001-1007", "1008-1014", "1015-1021", "1022-1024"], parts


needed = {"flamenco": "node"}.get(SYSTEM, SYSTEM)
if not shutil.which(needed):
    print(f"SKIPPED: there is no {needed} (packages.txt names it)")
    sys.exit(1 if os.environ.get("CI") else 77)
with tempfile.TemporaryDirectory(prefix="alcove-farm-") as name:
    folder = pathlib.Path(name)
    for name in NAMES:
        shutil.copy(FRAME, folder / name)
    shutil.copy(CAMERA, folder / "shot.json")
    (folder / "bin").mkdir()
    (folder / "bin/alcove").write_text(KILLED_ONCE)
    (folder / "bin/alcove").chmod(0o755)
    subprocess.run([PROGRAM, "run", "shot.%04d.exr", "-o", "local/shot.%04d.exr", "--frames", FRAMES, "--camera",
                    "shot.json", "--radius", "0.5", "-q"], check=True, cwd=folder)
    if SYSTEM == "flamenco":
        run_flamenco(folder)
    else:
        run(folder, command_of({"parallel": r"seq 1 8 \| parallel"}.get(SYSTEM, SYSTEM)))
        assert (folder / "killed").exists(), "no task was killed"
    same, different, missing = filecmp.cmpfiles(folder / "local", folder / "ao", NAMES, shallow=False)
    assert len(same) == len(NAMES), (different, missing)
    print(f"{SYSTEM}: {len(same)} frames with the bits of a local run")
