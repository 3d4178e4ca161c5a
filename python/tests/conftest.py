"""Shared fixtures for tests of the package byre."""
import os
import subprocess

import pytest


@pytest.fixture(scope="session")
def room(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings") / "room"
    command = [os.environ["BYRE_RENDER_ROOM"], folder, "--frames", "30", "--rate", "10", "--laps", "0.2"]
    subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
    return folder


@pytest.fixture(scope="session")
def frames(room):
    import byre

    return list(byre.Recording(room))


@pytest.fixture(scope="session")
def room_map(room, frames, tmp_path_factory):
    import byre

    path = tmp_path_factory.mktemp("maps") / "room.byre"
    options = byre.SlamOptions(workers=byre.Workers.repeatable)
    slam = byre.Slam.mapping(byre.Recording(room).calibration, options)
    for images in frames:
        slam.process(images)
    slam.finish()
    slam.save(path)
    return path
