# The menu script of Nuke with the real program, against a stub of nuke. Takes the program, a frame and its camera.
# SPDX-License-Identifier: BSD-3-Clause
import importlib.util
import json
import math
import os
import pathlib
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest

import jsonschema

sys.dont_write_bytecode = True  # beside the scripts
PROGRAM, FRAME, CAMERA = (os.path.abspath(word) for word in sys.argv[1:4])
QUICK = "--slices 1 --steps 4 --denoise none"
LONG_S = 200
HOSTS = pathlib.Path(__file__).resolve().parents[2] / "hosts"
SCHEMA = jsonschema.Draft202012Validator(json.loads((HOSTS.parent / "docs/camera.schema.json").read_text(encoding="utf-8")))

# Points in front of cameras that stand_at() gives.
POINTS = [(0.3, -0.2, 0.1), (-1.2, 0.7, 0.4), (0.9, 1.1, -0.6), (0, 0, 0)]


def script(path):
    """A script of hosts/ as a module; the stub of its host must be there."""
    spec = importlib.util.spec_from_file_location(pathlib.Path(path).stem, HOSTS / path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(matrix):
    """By Gauss and Jordan: knows nothing of rotations."""
    rows = [list(row) + [float(i == j) for j in range(4)] for i, row in enumerate(matrix)]
    for i in range(4):
        pivot = max(range(i, 4), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for r in range(4):
            if r != i:
                rows[r] = [x - rows[r][i] * y for x, y in zip(rows[r], rows[i])]
    return [row[4:] for row in rows]


def applied(matrix, point):
    """The product with a column vector."""
    return [sum(a * b for a, b in zip(row, [*point, 1])) for row in matrix]


def stand_at(frame, scale=1.0):
    """The transform of a camera to the world, for column vectors: some 5 units away from the origin, which it nearly looks at,
    turned about all axes; it moves with the frame."""
    yaw, pitch, roll = 0.4 + 0.1 * frame, -0.25, 0.15
    turns = [
        [[math.cos(yaw), 0, math.sin(yaw), 0], [0, 1, 0, 0], [-math.sin(yaw), 0, math.cos(yaw), 0], [0, 0, 0, 1]],
        [[1, 0, 0, 0], [0, math.cos(pitch), -math.sin(pitch), 0], [0, math.sin(pitch), math.cos(pitch), 0], [0, 0, 0, 1]],
        [[math.cos(roll), -math.sin(roll), 0, 0], [math.sin(roll), math.cos(roll), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        [[scale, 0, 0, 0], [0, scale, 0, 0], [0, 0, scale, 0], [0, 0, 0, 1]],
    ]
    matrix = [[float(i == j) for j in range(4)] for i in range(4)]
    for turn in turns:
        matrix = product(matrix, turn)
    for i in range(3):
        matrix[i][3] = 5 * matrix[i][2] / scale + (0.2, 0.1, -0.3)[i]
    return matrix


def pixel(camera, point):
    """Where Alcove sees a point of the world: px from the left and the upper edge."""
    x, y, z, _ = applied(camera["world_to_camera"], point)
    divisor = 1 if camera["projection"] == "orthographic" else -z
    return camera["cx"] + camera["fx"] * x / divisor, camera["cy"] - camera["fy"] * y / divisor


class Knob:
    """A knob whose value, or list of values, may be a function of the frame."""

    def __init__(self, value):
        self.held = value
        self.pressed = 0

    def value(self):
        return self.held

    def getValueAt(self, frame, index=0):
        value = self.held(frame) if callable(self.held) else self.held
        return value[index] if isinstance(value, (list, tuple)) else value

    def setValue(self, value):
        self.held = value

    def execute(self):
        self.pressed += 1


class Format:
    def __init__(self, width, height, pixel_aspect=1.0):
        self.numbers = width, height, pixel_aspect

    def width(self):
        return self.numbers[0]

    def height(self):
        return self.numbers[1]

    def pixelAspect(self):
        return self.numbers[2]


class Node:
    def __init__(self, kind, name, **knobs):
        self.kind, self.called, self.place = kind, name, (0, 0)
        self.knobs = {knob: Knob(value) for knob, value in knobs.items()}

    def __getitem__(self, name):
        return self.knobs[name]

    def Class(self):
        return self.kind

    def name(self):
        return self.called

    def xpos(self):
        return self.place[0]

    def ypos(self):
        return self.place[1]

    def setXYpos(self, x, y):
        self.place = x, y


def read_node(file, first, last, format=None, **knobs):
    return Node("Read", "Read1", **{"file": file, "first": first, "last": last, "format": format or Format(960, 540), "frame": "",
                                    "frame_mode": "expression", "reload": None, **knobs})


def camera_node(name="Camera1", **knobs):
    return Node("Camera3", name, **{
        "projection_mode": "perspective", "focal": 50.0, "haperture": 24.576, "vaperture": 18.672, "near": 0.1, "far": 10000.0,
        "win_translate": (0.0, 0.0), "win_scale": (1.0, 1.0), "winroll": 0.0,
        "world_matrix": lambda frame: [x for row in stand_at(frame) for x in row], **knobs})


class Nuke:
    """What the stub keeps, and what of it the script sees as the module `nuke`."""

    def __init__(self):
        self.nodes, self.selected, self.messages, self.tasks, self.panels = [], [], [], [], []
        self.calls = queue.Queue()
        self.answers = {}
        self.panel_is_left = False
        self.cancels = lambda task: False
        stub = self

        class Panel:
            def __init__(self, title):
                self.fields = {}
                stub.panels.append(self)

            def addSingleLineInput(self, name, value):
                self.fields[name] = value

            addFilenameSearch = addSingleLineInput

            def addEnumerationPulldown(self, name, words):
                self.fields[name] = words.split()[0]
                self.words = {**getattr(self, "words", {}), name: words.split()}

            def show(self):
                return not stub.panel_is_left

            def value(self, name):
                return stub.answers.get(name, self.fields[name])

        class ProgressTask:
            def __init__(self, title):
                self.progress = []
                stub.tasks.append(self)

            def setProgress(self, percent):
                assert isinstance(percent, int)
                self.progress.append(percent)

            def isCancelled(self):
                return stub.cancels(self)

        class FrameRanges:
            """Of Nuke's own notation: ranges with steps, and blanks between them."""

            def __init__(self, text):
                self.numbers = []
                for part in text.split():
                    ends, _, step = part.partition("x")
                    first, _, last = ends.partition("-")
                    self.numbers += range(int(first), int(last or first) + 1, int(step or 1))

            def toFrameList(self):
                return self.numbers

        def in_main_thread(function):
            def checked(*args, **kwargs):
                assert threading.current_thread() is threading.main_thread(), "%s in a thread" % function.__name__
                return function(*args, **kwargs)
            return checked

        @in_main_thread
        def make_read(**knobs):
            node = read_node(**knobs)
            node.called = "Read%d" % (len(stub.nodes) + 1)
            stub.nodes.append(node)
            return node

        module = types.ModuleType("nuke")
        module.Panel, module.ProgressTask, module.FrameRanges = Panel, ProgressTask, FrameRanges
        module.nodes = types.SimpleNamespace(Read=make_read)
        module.allNodes = in_main_thread(lambda: list(stub.nodes))
        module.selectedNodes = in_main_thread(lambda: list(stub.selected))
        module.toNode = lambda name: next(node for node in stub.nodes if node.name() == name)
        module.filename = lambda node: node["file"].value() or None
        module.message = in_main_thread(self.messages.append)
        module.executeInMainThread = lambda call, args=(), kwargs={}: stub.calls.put((call, args, kwargs))
        self.module = module

    def idle(self):
        """What Nuke does between events."""
        while not self.calls.empty():
            call, args, kwargs = self.calls.get()
            call(*args, **kwargs)


class Script(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="alcove-hosts-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.path = str(self.folder / "cameras.json")
        self.nuke = Nuke()
        sys.modules["nuke"] = self.nuke.module
        self.script = script("nuke/alcove_nuke.py")
        self.script.POLL_S = 0.01  # frames of this size are quick
        os.environ["ALCOVE"] = PROGRAM

    # ---- the camera ----

    def camera(self, frame=4, format=None, **knobs):
        self.node, self.format = camera_node(**knobs), format or Format(960, 540)
        self.script.write_cameras(self.path, self.node, self.format, [frame])
        return self.entry(self.path, frame)

    def host_pixel(self, frame=4):
        """As Nuke multiplies matrices: the lens is focal / haperture for both axes, and x from -1 to 1 is the format's width;
        the window's translation and scale act there, and pixels are square but for the format's aspect."""
        at = {name: knob.getValueAt for name, knob in self.node.knobs.items()}
        world = [[at["world_matrix"](frame, 4 * row + column) for column in range(4)] for row in range(4)]
        lens = 2 * at["focal"](frame) / at["haperture"](frame)
        is_flat = self.node["projection_mode"].value() == "orthographic"
        projection = [[lens, 0, 0, 0], [0, lens, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1] if is_flat else [0, 0, -1, 0]]
        translation = [[1, 0, 0, -at["win_translate"](frame, 0)], [0, 1, 0, -at["win_translate"](frame, 1)], [0, 0, 1, 0], [0, 0, 0, 1]]
        scale = [[1 / at["win_scale"](frame, 0), 0, 0, 0], [0, 1 / at["win_scale"](frame, 1), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
        width, height, aspect = self.format.numbers
        half = width / 2
        to_format = [[half, 0, 0, half], [0, half * aspect, 0, height / 2], [0, 0, 1, 0], [0, 0, 0, 1]]
        lens_and_world = product(projection, inverse(world))

        def see(point):
            # x and y are divided first: what follows is of the picture's plane.
            x, y, z, w = applied(lens_and_world, point)
            x, y, _, _ = applied(product(product(to_format, scale), translation), (x / w, y / w, z / w))
            return x, height - y  # Nuke counts upwards
        return see

    def assert_rigid(self, camera):
        """Lengths and angles in the camera's space are those of the world, and right and left are not exchanged."""
        rows = [row[:3] for row in camera["world_to_camera"][:3]]
        for i in range(3):
            for j in range(3):
                self.assertAlmostEqual(sum(a * b for a, b in zip(rows[i], rows[j])), float(i == j), places=9)
        (a, b, c), (d, e, f), (g, h, i) = rows
        self.assertGreater(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g), 0)
        self.assertEqual(camera["world_to_camera"][3], [0, 0, 0, 1])

    def assert_sees(self, frame=4, **settings):
        """With these settings, points of the world land where Nuke's own formulas put them."""
        camera, host_pixel = self.camera(frame, **settings), self.host_pixel(frame)
        self.assert_rigid(camera)
        seen = [pixel(camera, point) for point in POINTS]
        for point, (x, y) in zip(POINTS, seen):
            host_x, host_y = host_pixel(point)
            self.assertAlmostEqual(x, host_x, delta=1e-6, msg="x of %s" % (point,))
            self.assertAlmostEqual(y, host_y, delta=1e-6, msg="y of %s" % (point,))
        # What is compared must depend on the camera: points are well apart.
        self.assertGreater(max(x for x, _ in seen) - min(x for x, _ in seen), 20)
        self.assertGreater(max(y for _, y in seen) - min(y for _, y in seen), 20)
        return camera

    def assert_refused(self, words, **settings):
        with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
            self.camera(**settings)
        self.assertFalse(pathlib.Path(self.path).exists())

    def entries(self, path):
        """The cameras of a file that the schema takes."""
        written = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        SCHEMA.validate(written)
        return written["frames"]

    def entry(self, path, frame):
        """The camera of a frame."""
        [entry] = [entry for entry in self.entries(path) if entry["frame"] == frame]
        for name in ("resolution", "fx", "fy", "cx", "cy", "world_to_camera"):
            self.assertIn(name, entry)
        return entry

    def test_cameras_see_as_nuke_does(self):
        for settings in ({}, {"format": Format(300, 500), "vaperture": 3.0},  # the aperture lies across the format
                         {"frame": 2, "focal": lambda frame: 20.0 + frame}, {"frame": 9, "focal": lambda frame: 20.0 + frame},
                         {"world_matrix": lambda frame: [x for row in stand_at(frame, 10.0) for x in row]}):  # scale takes no part
            with self.subTest(settings=settings):
                self.assert_sees(**settings)
        camera = self.assert_sees(format=Format(914, 1080, 2.0), win_translate=(0.1, 0.2))
        self.assertAlmostEqual(camera["fy"], 2 * camera["fx"])
        camera = self.assert_sees(win_translate=(0.1, -0.05), win_scale=(0.8, 0.5))
        self.assertLess(camera["cx"], 480)  # the window moves to the right, and what it shows to the left
        self.assertLess(camera["cy"], 270)
        camera = self.assert_sees(projection_mode="orthographic", focal=3.0, win_translate=(0.1, 0.3))
        self.assertEqual(camera["projection"], "orthographic")

    def test_clip_planes_are_told_where_they_make_sense(self):
        self.assertEqual([self.camera()[plane] for plane in ("near", "far")], [0.1, 10000])
        self.assertNotIn("near", self.camera(near=0.0))

    def test_what_camera_files_cannot_say_is_told(self):
        self.assert_refused("roll", winroll=5.0)
        self.assert_refused("Camera1 is spherical", projection_mode="spherical")

    # ---- the run ----

    def frame_camera(self):
        """A Camera node that saw the frame."""
        seen = json.loads(pathlib.Path(CAMERA).read_text(encoding="utf-8"))
        return camera_node(focal=seen["focal_length_mm"], haperture=seen["sensor_width_mm"],
                           world_matrix=[x for row in seen["camera_to_world"] for x in row])

    def shot(self, frames):
        for frame in frames:
            shutil.copy(FRAME, self.folder / ("shot.%04d.exr" % frame))
        return str(self.folder / "shot.####.exr")

    def compute(self, *nodes, **answers):
        """The menu's command with these nodes selected, while Nuke's main thread goes on."""
        self.nuke.nodes += [node for node in nodes if node not in self.nuke.nodes]
        self.nuke.selected = list(nodes)
        self.nuke.answers = {"Radius (0 = auto)": "0.35", "Preset": "draft", "More options": QUICK,
                             **{name.replace("_", " "): value for name, value in answers.items()}}
        thread = self.script.compute()
        end = time.monotonic() + LONG_S
        while thread and thread.is_alive() and time.monotonic() < end:
            self.nuke.idle()
            time.sleep(0.02)
        self.assertFalse(thread and thread.is_alive(), "the program did not end")
        self.nuke.idle()

    def reads(self):
        return [node for node in self.nuke.nodes[1:] if node.Class() == "Read"]

    def unfinished(self):
        """What is there and is neither an input, nor a camera file, nor an AO that can be read to its end."""
        odd = []
        for path in self.folder.rglob("*"):
            if path.is_dir() or path.name.startswith("shot.") and path.parent == self.folder or path.name.endswith(".camera.json"):
                continue
            if path.suffix != ".exr" or subprocess.run([PROGRAM, "compare", path, path], capture_output=True, check=False).returncode:
                odd.append(path.name)
        return odd

    def test_the_ao_of_a_read_node_comes_as_a_read_node(self):
        source = read_node(self.shot([3, 4, 5]), 3, 5)
        source.setXYpos(40, -70)
        self.compute(source, self.frame_camera())
        self.assertEqual(self.nuke.messages, [])
        [result] = self.reads()
        output = str(self.folder / "ao/shot.####.exr")
        self.assertEqual([result[knob].value() for knob in ("file", "first", "last", "raw")], [output, 3, 5, True])
        self.assertEqual(result.place, (150, -70))
        self.assertEqual(self.unfinished(), [])
        # It is what the command line gives with the frame's own camera file.
        theirs = self.folder / "theirs.exr"
        subprocess.run([PROGRAM, "run", FRAME, "-o", theirs, "--camera", CAMERA, "--radius", "0.35", "--preset", "draft", "-q",
                        "--set", "ao-channels=rgb", *QUICK.split()], check=True)
        for frame in (3, 5):
            measured = json.loads(subprocess.run([PROGRAM, "compare", self.folder / ("ao/shot.%04d.exr" % frame), theirs, "--json"],
                                                 capture_output=True, check=True).stdout)
            self.assertLess(measured["rmse"], 1e-3)
        # A second run loads it again, and adds no node.
        self.compute(source, self.nuke.nodes[1], Frames="4")
        self.assertEqual((self.reads(), result["reload"].pressed), ([result], 1))
        self.assertEqual((result["first"].value(), result["last"].value()), (3, 5))
        result["last"].setValue(3)
        self.compute(source, self.nuke.nodes[1], Frames="4")
        self.assertEqual((result["first"].value(), result["last"].value()), (3, 4))

    def test_a_still_has_the_number_that_the_read_node_gives_it(self):
        still = self.folder / "shot.exr"
        shutil.copy(FRAME, still)
        self.compute(read_node(str(still), 7, 7), self.frame_camera())
        self.assertEqual(self.nuke.messages, [])
        self.assertEqual([entry["frame"] for entry in self.entries(self.folder / "ao/shot.camera.json")], [7])
        self.assertEqual([node["file"].value() for node in self.reads()], [str(self.folder / "ao/shot.exr")])
        self.assertEqual(self.unfinished(), [])

    def test_progress_is_told(self):
        self.compute(read_node(self.shot(range(1, 7)), 1, 6), self.frame_camera(), Frames="1-6x2,6")
        [task] = self.nuke.tasks
        self.assertEqual(task.progress, sorted(task.progress))
        self.assertEqual((task.progress[0], task.progress[-1]), (0, 100))
        self.assertTrue(any(0 < percent < 100 for percent in task.progress), task.progress)
        self.assertEqual(sorted(path.name for path in (self.folder / "ao").glob("*.exr")), ["shot.%04d.exr" % frame for frame in (1, 3, 5, 6)])

    def test_cancel_ends_the_program_and_leaves_nothing_partial(self):
        self.nuke.cancels = lambda task: any(percent > 0 for percent in task.progress)
        self.compute(read_node(self.shot(range(1, 61)), 1, 60), self.frame_camera())
        self.assertEqual((self.nuke.messages, self.reads()), ([], []))
        self.assertLess(len(list((self.folder / "ao").glob("*.exr"))), 60)
        self.assertEqual(self.unfinished(), [])
        self.assertLess(self.nuke.tasks[0].progress[-1], 100)

    def test_warnings_reach_the_user_beside_the_result(self):
        self.compute(read_node(self.shot([1]), 1, 1), self.frame_camera(), **{"Radius (0 = auto)": "100"})
        [message] = self.nuke.messages
        self.assertIn("radius-beyond-picture", message)
        self.assertEqual(len(self.reads()), 1)

    def test_errors_reach_the_user(self):
        self.compute(read_node(str(self.folder / "missing.exr"), 1, 1), self.frame_camera())
        [message] = self.nuke.messages
        self.assertIn("missing.exr", message)
        self.assertIn("exit code 3", message)
        self.compute(self.nuke.nodes[0], self.nuke.nodes[1], More_options="--radios 3")
        self.assertIn("--radios", self.nuke.messages[-1])
        self.assertEqual(self.reads(), [])
        os.environ["ALCOVE"] = "/nowhere/alcove"
        self.compute(self.nuke.nodes[0])
        self.assertIn("ALCOVE", self.nuke.messages[-1])

    def test_what_is_proposed(self):
        self.nuke.panel_is_left = True
        source, first, second = read_node("/shots/a.%04d.exr", 1001, 1003), camera_node("Left"), camera_node("Right")
        self.compute(source)
        fields = self.nuke.panels[-1].fields
        self.assertEqual((fields["Frames"], fields["Output"], fields["Camera"]), ("1001-1003", "/shots/ao/a.%04d.exr", "file"))
        self.compute(read_node("still.exr", 7, 7))
        fields = self.nuke.panels[-1].fields
        self.assertEqual((fields["Frames"], fields["Output"]), ("7", "ao/still.exr"))
        self.nuke.nodes.append(first)
        self.compute(source)
        self.assertEqual(self.nuke.panels[-1].words["Camera"], ["Left", "file"])  # the only one
        self.compute(source, second)
        self.assertEqual(self.nuke.panels[-1].words["Camera"], ["Right", "file", "Left"])  # the selected one
        self.compute(source)
        self.assertEqual(self.nuke.panels[-1].words["Camera"], ["file", "Left", "Right"])
        self.assertEqual((self.nuke.messages, self.nuke.tasks, list(self.folder.iterdir())), ([], [], []))

    def command(self, read, **settings):
        """The words of a run, and what the camera file has."""
        self.nuke.nodes = [read, camera_node()]
        words = self.script.command_for(read, read["file"].value(), {
            "radius": "0", "preset": "standard", "frames": "1-3", "output": str(self.folder / "ao/a_%04d.exr"), "camera": "Camera1",
            "options": "", **settings})
        return words

    def test_the_command_is_what_a_user_would_type(self):
        words = self.command(read_node("a.####.exr", 1, 9), frames="1-5x2, 9", options="--normal none --beauty 'a b.exr'")
        cameras = str(self.folder / "ao/a.camera.json")
        self.assertEqual(words, [PROGRAM, "run", "a.####.exr", "-o", str(self.folder / "ao/a_%04d.exr"), "--radius", "auto", "--preset", "standard",
                                 "--frames", "1-5x2,9", "--set", "ao-channels=rgb", "--progress", "percent", "--camera", cameras,
                                 "--normal", "none", "--beauty", "a b.exr"])
        self.assertEqual([entry["frame"] for entry in self.entries(cameras)], [1, 3, 5, 9])
        self.assertNotIn("--camera", self.command(read_node("a.####.exr", 1, 9), camera="file"))

    def test_frames_that_are_shifted_are_refused_beside_a_camera_node(self):
        with self.assertRaisesRegex(ValueError, "shifts its frames"):
            self.command(read_node("a.####.exr", 1, 9, frame="1001", frame_mode="start at"))
        with self.assertRaisesRegex(ValueError, "shifts its frames"):
            self.command(read_node("a.####.exr", 1, 9, frame="frame+10"))
        for fine in ({"frame": "1", "frame_mode": "start at"}, {"frame": "0", "frame_mode": "offset"}, {"frame": "frame"}):
            self.command(read_node("a.####.exr", 1, 9, **fine))
        self.command(read_node("a.####.exr", 1, 9, frame="frame+10"), camera="file")

    def test_one_read_node_must_be_selected(self):
        self.compute(camera_node())
        self.assertIn("Select one Read node", self.nuke.messages[0])
        self.compute(read_node("", 1, 1))
        self.assertIn("names no file", self.nuke.messages[1])
        self.compute(read_node("a.%V.####.exr", 1, 1))
        self.assertIn("one view", self.nuke.messages[2])
        self.assertEqual(self.nuke.panels, [])

    def test_the_menu_has_the_command(self):
        added = {}
        menu = types.SimpleNamespace(addMenu=lambda name: types.SimpleNamespace(addCommand=added.__setitem__))
        self.nuke.module.menu = lambda name: {"Nuke": menu}[name]
        sys.modules["alcove_nuke"] = self.script
        script("nuke/menu.py")
        self.assertEqual(added, {"Ambient Occlusion...": self.script.compute})


unittest.main(argv=sys.argv[:1])
