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
