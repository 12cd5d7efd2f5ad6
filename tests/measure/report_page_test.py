#!/usr/bin/env python3
"""Opens report pages in headless Chromium and uses them as a person would; any console message, request or alert fails.

    report_page_test.py PROGRAM

PROGRAM makes a page of JSON (tests/measure/report_page.cpp). Only Python's own library and Debian's chromium-driver are needed.
"""
# SPDX-License-Identifier: BSD-3-Clause
import base64
import json
import math
import os
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
import zlib

HOSTILE = "<script>alert(1)</script>"
FRAMES = ["colonnade", "foliage", "</script><img src=x onerror=alert(2)>"]
YARDSTICK_MS = 61.5
WIDTH, HEIGHT = 96, 54
RIGHT = "\ue014"  # WebDriver's name for the arrow key


# What the pages show.

def png(pixel):
    """A PNG of WIDTH x HEIGHT as a data URL; `pixel(x, y)` gives (r, g, b)."""
    rows = b"".join(b"\0" + b"".join(bytes(pixel(x, y)) for x in range(WIDTH)) for y in range(HEIGHT))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return "data:image/png;base64," + base64.b64encode(data).decode()


def truth(x, y):
    """AO of a ball above a floor, more or less."""
    distance = math.hypot(x - WIDTH * 0.5, (y - HEIGHT * 0.6) * 1.6) / HEIGHT
    return 1 - 0.75 * math.exp(-((distance - 0.35) ** 2) * 14) * (0.4 + 0.6 * y / HEIGHT)


def ao_error(x, y, rmse, number):
    return rmse * 1.4 * math.sin(x * (0.11 + 0.01 * number)) * math.cos(y * 0.2 + number)


def grey(value):
    return [round(255 * min(1, max(0, value)))] * 3


def signed_colour(value):
    part = min(1, abs(value) / 0.25)
    return [round(255 + (full - 255) * part) for full in ((33, 102, 171) if value < 0 else (179, 23, 43))]


def bench_report():
    """12 candidates on 3 frames; the error falls with the time, and every third candidate is off the front."""
    names = ["draft", "standard", "production", "reference", HOSTILE] + [f"bitmask {n}x8" for n in range(1, 8)]
    candidates, rows, images = [], [], []
    for number, name in enumerate(names):
        ms = 18 * 1.6 ** number
        rmse = 0.055 + 0.09 * 0.72 ** number + (0.02 if number % 3 == 2 else 0)
        candidate = {"name": name, "settings": f"--estimator bitmask --slices {1 + number // 2} --steps {4 + number} --denoise bilateral",
                     "ms": ms, "ms_min": ms * 0.96, "ms_max": ms * 1.3, "rmse": rmse, "mae": rmse * 0.6, "p99": rmse * 3.1, "grain": rmse * 0.1,
                     "bias": 0.02 - 0.004 * number}
        candidates.append(candidate)
        for at, frame in enumerate(FRAMES):
            factor = (0.9, 1.25, 0.85)[at]
            row = {key: value * factor for key, value in candidate.items() if isinstance(value, float)}
            rows.append(row | {"frame": frame, "candidate": name, "estimator_rmse": None if number == 4 else rmse * 0.4,
                               "geometry_rmse": 0.05 * factor, "samples_per_pixel": 2 * (1 + number // 2) * (4 + number)})
            if number < 5:
                images.append({"frame": frame, "candidate": name, "width": WIDTH, "height": HEIGHT,
                               "truth": png(lambda x, y: grey(truth(x, y))) if number == 0 else None,
                               "result": png(lambda x, y: grey(truth(x, y) + ao_error(x, y, rmse, number + at))),
                               "error": png(lambda x, y: signed_colour(ao_error(x, y, rmse, number + at)))})
    return {"title": "Standard suite", "kind": "bench", "device": "llvmpipe (LLVM 15.0.6, 256 bits)",
            "yardstick_ms": YARDSTICK_MS, "frames": [{"name": FRAMES[0], "yardstick_ms": 2 * YARDSTICK_MS}], "candidates": candidates, "rows": rows, "images": images}


def compare_report():
    """One candidate without times, as `alcove compare` has it of a sequence. The last frame is the worst."""
    numbers = {"rmse": 0.0812, "mae": 0.05, "bias": -0.011, "max": 0.61, "p95": 0.14, "p99": 0.26, "psnr": None, "ssim": 0.913, "flip": 0.071, "grain": 0.0042}
    return {"title": f"ao.exr against {HOSTILE}.exr", "kind": "compare", "device": None, "yardstick_ms": None,
            "candidates": [{"name": "ao.exr", "settings": "radius 0.35", "ms": None, "ms_min": None} | numbers],
            "verdict": {"pass": False, "failed": [{"frame": "1003", "error": HOSTILE}],
                        "limits": [{"option": "--max-rmse", "limit": 0.05, "value": 0.0812, "frame": "1002", "holds": False},
                                   {"option": "--max-bias", "limit": 0.02, "value": 0.0110004, "frame": "1001", "holds": True}]},
            "rows": [{"frame": "1001", "candidate": "ao.exr"} | numbers | {"rmse": 0.00004}, {"frame": "1002", "candidate": "ao.exr", "fails": True} | numbers],
            "sequence": {"worst_frame": "1002", "worst_rmse": 0.0812, "mean_rmse": 0.0812, "flicker": 0.0345},
            "images": [{"frame": frame, "candidate": "ao.exr", "width": WIDTH, "height": HEIGHT, "truth": png(lambda x, y: grey(truth(x, y))),
                        "result": png(lambda x, y: grey(truth(x, y) + ao_error(x, y, 0.08, 1))), "full": full,
                        "error": png(lambda x, y: signed_colour(ao_error(x, y, 0.08, 1)))} for frame, full in (("1001", 0.0001), ("1002", 0.1))]}


# The browser.

class Browser:
    """A headless Chromium behind chromedriver, which speaks JSON over HTTP on this machine."""

    def __init__(self, folder):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.driver = subprocess.Popen([os.environ.get("CHROMEDRIVER", "chromedriver"), f"--port={port}", f"--log-path={folder}/driver.log"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.base = f"http://127.0.0.1:{port}"
        self.open = urllib.request.build_opener(urllib.request.ProxyHandler({})).open
        self.wait(self.ready, "chromedriver did not start")
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars", f"--user-data-dir={folder}/profile", "--window-size=1280,1000"]
        session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
            "browserName": "chrome", "unhandledPromptBehavior": "ignore", "goog:chromeOptions": {"args": flags},
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}}})
        self.base += f"/session/{session['sessionId']}"
        # Chromium's own first page loads much; what it logged is read and forgotten.
        self.call("POST", "/url", {"url": "about:blank"})
        self.logged("browser"), self.logged("performance")

    def ready(self):
        try:
            return self.call("GET", "/status")["ready"]
        except urllib.error.URLError:
            return False

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait(10)

    @staticmethod
    def wait(condition, complaint, seconds=30):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, complaint
            time.sleep(0.05)

    def call(self, method, path, body=None):
        data = None if method != "POST" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with self.open(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            value = json.load(error)["value"]
            raise AssertionError(f"{path}: {value['error']}: {value['message']}") from None

    def chromium(self, command, **parameters):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def load(self, path):
        self.call("POST", "/url", {"url": pathlib.Path(path).resolve().as_uri()})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def find(self, selector):
        return next(iter(self.call("POST", "/element", {"using": "css selector", "value": selector}).values()))

    def click(self, selector):
        self.call("POST", f"/element/{self.find(selector)}/click")

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0]).innerText", selector)

    def choose(self, selector, value):
        """Picks from a <select> as a person does: by the option's text."""
        option = self.run("return [...document.querySelector(arguments[0]).options].findIndex((option) => option.text === arguments[1])", selector, value)
        assert option >= 0, f"{selector} does not offer {value}"
        self.click(f"{selector} option:nth-child({option + 1})")

    def box(self, selector):
        self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", selector)
        return self.run("const box = document.querySelector(arguments[0]).getBoundingClientRect(); return {x: box.x, y: box.y, width: box.width, height: box.height}", selector)

    def pointer(self, *steps):
        """Each step: ("move", x, y) in the window, ("down",) or ("up",)."""
        kinds = {"move": lambda x, y: {"type": "pointerMove", "duration": 20, "x": round(x), "y": round(y)},
                 "down": lambda: {"type": "pointerDown", "button": 0}, "up": lambda: {"type": "pointerUp", "button": 0}}
        actions = [kinds[kind](*place) for kind, *place in steps]
        self.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}]})

    def wheel(self, x, y, delta):
        self.call("POST", "/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
            {"type": "scroll", "x": round(x), "y": round(y), "deltaX": 0, "deltaY": delta}]}]})

    def keys(self, *names):
        actions = [{"type": kind, "value": name} for name in names for kind in ("keyDown", "keyUp")]
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})

    def logged(self, kind):
        return self.call("POST", "/se/log", {"type": kind})

    def has_alert(self):
        try:
            self.call("GET", "/alert/text")
            return True
        except AssertionError:
            return False

    def emulate(self, width):
        self.chromium("Emulation.setDeviceMetricsOverride", width=width, height=1000, deviceScaleFactor=1, mobile=False)


# What a person does, and what must then be true.

def check_quiet(browser, page):
    """Nothing but the file itself was asked for, nothing was written to the console, nothing popped up."""
    assert not browser.has_alert(), "an alert is open"
    messages = [entry["message"] for entry in browser.logged("browser")]
    assert not messages, f"console: {messages}"
    events = [json.loads(entry["message"])["message"] for entry in browser.logged("performance")]
    requests = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
    fetched = [url for url in requests if not url.startswith("data:") and url != pathlib.Path(page).resolve().as_uri()]
    assert requests and not fetched, f"requests: {fetched}"
    assert not [event for event in events if event["method"] == "Page.javascriptDialogOpening"], "an alert was open"


def column(browser, key):
    """The texts of one of the table's columns."""
    return browser.run("""
        const at = document.querySelector(`#table th[data-key=${arguments[0]}]`).cellIndex;
        return [...document.querySelectorAll('#table tbody tr')].map((row) => row.cells[at].innerText);""", key)


def numbers(texts):
    return [float(text.replace("−", "-").replace("–", "nan")) for text in texts]


def check_table(browser):
    assert len(column(browser, "candidate")) == 36
    assert HOSTILE in column(browser, "candidate")
    for key in ("rmse", "bias"):
        for direction in ("ascending", "descending"):
            browser.click(f"#table th[data-key={key}] button")
            values = numbers(column(browser, key))
            assert values == sorted(values, reverse=direction == "descending"), f"{key} {direction}: {values}"
            assert browser.run("return document.querySelector(arguments[0]).getAttribute('aria-sort')", f"#table th[data-key={key}]") == direction
    # What is missing stays last in both directions.
    for _ in range(2):
        browser.click("#table th[data-key=estimator_rmse] button")
        assert column(browser, "estimator_rmse")[-3:] == ["–"] * 3
    browser.choose("#table-frame", FRAMES[1])
    assert column(browser, "frame") == [FRAMES[1]] * 12
    browser.choose("#table-frame", "mean over frames")
    assert column(browser, "frame") == ["mean"] * 12


def check_chart(browser):
    box = browser.box("#chart")
    points = browser.run("""
        const chart = Chart.getChart('chart');
        return [1, 2].flatMap((set) => chart.getDatasetMeta(set).data.map((point, index) =>
          ({name: chart.data.datasets[set].data[index].row.name, ms: chart.data.datasets[set].data[index].row.ms, x: point.x, y: point.y, front: set === 1})));""")
    assert len(points) == 12
    # Eight of the twelve are better than all that are faster; by construction every third is not.
    assert sum(point["front"] for point in points) == 8
    # All that are faster and better by much stand apart, so most of the names have room; the front's come first.
    named = browser.run("return Chart.getChart('chart').named")
    assert len(named) >= 8 and set(named) <= {point["name"] for point in points}, named
    for point in points:
        browser.pointer(("move", box["x"] + point["x"], box["y"] + point["y"]))
        assert point["name"] in browser.text("#tip"), f"{point} shows {browser.text('#tip')!r}"
    browser.pointer(("move", box["x"] + box["width"] - 2, box["y"] + 2))
    assert browser.run("return document.getElementById('tip').hidden")
    # In yardsticks the points keep their order and the axis its shape.
    browser.click("#chart-unit label:nth-child(2)")
    shown = browser.run("return Chart.getChart('chart').data.datasets[1].data[0].x")
    assert abs(shown - min(point["ms"] for point in points) / YARDSTICK_MS) < 1e-9
    # One frame instead of the means; then the arrow keys, from the fastest on.
    browser.choose("#chart-frame", FRAMES[0])
    shown = browser.run("const point = Chart.getChart('chart').data.datasets[1].data[0]; return point.x / point.row.ms")
    assert abs(shown - 1 / (2 * YARDSTICK_MS)) < 1e-9, "a frame's own yardstick counts"
    browser.run("document.getElementById('chart').focus()")
    browser.keys(RIGHT, RIGHT)
    assert browser.text("#tip").startswith("standard"), browser.text("#tip")


def divider(browser):
    return float(browser.run("return document.querySelector('#stage').style.getPropertyValue('--divider')").rstrip("%"))


def check_divider(browser):
    stage = browser.box("#stage")
    middle = stage["y"] + stage["height"] * 0.4

    def at(part):
        return stage["x"] + stage["width"] * part

    assert divider(browser) == 50
    browser.pointer(("move", at(0.25), middle), ("down",), ("up",))
    assert abs(divider(browser) - 25) < 1, f"clicked at 25 %, the divider is at {divider(browser)}"
    browser.pointer(("move", at(0.25), middle), ("down",), ("move", at(0.5), middle), ("move", at(0.8), middle), ("up",))
    assert abs(divider(browser) - 80) < 1, f"dragged to 80 %, the divider is at {divider(browser)}"
    browser.run("document.querySelector('.noUi-handle').focus()")
    browser.keys(RIGHT)
    assert 81 < divider(browser) < 83
    # What is left of the divider is really the left picture.
    clip = browser.run("return getComputedStyle(document.getElementById('layer-left')).clipPath")
    assert clip.startswith("inset(0"), clip


def zoomed(browser):
    """(scale, x, y, rendering) of the picture."""
    return browser.run("""
        const image = document.querySelector('#layer-left img');
        const matrix = new DOMMatrix(getComputedStyle(image).transform);
        return [matrix.a, matrix.e, matrix.f, image.style.imageRendering];""")


def check_zoom(browser):
    stage = browser.box("#stage")
    fitted = zoomed(browser)[0]
    assert abs(fitted - stage["width"] / WIDTH) < 1e-3
    browser.click("#viewer-zoom [data-zoom='in']")
    scale, x, y, rendering = zoomed(browser)
    assert abs(scale - 2 * fitted) < 1e-3 and rendering == "pixelated" and x < 0 and y < 0
    # Dragging pans, and does not move the divider; the handle still does.
    before = divider(browser)
    middle = (stage["x"] + stage["width"] * 0.3, stage["y"] + stage["height"] * 0.3)
    browser.pointer(("move", *middle), ("down",), ("move", middle[0] - 40, middle[1] - 25), ("up",))
    assert [round(value) for value in zoomed(browser)[1:3]] == [round(x - 40), round(y - 25)]
    assert divider(browser) == before
    handle = browser.box(".noUi-handle")
    grip = (handle["x"] + handle["width"] / 2, handle["y"] + handle["height"] / 2)
    browser.pointer(("move", *grip), ("down",), ("move", stage["x"] + stage["width"] * 0.5, grip[1]), ("up",))
    assert abs(divider(browser) - 50) < 1
    browser.click("#viewer-zoom [data-zoom='4']")
    browser.click("#viewer-zoom [data-zoom='fit']")
    assert zoomed(browser)[0] == fitted
    # The wheel zooms about the pointer: what lies under it stays there.
    stage = browser.box("#stage")
    place = (round(stage["width"] * 0.7), round(stage["height"] * 0.2))
    browser.wheel(stage["x"] + place[0], stage["y"] + place[1], -240)
    scale, x, y, _ = zoomed(browser)
    assert abs(scale - 2 * fitted) < 0.01
    assert abs((place[0] - x) / scale - place[0] / fitted) < 0.2 and abs((place[1] - y) / scale - place[1] / fitted) < 0.2
    browser.run("document.getElementById('stage').focus()")
    browser.keys("0")
    assert zoomed(browser)[0] == fitted


def check_pictures(browser, report):
    def source(side):
        return browser.run("const image = document.querySelector(arguments[0]); return image.checkVisibility() && image.naturalWidth > 0 ? image.src : null", f"#layer-{side} img")

    def stored(frame, candidate):
        return next(image for image in report["images"] if image["frame"] == frame and image["candidate"] == candidate)

    browser.choose("#viewer-frame", FRAMES[2])
    browser.choose("#viewer-left", HOSTILE)
    assert browser.text("#chip-left") == HOSTILE and browser.text("#chip-right") == "truth"
    browser.wait(lambda: source("left") == stored(FRAMES[2], HOSTILE)["result"], "the result is not shown")
    assert source("right") == stored(FRAMES[2], "draft")["truth"]
    browser.choose("#viewer-right", "production")
    browser.wait(lambda: source("right") == stored(FRAMES[2], "production")["result"], "the second candidate is not shown")
    browser.choose("#viewer-right", "truth")
    assert not browser.run("return document.getElementById('legend').checkVisibility()")
    browser.click("#viewer-show label:nth-child(3)")
    browser.wait(lambda: source("left") == stored(FRAMES[2], HOSTILE)["error"], "the signed error is not shown")
    assert source("right") is None and browser.run("return document.getElementById('legend').checkVisibility()")
    assert "RMSE" in browser.text("#viewer-numbers")


def check_no_overflow(browser):
    for width in (1300, 1280, 480, 360):
        browser.emulate(width)
        browser.wait(lambda: browser.run("return document.documentElement.scrollWidth") <= width, f"the page is wider than {width} px", seconds=5)
        hidden = browser.run("const box = document.querySelector('.scroll'); return box.scrollWidth - box.clientWidth")
        assert width < 1300 or hidden <= 0, f"{hidden} px of the table's columns are hidden in a window of {width} px"
    browser.emulate(1280)


def check_verdict(browser):
    """PASS or FAIL with the limits; the worst frame's error is shown first, in a scale of its own."""
    assert browser.text("#verdict") == "FAIL"
    rows = browser.run("return [...document.querySelectorAll('#limits tbody tr')].map((row) => [row.className, ...[...row.cells].map((cell) => cell.innerText)])")
    assert rows == [["fail", "--max-rmse \u2717", "0.05", "0.0812", "1002"], ["pass", "--max-bias", "0.02", "0.0110004", "1001"]], rows
    assert "frame 1003 was not compared: " + HOSTILE in browser.text("#failed")
    marked = browser.run("return [...document.querySelectorAll('#table tbody tr.fail')].map((row) => row.cells[0].innerText)")
    assert marked == ["1002 \u2717"], marked
    value = "return document.getElementById('viewer-frame').value"
    assert browser.run(value) == "1002" and browser.text("#chip-left") == "ao.exr: result − reference"
    assert browser.text("#legend-most") == "+0.1"
    offered = "return [...document.getElementById('viewer-frame').options].map((option) => option.text)"
    assert browser.run(offered) == ["1001", "1002"]
    browser.click("#viewer-sort input")
    assert browser.run(offered) == ["1002", "1001"]
    browser.choose("#viewer-frame", "1001")
    assert browser.text("#legend-most") == "+0.0001"
    browser.click("#viewer-show label:nth-child(1)")
    assert browser.text("#chip-right") == "reference"


def write_page(program, report, path):
    path.write_bytes(subprocess.run([program], input=json.dumps(report).encode(), stdout=subprocess.PIPE, check=True).stdout)
    return path


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        bench = bench_report()
        pages = {"bench": write_page(program, bench, pathlib.Path(folder, "bench.html")),
                 "compare": write_page(program, compare_report(), pathlib.Path(folder, "compare.html"))}
        browser = Browser(folder)
        try:
            browser.load(pages["bench"])
            assert browser.text("h1") == bench["title"]
            check_table(browser)
            check_chart(browser)
            check_divider(browser)
            check_zoom(browser)
            check_pictures(browser, bench)
            check_no_overflow(browser)
            check_quiet(browser, pages["bench"])

            browser.load(pages["compare"])
            assert HOSTILE in browser.text("h1")
            assert not browser.run("return document.getElementById('chart').checkVisibility()"), "a page without times has no chart"
            # The flicker is the sequence's: it stands above, and is no column of the frames.
            assert "Flicker\n0.0345" in browser.text("#facts").replace("Flicker 0.0345", "Flicker\n0.0345"), browser.text("#facts")
            assert not browser.run("return document.querySelector('#table th[data-key=flicker]')")
            assert numbers(column(browser, "ssim")) == [0.913] * 2
            assert numbers(column(browser, "rmse"))[0] == 0.00004, "a small error has digits"
            check_verdict(browser)
            browser.click("#table th[data-key=rmse] button")
            check_no_overflow(browser)
            check_quiet(browser, pages["compare"])
        finally:
            browser.close()
    print("the report page works")


if __name__ == "__main__":
    main(*sys.argv[1:])
