# The wheel holds what it says, and computes without Alcove beside it, with the library that it brings.
# Takes scripts/wheel.py, the library, and the project's folder.
# SPDX-License-Identifier: BSD-3-Clause
import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile

SCRIPT, LIBRARY, PROJECT = sys.argv[1:4]
USE = """
import alcove, numpy, sys
z = numpy.full((48, 64), 5, numpy.float32)
z[:, :20] = 4
ao = alcove.ao(z, radius=1, fov=40)
assert ao.shape == z.shape and ao[:, 40:].min() > .99 and ao[:, 20:24].max() < .9, (ao[:, 40:].min(), ao[:, 20:24].max())
loaded = {line.split()[-1] for line in open("/proc/self/maps") if "libalcove" in line}
assert loaded == {sys.argv[1]}, loaded
"""


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([sys.executable, SCRIPT, LIBRARY, cls.folder.name], check=True, capture_output=True)
        cls.path, = pathlib.Path(cls.folder.name).glob("*.whl")
        cls.wheel = zipfile.ZipFile(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.wheel.close()
        cls.folder.cleanup()

    def test_its_record_has_every_file(self):
        rows = dict(line.split(",", 1) for line in self.wheel.read(self.of_info("RECORD")).decode().splitlines())
        self.assertEqual(set(rows), set(self.wheel.namelist()))
        for name, row in rows.items():
            data = self.wheel.read(name)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            self.assertEqual(row, "," if name.endswith("RECORD") else f"sha256={digest},{len(data)}")

    def of_info(self, name):
        return next(one for one in self.wheel.namelist() if one.endswith(".dist-info/" + name))

    def test_its_tag_covers_all_that_its_libraries_ask_for(self):
        tag = tuple(map(int, re.search(r"manylinux_(\d+)_(\d+)", self.path.name).groups()))
        self.assertIn(f"Tag: {'-'.join(self.path.stem.split('-')[2:])}\n", self.wheel.read(self.of_info("WHEEL")).decode())
        for name in self.wheel.namelist():
            if ".so" in name:
                asked = [tuple(map(int, pair)) for pair in re.findall(rb"GLIBC_(\d+)\.(\d+)", self.wheel.read(name))]
                self.assertLessEqual(max(asked), tag, name)

    def test_it_has_the_package_and_the_licences(self):
        names = self.wheel.namelist()
        for path in pathlib.Path(PROJECT, "hosts/python/alcove").glob("*.py"):
            self.assertEqual(self.wheel.read("alcove/" + path.name), path.read_bytes())
        self.assertIn("Name: alcove\n", self.wheel.read(self.of_info("METADATA")).decode())
        licences = {name.rsplit("/", 1)[1] for name in names if "/licenses/" in name}
        self.assertLessEqual({"alcove", "libfmt9", "libvulkan1"}, licences)

    def test_it_computes_without_anything_else_of_alcove(self):
        with tempfile.TemporaryDirectory() as installed:
            self.wheel.extractall(installed)
            library = str(pathlib.Path(installed, "alcove", pathlib.Path(LIBRARY).name).resolve())
            subprocess.run([sys.executable, "-c", USE, library], check=True, cwd="/",
                           env={"PYTHONPATH": installed, "PATH": "/nonexistent", "HOME": installed})


unittest.main(argv=sys.argv[:1])
