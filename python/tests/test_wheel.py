"""Tests of the wheel, installed by pip without any other part of byre."""
import base64
import csv
import email
import hashlib
import os
import pathlib
import subprocess
import sys
import zipfile

import pytest

WHEEL = pathlib.Path(os.environ["BYRE_WHEEL"])
SOURCE = pathlib.Path(__file__).resolve().parents[2]
NAME, VERSION, PYTHON, ABI, PLATFORM = WHEEL.stem.split("-")
INFORMATION = f"{NAME}-{VERSION}.dist-info"

MAPS_A_FEW_FRAMES = """
import sys
folder, room = sys.argv[1:]
sys.path.insert(0, folder)
import byre

assert byre.__file__ == f"{folder}/byre/__init__.py", byre.__file__
recording = byre.Recording(room)
slam = byre.Slam.mapping(recording.calibration, byre.SlamOptions(workers=byre.Workers.repeatable))
for k in range(12):
    slam.process(recording[k])
slam.finish()
error = byre.absolute_trajectory_error(slam.trajectory(), byre.read_trajectory(room))
assert error.errors.shape == (12,) and error.translation.rmse < 0.02, error.translation.rmse
with open("/proc/self/maps", encoding="utf-8") as mapped:
    files = {line.split()[-1] for line in mapped if line.rstrip().endswith(".vocabulary")}
assert files == {f"{folder}/byre/share/byre/default.vocabulary"}, files
print(byre.__version__)
"""


@pytest.fixture(scope="module")
def content():
    with zipfile.ZipFile(WHEEL) as file:
        return {name: file.read(name) for name in file.namelist()}


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed").resolve()
    command = [sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--target", folder, WHEEL]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder


def test_wheel_matches_its_python(content):
    here = f"{sys.version_info.major}{sys.version_info.minor}"
    assert (NAME, PYTHON, ABI) == ("byre", f"cp{here}", f"cp{here}")
    assert f"Tag: {PYTHON}-{ABI}-{PLATFORM}\n" in content[f"{INFORMATION}/WHEEL"].decode()
    metadata = email.message_from_bytes(content[f"{INFORMATION}/METADATA"])
    assert (metadata["Name"], metadata["Version"]) == (NAME, VERSION)
    assert metadata["Requires-Python"] == f"=={sys.version_info.major}.{sys.version_info.minor}.*"
    assert metadata["Requires-Dist"] == "numpy"


def test_wheel_records_file_hashes(content):
    record = f"{INFORMATION}/RECORD"
    rows = {row[0]: row[1] for row in csv.reader(content[record].decode().splitlines())}
    assert set(rows) == set(content) and rows.pop(record) == ""
    for name, written in rows.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content[name]).digest()).rstrip(b"=").decode()
        assert written == f"sha256={digest}", name


def test_wheel_contains_signatures_licence_and_vocabulary(content):
    package = SOURCE / "python" / "byre"
    for name in ("__init__.py", "__init__.pyi", "py.typed"):
        assert content[f"byre/{name}"] == (package / name).read_bytes()
    vocabulary = SOURCE / "share" / "byre" / "default.vocabulary"
    assert content["byre/share/byre/default.vocabulary"] == vocabulary.read_bytes()
    assert content[f"{INFORMATION}/LICENSE"] == (SOURCE / "LICENSE").read_bytes()


def test_installed_wheel_maps(installed, room):
    surroundings = {name: value for name, value in os.environ.items() if not name.startswith("BYRE_")}
    command = [sys.executable, "-I", "-c", MAPS_A_FEW_FRAMES, installed, room]
    done = subprocess.run(command, env=surroundings, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{VERSION}\n"
