#!/usr/bin/env python3
# Puts a wheel together: the Python package of hosts/python with libalcove and the libraries that it brings.
#   scripts/wheel.py LIBRARY FOLDER     LIBRARY: libalcove.so.0 as it was installed; FOLDER: where the wheel is written
# scripts/package.sh calls it for its word wheel. The tag says which C library the wheel asks for: that of the newest name which any of its
# libraries takes from there (PEP 600).
# SPDX-License-Identifier: BSD-3-Clause
import base64
import hashlib
import pathlib
import platform
import re
import subprocess
import sys
import tomllib
import zipfile

PROJECT = pathlib.Path(__file__).resolve().parent.parent
# What every Linux with such a C library has: the policy of manylinux, as far as libalcove needs it.
SYSTEM = ("linux-vdso.so", "ld-linux", "libc.so", "libm.so", "libdl.so", "libpthread.so", "libgcc_s.so", "libstdc++.so")


def output_of(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def brought_libraries(library):
    """The libraries that the system need not have, by their names."""
    found = re.findall(r"(\S+) => (/\S+)", output_of("ldd", library))
    return {name: pathlib.Path(path) for name, path in found if not name.startswith(SYSTEM)}


def newest(name, libraries):
    """The newest version of names that libraries ask for, such as GLIBC_2.34, as numbers."""
    texts = [output_of("objdump", "-T", str(path)) for path in libraries]
    versions = re.findall(rf"\*UND\*.*\b{name}_([0-9.]+)\b", "\n".join(texts))
    return max(tuple(int(part) for part in version.split(".")) for version in versions)


def licence_of(library):
    """The copyright file of the Debian package that a library comes from."""
    path = library.resolve()
    owner = subprocess.run(["dpkg", "-S", f"*/{path.name}"], check=True, capture_output=True, text=True).stdout.split(":")[0]
    return owner, pathlib.Path(f"/usr/share/doc/{owner}/copyright").read_bytes()


def main():
    library, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    project = tomllib.loads((PROJECT / "hosts/python/pyproject.toml").read_text())["project"]
    brought = brought_libraries(library)
    everything = [library, *brought.values()]
    glibc, libstdcxx = newest("GLIBC", everything), newest("GLIBCXX", everything)
    # GCC 11, which the oldest systems with glibc 2.34 have.
    if libstdcxx > (3, 4, 29):
        sys.exit(f"scripts/wheel.py: a library asks for GLIBCXX_{'.'.join(map(str, libstdcxx))}, which systems of manylinux_2_34 lack")
    tag = f"py3-none-manylinux_{glibc[0]}_{glibc[1]}_{platform.machine()}"
    info = f"{project['name']}-{project['version']}.dist-info"
    files = {f"alcove/{path.name}": path.read_bytes() for path in sorted((PROJECT / "hosts/python/alcove").glob("*.py*"))
             if path.is_file()}
    files[f"alcove/{library.name}"] = library.read_bytes()
    for name, path in sorted(brought.items()):
        files[f"alcove/{name}"] = path.read_bytes()
        owner, text = licence_of(path)
        files[f"{info}/licenses/{owner}"] = text
    files[f"{info}/licenses/alcove"] = (PROJECT / "LICENSE").read_bytes()
    metadata = {"Metadata-Version": "2.1", "Name": project["name"], "Version": project["version"], "Summary": project["description"],
                "License": project["license"]["text"], "Requires-Python": project["requires-python"], "Requires-Dist": "numpy"}
    files[f"{info}/METADATA"] = "".join(f"{key}: {value}\n" for key, value in metadata.items()).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: alcove\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    wheel = folder / f"{project['name']}-{project['version']}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)  # of 1980, so that the same build makes the same wheel
            entry.external_attr, entry.compress_type = 0o644 << 16, zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    print(f"{wheel.stat().st_size} bytes: {wheel.name}")


main()
