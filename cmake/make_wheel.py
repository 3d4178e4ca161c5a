#!/usr/bin/env python3
"""Builds a wheel of the Python package for pip, including the vocabulary.

Usage: make_wheel.py PACKAGE DATA LICENSE WHEEL
PACKAGE is the built folder byre, DATA the folder of default.vocabulary. The name of WHEEL contains version, Python and
platform of the module, as in byre-0.1.0-cp311-cp311-linux_x86_64.whl.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

PACKAGE_FILES = ("__init__.py", "__init__.pyi", "py.typed", "_byre.*.so")
VOCABULARY = "default.vocabulary"
DATA_FOLDER = pathlib.Path("share") / "byre"  # next to the module, where base/data_file.cc searches for it

METADATA = """\
Metadata-Version: 2.1
Name: {name}
Version: {version}
Summary: Visual SLAM for robots that work in the same building every day
License: BSD-3-Clause
Classifier: License :: OSI Approved :: BSD License
Classifier: Programming Language :: C++
Requires-Python: =={python}.*
Requires-Dist: numpy
"""
WHEEL = """\
Wheel-Version: 1.0
Generator: byre {version}
Root-Is-Purelib: false
Tag: {tag}
"""


def lay_out(package: pathlib.Path, data: pathlib.Path, folder: pathlib.Path) -> None:
    for pattern in PACKAGE_FILES:
        found = list(package.glob(pattern))
        if len(found) != 1:
            sys.exit(f"make_wheel: {package} contains {len(found)} files {pattern} instead of one: rebuild byre_python")
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copy2(found[0], folder)
    (folder / DATA_FOLDER).mkdir(parents=True)
    shutil.copy2(data / VOCABULARY, folder / DATA_FOLDER)


def describe(wheel: pathlib.Path, license_file: pathlib.Path, folder: pathlib.Path) -> None:
    name, version, tag = wheel.stem.split("-", 2)
    python_tag = tag.split("-")[0]  # cp311
    python = f"{python_tag[2]}.{python_tag[3:]}"
    information = folder / f"{name}-{version}.dist-info"
    information.mkdir()
    metadata = METADATA.format(name=name, version=version, python=python)
    (information / "METADATA").write_text(metadata, encoding="utf-8")
    (information / "WHEEL").write_text(WHEEL.format(version=version, tag=tag), encoding="utf-8")
    shutil.copy2(license_file, information / "LICENSE")


def main(arguments: list[str]) -> int:
    if len(arguments) != 5:
        print(__doc__, file=sys.stderr)
        return 2
    package, data, license_file, wheel = map(pathlib.Path, arguments[1:])
    with tempfile.TemporaryDirectory() as stage:
        lay_out(package, data, pathlib.Path(stage) / "byre")
        describe(wheel, license_file, pathlib.Path(stage))
        wheel.parent.mkdir(parents=True, exist_ok=True)
        subprocess.run([sys.executable, "-m", "wheel", "pack", "--dest-dir", wheel.parent, stage], check=True,
                       stdout=subprocess.DEVNULL)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
