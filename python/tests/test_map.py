"""Tests of byre.Map on a map of a small rendered recording of a room."""
import gc
import os
import pathlib
import pickle
import re
import subprocess
import sys
import threading

import numpy as np
import pytest

import byre

HERE = pathlib.Path(__file__).resolve().parent


def test_a_loaded_map_has_what_was_mapped(m, room):
    assert re.fullmatch(r"<Map \d+ keyframes, \d+ points, 1 recording, metric>", repr(m))
    recording = byre.Recording(room)
    assert m.recordings[0].calibration.left.fx == pytest.approx(recording.calibration.left.fx, rel=0.01)
    assert m.recordings[0].first_time_ns == recording.times_ns[0]
    assert all(keyframe.time_ns in recording.times_ns for keyframe in m.keyframes)
    assert [keyframe.id for keyframe in m.keyframes] == list(range(len(m.keyframes)))
    counted = sum((keyframe.points >= 0).sum() for keyframe in m.keyframes)
    assert m.observation_counts.sum() == counted
    with pytest.raises(byre.InputError, match="missing.byre"):
        byre.Map.load("missing.byre")


def test_the_trajectory_of_a_map_is_that_of_the_robot(m, truth):
    error = byre.absolute_trajectory_error(m.trajectory(), truth)
    assert error.translation.count == len(m.keyframes) and error.translation.rmse < 0.02


def test_arrays_are_views_that_outlive_the_map(room_map):
    loaded = byre.Map.load(room_map)
    keyframe = loaded.keyframes[0]
    assert loaded.positions is loaded.positions
    for array in (keyframe.pixels, keyframe.points, keyframe.keypoints, keyframe.descriptors, keyframe.disparities):
        assert array.base is not None and len(array) == len(keyframe.points)
        assert not array.flags.writeable
    for array in (loaded.positions, loaded.covariances, loaded.grey_values, loaded.observation_counts):
        assert len(array) == len(loaded.positions) and not array.flags.writeable
    before = [loaded.positions.copy(), keyframe.descriptors.copy(), keyframe.keypoints.copy()]
    views = [loaded.positions, keyframe.descriptors, keyframe.keypoints]
    del loaded, keyframe
    gc.collect()
    others = [byre.Map.load(room_map).keyframes for _ in range(3)]
    assert all((view == copy).all() for view, copy in zip(views, before)) and len(others) == 3


def test_keypoints_are_near_their_measurements(m):
    for keyframe in m.keyframes:
        distances = np.linalg.norm(keyframe.pixels - keyframe.keypoints, axis=1)
        assert np.median(distances) < 1.0 and np.quantile(distances, 0.95) < 4.0
        assert keyframe.keypoints[:, 0].max() < keyframe.camera.width
        assert (keyframe.disparities > 0).any()


def test_points_project_to_their_pixels(m):
    errors = []
    for keyframe in m.keyframes:
        camera_from_map = np.linalg.inv(keyframe.map_from_camera)
        in_camera = m.positions[keyframe.points] @ camera_from_map[:3, :3].T + camera_from_map[:3, 3]
        camera = keyframe.camera
        pixels = camera.fx * in_camera[:, :2] / in_camera[:, 2:] + [camera.cx, camera.cy]
        errors += list(np.linalg.norm(pixels - keyframe.pixels, axis=1))
    assert np.median(errors) < 0.5


def test_maps_can_be_pickled(m):
    again = pickle.loads(pickle.dumps(m))
    assert (again.positions == m.positions).all()
    assert all((a.map_from_body == b.map_from_body).all() for a, b in zip(again.keyframes, m.keyframes))
    with pytest.raises(byre.InputError, match="pickled map"):
        byre.Map.__new__(byre.Map).__setstate__(b"no map")


def test_points_are_removed_by_ids_or_by_a_mask(m):
    mask = m.positions[:, 0] > np.median(m.positions[:, 0])
    edited = m.without_points(mask)
    assert (edited.positions == m.positions[~mask]).all()
    assert (m.without_points(np.flatnonzero(mask)).positions == edited.positions).all()
    assert len(m.without_points([]).positions) == len(m.positions)
    assert (m.without_points([0]).positions == m.positions[1:]).all()
    for bad in ([-1], [len(m.positions)], [2**40]):
        with pytest.raises(IndexError):
            m.without_points(bad)
    for bad in ([0.5], mask[:-1], [[1, 2]]):
        with pytest.raises(TypeError):
            m.without_points(bad)


def test_an_edited_map_can_be_saved_and_continued(m, room, frames, tmp_path):
    often_seen = m.without_points(m.observation_counts < 2)
    turn = np.array([[0, -1, 0, 2], [1, 0, 0, 0], [0, 0, 1, 1], [0, 0, 0, 1]], float)
    often_seen.transformed(turn).save(tmp_path / "edited.byre")
    slam = byre.Slam.on_map(byre.Recording(room).calibration, tmp_path / "edited.byre")
    reports = [slam.process(images) for images in frames]
    assert reports[-1].verdict == byre.Verdict.trusted
    original = m.localise(frames[-1]).map_from_body
    assert np.abs(reports[-1].map_from_body - turn @ original)[:3, 3].max() < 0.03


def test_a_map_file_is_updated_by_the_session_of_a_mission(room, frames, tmp_path):
    calibration = byre.Recording(room).calibration
    options = byre.SlamOptions(workers=byre.Workers.repeatable)
    part, session, child = (tmp_path / name for name in ("part.byre", "evening.session", "child.byre"))
    mapping = byre.Slam.mapping(calibration, options)
    for images in frames[: len(frames) // 2]:
        mapping.process(images)
    mapping.finish()
    mapping.save(part)
    mission = byre.Slam.on_map(calibration, part, options)
    for images in frames:
        mission.process(images)
    mission.save_session(session)
    result = byre.update_map_file(part, [session], child)
    assert result.refusal is None, result
    assert len(byre.Map.load(child).keyframes) == len(byre.Map.load(part).keyframes) + result.keyframes_added
    child.unlink()
    assert "no session" in byre.update_map_file(part, [], child).refusal
    assert not child.exists()
    with pytest.raises(byre.InputError, match="stays as it is"):
        byre.update_map_file(part, [session], part)


def test_images_are_localised_by_any_thread(m, room, truth, frames):
    found = [None] * 4
    calibration = byre.Recording(room).calibration

    def find(k):
        found[k] = m.localise(frames[5 * k + 5], calibration=calibration if k % 2 else None)

    threads = [threading.Thread(target=find, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    map_from_world = np.linalg.inv(truth.poses[0])
    for k, report in enumerate(found):
        assert report.failure == byre.LocalisationFailure.none, repr(report)
        assert np.abs(report.map_from_body - map_from_world @ truth.poses[5 * k + 5]).max() < 0.05


def test_an_image_that_is_not_found_has_a_reason(m, frames):
    report = m.localise(np.full_like(frames[0].left, 90))
    assert report.map_from_body is None and report.covariance is None
    assert report.failure == byre.LocalisationFailure.too_few_features
    with pytest.raises(byre.InputError, match="cannot be localised"):
        m.localise(frames[0].left[:100])
    with pytest.raises(TypeError):
        m.localise(frames[0].left.astype(float))


def test_a_map_is_registered_on_a_plan(m, truth, picks):
    in_map, in_plan = picks
    fit = m.register_on_plan("room.png", in_map, in_plan)
    assert fit.rms < 0.15 and len(fit.errors) == len(in_plan)
    on_plan = m.with_plan(fit)
    assert "registered on room.png" in repr(on_plan) and m.plan is None
    plan_from_body = on_plan.plan.plan_from_body(m.keyframes[-1].map_from_body)
    nearest = np.abs(truth.times_ns - m.keyframes[-1].time_ns).argmin()
    assert np.linalg.norm(plan_from_body[:2, 3] - truth.poses[nearest][:2, 3]) < 0.3
    wrong = in_plan.copy()
    wrong[3] += 5.0
    assert list(m.register_on_plan("room.png", in_map, wrong).outliers) == [3]
    rng = np.random.default_rng(1)
    with pytest.raises(byre.InputError, match="residuals"):
        m.with_plan(m.register_on_plan("room.png", in_map, rng.uniform(-20, 20, in_plan.shape)))
    with pytest.raises(byre.InputError, match="two distant points"):
        m.register_on_plan("room.png", in_map[:1], in_plan[:1])
    with pytest.raises(ValueError):
        m.register_on_plan("room.png", in_map, in_plan[:2])
    with pytest.raises(byre.InputError, match="not registered"):
        m.points_in_polygon([[0, 0], [1, 0], [1, 1]])


def test_a_colmap_round_trip_keeps_poses_and_points(m, room, tmp_path):
    m.export_colmap(tmp_path / "model", images_of=room)
    again = byre.Map.import_colmap(tmp_path / "model", room / "mav0/cam0/data", metres_per_unit=1.0, adds_points=False)
    assert again.is_metric and len(again.keyframes) == len(m.keyframes)
    body_from_left = m.recordings[0].calibration.body_from_left
    for before, after in zip(m.keyframes, again.keyframes):
        assert np.abs(after.map_from_body - before.map_from_body @ body_from_left).max() < 1e-9
    assert len(again.positions) > 0.3 * (m.observation_counts >= 2).sum()
    for position in again.positions:
        assert np.linalg.norm(m.positions[m.nearest_points(position, 1)] - position) < 1e-9


def test_the_map_is_drawn_in_ten_lines(room_map, tmp_path):
    pytest.importorskip("matplotlib")
    script = HERE.parent / "examples" / "draw_map.py"
    assert len([line for line in script.read_text().splitlines() if line]) <= 10
    picture = tmp_path / "map.png"
    subprocess.run([sys.executable, script, room_map, picture], check=True, env={**os.environ, "MPLBACKEND": "agg"})
    assert picture.stat().st_size > 10_000
