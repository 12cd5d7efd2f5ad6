#!/usr/bin/env python3
"""Opens the page of a wedge in headless Chromium, wipes, flips, reads values, copies a command, runs it, and compares the bits.

    wedge_page_test.py PROGRAM PROJECT
"""
# SPDX-License-Identifier: BSD-3-Clause
import base64
import json
import pathlib
import re
import shlex
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "measure"))
from report_page_test import Browser, check_no_overflow, check_quiet, divider, zoomed  # noqa: E402

CONTROL = "\ue009"  # WebDriver's name for the key


def decoded(png):
    """(width, height, channels, rows of bytes) of an 8-bit PNG."""
    at, data, size = 8, b"", None
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + length]
        size = struct.unpack(">IIBB", body[:10]) if kind == b"IHDR" else size
        data += body if kind == b"IDAT" else b""
        at += 12 + length
    width, height, channels = size[0], size[1], 3 if size[3] == 2 else 1
    raw, stride, rows = zlib.decompress(data), size[0] * channels + 1, [bytes(size[0] * channels)]
    for y in range(height):
        kind, row, above = raw[y * stride], bytearray(raw[y * stride + 1:(y + 1) * stride]), rows[-1]
        for x in range(len(row)):
            left, up, corner = row[x - channels] if x >= channels else 0, above[x], above[x - channels] if x >= channels else 0
            nearest = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            row[x] = (row[x] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        rows.append(bytes(row))
    return width, height, channels, rows[1:]


def in_page(url):
    return decoded(base64.b64decode(url.split(",")[1]))


def check_wipe_and_flip(browser):
    stage = browser.box("#stage")
    browser.pointer(("move", stage["x"] + stage["width"] * 0.25, stage["y"] + 60), ("down",), ("up",))
    assert abs(divider(browser) - 25) < 1, f"wiped to 25 %, the divider is at {divider(browser)}"
    browser.click("#flip")
    assert divider(browser) == 100
    browser.run("document.getElementById('stage').focus()")
    browser.keys("f")
    assert divider(browser) == 0, "F flips"
    for zoom in ("1", "8"):
        browser.click(f"#viewer-zoom [data-zoom='{zoom}']")
        assert zoomed(browser)[0] == int(zoom)
    browser.click("#viewer-zoom [data-zoom='fit']")


def check_pointer(browser, report, camera):
    """The value of the AO, and the circle of the radius, which a pinhole camera sees as radius * focal length / depth."""
    stage = browser.box("#stage")
    scale = zoomed(browser)[0]
    x, y = int(stage["width"] / scale * 0.3), int(stage["height"] / scale * 0.7)
    browser.pointer(("move", stage["x"] + (x + 0.5) * scale, stage["y"] + (y + 0.5) * scale))
    text = browser.text("#pixel")
    left, right = (next(image for image in report["images"] if image["candidate"] == report["candidates"][i]["name"]) for i in (0, 1))
    for image in (left, right):
        value = in_page(image["result"])[3][y][x] / 255
        assert f"{image['candidate']}: {value:.2f}" in text, f"{text!r} lacks {value:.2f} of {image['candidate']}"
    depth = float(re.search(r"depth ([0-9.]+)", text)[1])
    width = browser.run("return document.getElementById('ring').getBoundingClientRect().width")
    expected = 2 * report["candidates"][1]["radius"] * camera["fx"] / depth * scale  # the divider lies at the left: this is the right look
    assert abs(width - expected) < 0.02 * expected + 1, f"the circle is {width} px wide instead of {expected}"


def check_focus(browser, name):
    """Who chooses by keys stays at the button that was pressed."""
    browser.run("document.querySelector('#looks figure:nth-child(3) button').focus()")
    browser.keys(" ")
    assert browser.text("#chip-left") == name
    assert browser.run("const now = document.activeElement; return now === document.querySelector('#looks figure:nth-child(3) button')"), "lost"


def check_beauty(browser, report):
    browser.choose("#viewer-right", "beauty")
    shown = browser.run("return document.querySelector('#layer-right img').src")
    assert shown == report["images"][-1]["beauty"], "the plain beauty is not shown"


def check_command(browser, program, report, folder):
    """What is copied makes the bits that the page shows."""
    browser.choose("#viewer-left", report["candidates"][2]["name"])
    browser.click("#looks figure:nth-child(2) .actions > :last-child button")
    assert browser.text("#looks figure:nth-child(2) .actions > :last-child") == "copied"
    browser.run("document.body.append(Object.assign(document.createElement('textarea'), {id: 'paste'})); document.getElementById('paste').focus()")
    browser.call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": [
        {"type": "keyDown", "value": CONTROL}, {"type": "keyDown", "value": "v"}, {"type": "keyUp", "value": "v"}, {"type": "keyUp", "value": CONTROL}]}]})
    command = browser.run("const paste = document.getElementById('paste'); paste.remove(); return paste.value").strip()
    look = report["candidates"][1]
    assert command == look["settings"], command
    image = next(image for image in report["images"] if image["candidate"] == look["name"])
    for picture, more in (("composite", []), ("result", ["--set", "preview-style=ao"])):
        subprocess.run([program, *shlex.split(command)[1:], *more], cwd=folder, check=True, stderr=subprocess.DEVNULL)
        assert decoded(pathlib.Path(folder, "preview.png").read_bytes()) == in_page(image[picture]), f"the {picture} has other bits"


def main(program, project):
    program = pathlib.Path(program).resolve()
    with tempfile.TemporaryDirectory() as folder:
        page, examples = pathlib.Path(folder, "looks.html"), pathlib.Path(project, "examples")
        subprocess.run([program, "wedge", examples / "interior.gbuffer.exr", "--camera", examples / "interior.camera.json", "--beauty",
                        examples / "interior.beauty.exr", "--radius", ".1,.35", "--preset", "draft", "-o", page], check=True, stdout=subprocess.DEVNULL)
        report = json.loads(re.search(r'<script id="report" type="application/json">(.*?)</script>', page.read_text(), re.S)[1])
        browser = Browser(folder)
        try:
            browser.load(page)
            assert len(report["candidates"]) == 3 and "(proposed)" in str([look["name"] for look in report["candidates"]])
            assert browser.run("return document.querySelectorAll('#looks figure').length") == 3
            assert not browser.run("return document.getElementById('table-section').checkVisibility()")
            for look in report["candidates"]:
                assert look["settings"] in browser.run("return document.getElementById('looks').textContent")
            check_wipe_and_flip(browser)
            check_pointer(browser, report, json.loads((examples / "interior.camera.json").read_text()))
            browser.click("#viewer-show label:nth-child(2)")
            shown = browser.run("return document.querySelector('#layer-left img').src")
            assert shown == report["images"][0]["composite"], "the composite is not shown"
            check_beauty(browser, report)
            check_focus(browser, report["candidates"][2]["name"])
            check_command(browser, program, report, folder)
            check_no_overflow(browser)
            check_quiet(browser, page)
        finally:
            browser.close()
    print("the page of a wedge works")


if __name__ == "__main__":
    main(*sys.argv[1:])
