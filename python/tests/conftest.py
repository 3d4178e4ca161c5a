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


@pytest.fixture(scope="session")
def m(room_map):
    import byre

    return byre.Map.load(room_map)


@pytest.fixture(scope="session")
def truth(room):
    import byre

    return byre.read_trajectory(byre.find_ground_truth(room))


@pytest.fixture(scope="session")
def picks(m, truth):
    """Points of the map, and the same on a plan along the plane of its path, which is not level in this room."""
    in_map = m.positions[:: len(m.positions) // 9]
    world_from_map = truth.poses[0]
    in_world = in_map @ world_from_map[:3, :3].T + world_from_map[:3, 3]
    plan_from_map = m.register_on_plan("world", in_map, in_world[:, :2]).registration.plan_from_map
    return in_map, (in_map @ plan_from_map[:3, :3].T + plan_from_map[:3, 3])[:, :2]
