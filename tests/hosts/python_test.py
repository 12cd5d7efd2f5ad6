# The Python package against the program itself. Takes the program, the project's folder, a frame and its camera.
# SPDX-License-Identifier: BSD-3-Clause
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, PROJECT, FRAME, CAMERA = (os.path.abspath(word) for word in sys.argv[1:5])
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(PROJECT, "hosts/python"))
os.environ["ALCOVE"] = PROGRAM

import alcove  # noqa: E402


class Package(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="alcove-python-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.ao = self.folder / "ao.exr"

    def shot(self, frames):
        for frame in frames:
            os.link(FRAME, self.folder / f"shot.{frame:04d}.exr") if os.stat(FRAME).st_dev == os.stat(self.folder).st_dev else \
                shutil.copy(FRAME, self.folder / f"shot.{frame:04d}.exr")
        return str(self.folder / "shot.####.exr")

    def test_a_run_gives_what_the_program_gives(self):
        events = []
        totals = alcove.run(FRAME, output=self.ao, camera=CAMERA, radius=[0.1, 0.35], slices=3, no_skip=True, denoise="none", roi="100,50,200,100",
                            preview=None, multi_bounce=False, progress=events.append)
        self.assertEqual((totals["done"], totals["failed"], len(totals["frames"])), (1, 0, 1))
        self.assertEqual([event["event"] for event in events], ["begin", "frame", "end"])
        self.assertEqual(totals["frames"][0]["output"], str(self.ao))
        theirs = self.folder / "theirs.exr"
        subprocess.run([PROGRAM, "run", FRAME, "-o", theirs, "--camera", CAMERA, "--radius", "0.1,0.35", "--slices", "3", "--no-skip", "--denoise", "none",
                        "--roi", "100,50,200,100", "-q"], check=True)
        self.assertEqual(self.ao.read_bytes(), theirs.read_bytes())

    def test_a_sequence_tells_its_frames_in_their_order(self):
        frames = []
        totals = alcove.run(self.shot([3, 5, 4]), output=self.folder / "ao.####.exr", camera=CAMERA, radius=0.2, preset="draft",
                            progress=lambda event: frames.append(event.get("frame")))
        self.assertEqual(frames, [None, 3, 4, 5, None])
        self.assertEqual(totals["done"], 3)

    def test_several_files_of_an_option_stand_each_by_itself(self):
        peel = self.folder / "a, peel.exr"
        shutil.copy(FRAME, peel)
        other = self.folder / "b.exr"
        shutil.copy(FRAME, other)
        found = alcove.inspect(FRAME, camera=CAMERA, behind=[peel, other])
        self.assertEqual([file["path"] for file in found["files"]], [FRAME, str(peel), str(other)])

    def test_inspect_gives_its_json(self):
        found = alcove.inspect(FRAME, camera=CAMERA)
        self.assertEqual(found["camera"]["projection"], "perspective")
        self.assertTrue(found["command"].startswith("alcove run "))

    def test_compare_gives_measures_and_holds_limits(self):
        alcove.run(FRAME, output=self.ao, camera=CAMERA, radius=0.1)
        alcove.run(FRAME, output=self.folder / "other.exr", camera=CAMERA, radius=0.5)
        self.assertGreater(alcove.compare(self.ao, self.folder / "other.exr")["rmse"], 0.01)
        with self.assertRaises(alcove.ComparisonError):
            alcove.compare(self.ao, self.folder / "other.exr", max_rmse=0.001)

    def test_errors_are_exceptions_by_exit_code(self):
        with self.assertRaisesRegex(alcove.InputError, "missing.exr") as caught:
            alcove.run(self.folder / "missing.exr", output=self.ao, camera=CAMERA, radius=0.5)
        self.assertEqual((caught.exception.code, caught.exception.events[-1]["failed"]), (3, 1))
        self.assertNotIn("alcove: error", str(caught.exception))
        with self.assertRaisesRegex(alcove.UsageError, "radios.*radius"):
            alcove.run(FRAME, output=self.ao, camera=CAMERA, radios=0.5)
        with self.assertRaisesRegex(alcove.UsageError, "--radius"):
            alcove.run(FRAME, output=self.ao, camera=CAMERA)
        with self.assertRaises(alcove.UsageError):
            alcove.run(FRAME, output=self.ao, camera=CAMERA, radius=0.5, log_json="a.json")
        os.mkdir(self.ao)
        with self.assertRaises(alcove.OutputError):
            alcove.run(FRAME, output=self.ao, camera=CAMERA, radius=0.5)
        pattern = self.shot([1, 2])
        os.remove(self.folder / "shot.0002.exr")
        (self.folder / "shot.0002.exr").write_bytes(b"no picture")
        with self.assertRaises(alcove.FramesFailed) as caught:
            alcove.run(pattern, output=self.folder / "out.####.exr", camera=CAMERA, radius=0.2, keep_going=True)
        self.assertEqual([event["state"] for event in caught.exception.events if event["event"] == "frame"], ["done", "failed"])

    def test_a_callback_that_fails_ends_the_run(self):
        def stop(event):
            raise KeyError(event["event"])
        with self.assertRaises(KeyError):
            alcove.run(self.shot(range(1, 9)), output=self.folder / "ao.####.exr", camera=CAMERA, radius=0.3, progress=stop)
        self.assertEqual([name for name in os.listdir(self.folder) if "unfinished" in name or name.endswith(".tmp")], [])
        self.assertLess(len(list(self.folder.glob("ao.*.exr"))), 8)

    def test_a_program_that_is_not_there_is_told(self):
        os.environ["ALCOVE"] = "/nowhere/alcove"
        try:
            with self.assertRaisesRegex(alcove.DeviceError, "ALCOVE"):
                alcove.version()
        finally:
            os.environ["ALCOVE"] = PROGRAM
        self.assertRegex(alcove.version(), r"^\d+\.\d+\.\d+$")

    def test_versions_agree(self):
        declared = (pathlib.Path(PROJECT) / "hosts/python/pyproject.toml").read_text(encoding="utf-8")
        self.assertIn(f'version = "{alcove.version()}"', declared)


unittest.main(argv=sys.argv[:1])
