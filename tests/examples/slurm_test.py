# Runs examples/farm/slurm.sh on a real Slurm of one node: an array over a sequence, one task of it killed and given out again; the union of all must have
# the bits of a local run. A job keeps to the memory that it asked for. Takes the program, the project's folder, a frame and its camera; exits with 77 where Slurm or the right to start it is missing, but not in CI.
# SPDX-License-Identifier: BSD-3-Clause
import ctypes
import filecmp
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PROGRAM, PROJECT, FRAME, CAMERA = sys.argv[1:5]
FRAMES, CHUNKS, RADIUS, MOST_TRIES = 24, 3, "0.35", 10
NODE_MEMORY, JOB_MEMORY = 1500, 1000  # MiB
PROGRAM_MEMORY = range(74, 250)  # what the program counts for itself: more with more kernels


def skip(reason):
    print(f"SKIPPED: {reason}; the Slurm example was NOT tested (packages.txt names what it needs)")
    sys.exit(1 if os.environ.get("CI") else 77)


def wait_until(condition, what, seconds=90):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise SystemExit(f"waited {seconds} s for {what}")
        time.sleep(0.2)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def die_with_this():
    """In a daemon: it ends when the test does, however that ends."""
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class Cluster:
    """munged, slurmctld and slurmd of our own, all below one folder."""

    def __init__(self, folder):
        self.folder, self.host, self.daemons, self.environment = folder, socket.gethostname().split(".")[0], [], None

    def __enter__(self):
        try:
            self.start_daemons()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_):
        self.stop()

    def start_daemons(self):
        folder = self.folder
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(128))
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket", f"--pid-file={folder}/munge.pid",
                   f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        wait_until(lambda: (folder / "munge.socket").exists(), "munged")
        config = {
            "ClusterName": "alcove", "SlurmctldHost": f"{self.host}(127.0.0.1)", "SlurmUser": "root", "AuthType": "auth/munge",
            "AuthInfo": f"socket={folder}/munge.socket,cred_expire=5",  # seconds that a task waits until it runs again
            "SlurmctldPort": free_port(), "SlurmdPort": free_port(), "StateSaveLocation": folder / "state", "SlurmdSpoolDir": folder / "spool",
            "SlurmctldPidFile": folder / "slurmctld.pid", "SlurmdPidFile": folder / "slurmd.pid", "SlurmctldLogFile": folder / "slurmctld.log",
            "SlurmdLogFile": folder / "slurmd.log", "ProctrackType": "proctrack/linuxproc", "TaskPlugin": "task/none", "MpiDefault": "none",
            "JobAcctGatherType": "jobacct_gather/none", "SelectType": "select/cons_tres", "SelectTypeParameters": "CR_CPU", "ReturnToService": 2,
            "SchedulerParameters": "sched_interval=1,batch_sched_delay=0", "KillWait": 2,
            "NodeName": f"{self.host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} RealMemory={NODE_MEMORY} State=UNKNOWN",
            "PartitionName": f"all Nodes={self.host} Default=YES MaxTime=INFINITE State=UP"}
        path = folder / "slurm.conf"
        path.write_text("".join(f"{key}={value}\n" for key, value in config.items()))
        self.environment = {**os.environ, "SLURM_CONF": str(path), "ALCOVE": PROGRAM}
        if int(self.run("slurmd", "-V").split()[1].split(".")[0]) >= 24:  # would not start in a container or chroot; 22 has no such plugin
            (folder / "cgroup.conf").write_text("CgroupPlugin=disabled\n")
        self.start("slurmctld", "-D", "-f", path)
        self.start("slurmd", "-D", "-f", path, "-N", self.host)
        wait_until(lambda: "idle" in self.run("sinfo", "-h", "-o", "%T", check=False), "slurmd")

    def start(self, *command):
        log = open(self.folder / f"{command[0]}.out", "w")
        self.daemons.append(subprocess.Popen([str(word) for word in command], stdout=log, stderr=log, start_new_session=True, preexec_fn=die_with_this))

    def run(self, *command, check=True):
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True)
        if check and done.returncode != 0:
            raise SystemExit(f"{command}: {done.stdout}{done.stderr}")
        return done.stdout

    def stop(self):
        if self.environment:  # what runs tasks outlives slurmd
            self.run("scancel", "--signal=KILL", "--full", "--me", check=False)
            self.run("scancel", "--me", check=False)
            end = time.monotonic() + 20
            while self.run("squeue", "-h", "-o", "%i", check=False) and time.monotonic() < end:
                time.sleep(0.2)
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in self.daemons:
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()


def arguments(folder, out):
    return [f"{folder}/in/f.%04d.exr", "-o", f"{folder}/{out}/ao.%04d.exr", "--frames", f"1-{FRAMES}", "--camera", CAMERA, "--radius", RADIUS]


def test_memory(cluster, folder):
    """A job plans with half of the memory that it asked for, whatever the node has."""
    command = " ".join([PROGRAM, "run", FRAME, "-o", f"{folder}/ao.exr", "--camera", CAMERA, "--radius", RADIUS, "--dry-run"])
    cluster.run("sbatch", "--wait", f"--mem={JOB_MEMORY}M", f"--output={folder}/memory.log", f"--wrap={command}")
    plan = (folder / "memory.log").read_text()
    for_frames = int(re.search(r", (\d+) MiB for frames", plan)[1])
    assert JOB_MEMORY // 2 - for_frames in PROGRAM_MEMORY, plan


def kill_second_task(cluster, folder, job):
    """Kills the second task between its first and its last frame. One that was quicker runs again from the beginning."""
    part = FRAMES // CHUNKS
    outputs = [folder / "farm" / f"ao.{frame:04}.exr" for frame in range(part + 1, 2 * part + 1)]
    for _ in range(MOST_TRIES):
        wait_until(outputs[0].exists, "the second task")
        # It fails where the task has ended.
        cluster.run("scancel", "--signal=KILL", "--full", f"{job}_2", check=False)
        wait_until(lambda: f"{job}_2" not in cluster.run("squeue", "-h", "-r", "-t", "R,CG", "-o", "%i"), "the end of the killed task")
        if not all(output.exists() for output in outputs):
            return
        for output in outputs:
            output.unlink()
        cluster.run("scontrol", "requeue", f"{job}_2")
    raise SystemExit(f"the second task ended before it was killed, {MOST_TRIES} times")


def test(cluster, folder):
    for name in ("in", "local", "farm"):
        (folder / name).mkdir()
    for frame in range(1, FRAMES + 1):
        shutil.copy(FRAME, folder / "in" / f"f.{frame:04}.exr")
    subprocess.run([PROGRAM, "run", *arguments(folder, "local"), "-q"], check=True)

    job = cluster.run("sbatch", "--parsable", f"--array=1-{CHUNKS}", "-c", "1", f"--output={folder}/task-%a.log", "--open-mode=append",
                      f"{PROJECT}/examples/farm/slurm.sh", *arguments(folder, "farm")).strip()
    kill_second_task(cluster, folder, job)
    cluster.run("scontrol", "requeue", f"{job}_2")
    wait_until(lambda: not cluster.run("squeue", "-h", "-r", "-o", "%i"), "the array", 180)

    names = sorted(path.name for path in (folder / "local").iterdir())
    same, different, missing = filecmp.cmpfiles(folder / "local", folder / "farm", names, shallow=False)
    assert len(same) == FRAMES and sorted(os.listdir(folder / "farm")) == names, (different, missing, os.listdir(folder / "farm"))
    log = (folder / "task-2.log").read_text()
    assert "kept" in log.splitlines()[-1], log
    print(f"{FRAMES} frames in {CHUNKS} tasks, one of them killed and requeued: the bits of a local run")


if not all(shutil.which(name) for name in ("munged", "slurmctld", "slurmd", "sbatch")):
    skip("there is no Slurm")
if os.getuid() != 0:
    skip("only root can start its daemons")
with tempfile.TemporaryDirectory(prefix="alcove-slurm-") as name:
    folder = pathlib.Path(name)
    try:
        with Cluster(folder) as cluster:
            test_memory(cluster, folder)
            test(cluster, folder)
    except BaseException:
        for log in sorted(folder.glob("*.log")) + sorted(folder.glob("*.out")):
            print(f"--- {log.name}\n{log.read_text()[-3000:]}")
        raise
