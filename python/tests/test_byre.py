"""Tests of the package byre on a small rendered recording of a room."""
import enum
import gc
import os
import pathlib
import pickle
import re
import shutil
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import byre

HERE = pathlib.Path(__file__).resolve().parent
REPEATABLE = byre.SlamOptions(workers=byre.Workers.repeatable)


def test_recordings_are_sequences_of_frames(room):
    recording = byre.Recording(room)
    assert len(recording) == 30
    assert recording.times_ns.shape == (30,)
    first, last = recording[0], recording[-1]
    assert first.time_ns == recording.times_ns[0] and last.time_ns == recording.times_ns[-1]
    assert first.left.shape == (240, 376) and first.left.dtype == np.uint8
    assert first.right.shape == first.left.shape and first.depth is None
    with pytest.raises(IndexError):
        recording[30]
    assert byre.Recording(room, camera=byre.CameraChoice.left)[0].right is None
    assert len(byre.Recording(room, start_s=1.0, end_s=2.0)) == 10
    with pytest.raises(byre.InputError, match="is not a bag"):
        byre.Recording(room, left_topic="/left", right_topic="/right")


def test_pixels_outlive_their_frame(room, frames):
    left = byre.Recording(room)[0].left
    gc.collect()
    others = [byre.Recording(room)[i].left for i in range(1, 5)]
    assert (left == frames[0].left).all() and len(others) == 4


def test_recordings_are_read_by_several_threads(room):
    recording = byre.Recording(room)
    expected = [images.left.sum() for images in recording]
    sums = [None] * 4

    def read(k):
        sums[k] = [recording[i].left.sum() for i in range(len(recording)) if recording.warnings == []]

    threads = [threading.Thread(target=read, args=(k,), daemon=True) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sums == [expected] * 4


def test_unreadable_frames_are_skipped(room, tmp_path):
    damaged = tmp_path / "damaged"
    shutil.copytree(room, damaged)
    recording = byre.Recording(damaged)
    image = damaged / "mav0" / "cam0" / "data" / f"{recording.times_ns[3]}.png"
    image.write_bytes(image.read_bytes()[:100])
    assert recording[3] is None
    assert len(list(recording)) == len(recording) - 1
    assert image.name in recording.warnings[-1]


def test_mapping_equals_the_program(room, frames, tmp_path):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    reports = [slam.process(images) for images in frames]
    assert reports[-1].state == byre.State.tracking
    assert reports[-1].input == byre.InputFault.none
    assert byre.Event.initialised in reports[0].events
    assert reports[-1].map_from_body.shape == (4, 4)
    assert reports[-1].covariance.shape == (6, 6)
    slam.finish()
    slam.trajectory().write(tmp_path / "here.txt")
    subprocess.run(
        [os.environ["BYRE_PROGRAM"], "map", room, "--trajectory", tmp_path / "program.txt", "--quiet"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    assert (tmp_path / "here.txt").read_bytes() == (tmp_path / "program.txt").read_bytes()


def test_numpy_arrays_give_the_same_poses(room, frames):
    calibration = byre.Recording(room).calibration
    by_images, by_arrays = (byre.Slam.mapping(calibration, REPEATABLE) for _ in range(2))
    for images in frames[:6]:
        expected = by_images.process(images).map_from_body
        colour = np.repeat(images.left[:, :, None], 3, axis=2)
        padded = np.zeros((240, 400), np.uint8)[:, :376]
        padded[:] = images.right
        found = by_arrays.process(images.time_ns, colour, padded).map_from_body
        assert (found == expected).all()


def test_foreign_arrays_are_accepted(room, frames):
    calibration = byre.Recording(room).calibration
    plain, other = (byre.Slam.mapping(calibration, REPEATABLE) for _ in range(2))
    for images in frames[:6]:
        expected = plain.process(images).map_from_body
        left = pickle.loads(pickle.dumps(images.left))[:, :, None]
        right = images.right.astype(np.uint16) * 257
        right.flags.writeable = False
        found = other.process(images.time_ns, left, right).map_from_body
        assert (found == expected).all()


def test_colour_order_sets_luminance_weights(room, frames):
    calibration = byre.Recording(room).calibration
    reports = {}
    for order in (byre.PixelFormat.bgr8, byre.PixelFormat.rgb8):
        slam = byre.Slam.mapping(calibration, REPEATABLE)
        for images in frames[:3]:
            colour = np.zeros((240, 376, 3), np.uint8)
            colour[:, :, 2] = images.left  # red or blue, which differ by a factor of three in brightness
            reports[order] = slam.process(images.time_ns, colour, images.right, format=order)
    assert (reports[byre.PixelFormat.bgr8].map_from_body != reports[byre.PixelFormat.rgb8].map_from_body).any()


def test_depths_are_in_units_or_metres(room, frames):
    left = byre.Recording(room).calibration.left
    calibration = byre.Calibration(left, depth=byre.DepthCamera(units_per_metre=1000.0))
    found = []
    for depth in (np.full((240, 376), 2000, np.uint16), np.full((240, 376), 2.0, np.float32)):
        slam = byre.Slam.mapping(calibration, REPEATABLE)
        assert slam.is_metric
        for images in frames[:3]:
            report = slam.process(images.time_ns, images.left, depth=depth)
        found.append(report.map_from_body)
    assert (found[0] == found[1]).all()
    late = slam.process(frames[3].time_ns, frames[3].left, depth=depth, depth_time_ns=frames[1].time_ns)
    assert late.input is byre.InputFault.late_depth


def test_unusable_frames_are_reported(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    slam.process(frames[1])
    assert slam.process(frames[1]).input == byre.InputFault.repeated_time
    assert slam.process(frames[0]).input == byre.InputFault.out_of_order
    small = np.zeros((10, 10), np.uint8)
    assert slam.process(frames[2].time_ns, small, small).input == byre.InputFault.wrong_size
    assert slam.process(frames[2].time_ns, frames[2].left).input == byre.InputFault.missing_right
    late = slam.process(frames[3].time_ns, frames[3].left, frames[3].right, right_time_ns=frames[4].time_ns)
    assert late.input == byre.InputFault.late_right
    dropped = slam.process(frames[0])
    assert dropped.map_from_body is None and dropped.covariance is None
    assert slam.frames == 7 and slam.frames_with(byre.InputFault.wrong_size) == 1
    with pytest.raises(TypeError):
        slam.frames_with(20)


def test_enumerations_are_python_enums():
    assert issubclass(byre.Verdict, enum.Enum) and len(byre.Verdict) == 3
    assert byre.Verdict["trusted"] is byre.Verdict.trusted
    options = byre.SlamOptions(workers=byre.Workers.none, max_gap=2.0)
    assert options.workers is byre.Workers.none and options.max_gap == 2.0
    options.workers = byre.Workers.live
    assert options.workers is byre.Workers.live
    with pytest.raises(TypeError, match="no field worker"):
        byre.SlamOptions(worker=byre.Workers.none)


def test_settings_match_the_options_page(room):
    calibration = byre.Recording(room).calibration
    options = byre.SlamOptions(settings={"tracking.search_radius_px": 20.5, "calibration.refine": False})
    assert options.settings == {"tracking.search_radius_px": "20.5", "calibration.refine": "false"}
    byre.Slam.mapping(calibration, options)
    with pytest.raises(byre.InputError, match="did you mean 'features.max_count'"):
        byre.Slam.mapping(calibration, byre.SlamOptions(settings={"features.max_counts": 500}))


def test_invalid_arrays_are_rejected(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    for image in (frames[0].left.astype(np.float64), frames[0].left.astype(">u2"), frames[0].left > 100):
        with pytest.raises(TypeError, match="uint8 or uint16"):
            slam.process(1, image)
    assert slam.process(1, np.zeros((0, 64), np.uint8)).input is byre.InputFault.no_image
    with pytest.raises(ValueError, match="ascontiguousarray"):
        slam.process(1, frames[0].left.T.copy().T)
    with pytest.raises(byre.InputError, match="not a rigid motion"):
        slam.process(frames[0], last_from_body=2 * np.eye(4))


def test_missions_report_verdicts(room, frames, room_map):
    slam = byre.Slam.on_map(byre.Recording(room).calibration, room_map, REPEATABLE)
    reports = [slam.process(images) for images in frames]
    assert any(byre.Event.localised in report.events for report in reports)
    assert reports[-1].verdict == byre.Verdict.trusted
    assert reports[-1].health.doubt == byre.DistrustReason.none
    assert reports[-1].health.offline_inliers > 50
    assert slam.plan_from_body(np.eye(4)) is None
    assert slam.plan_covariance(np.eye(4), np.eye(6)) is None
    assert "trusted" in repr(reports[-1])


def test_a_mission_accepts_a_pose_hint(room, frames, room_map):
    far = np.eye(4)
    far[0, 3] = 50.0
    for hint, is_found in ((np.eye(4), True), (far, False)):
        slam = byre.Slam.on_map(byre.Recording(room).calibration, room_map, REPEATABLE)
        slam.set_initial_pose(hint, radius=3.0)
        assert (slam.process(frames[0]).map_from_body is not None) == is_found


def test_mapping_pauses(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    slam.pause_mapping(True)
    assert slam.process(frames[0]).map_from_body is None
    assert slam.is_mapping_paused
    slam.pause_mapping(False)
    assert slam.process(frames[1]).map_from_body is not None


def test_a_map_is_extended(room, frames, room_map, tmp_path):
    slam = byre.Slam.extending(byre.Recording(room).calibration, room_map, REPEATABLE)
    before = slam.keyframes
    assert before > 0
    for images in frames:
        slam.process(images)
    slam.save(tmp_path / "more.byre")
    assert (tmp_path / "more.byre").stat().st_size > 0


def test_bad_input_has_place_and_reason(tmp_path, room):
    with pytest.raises(byre.InputError, match="no-such-recording") as raised:
        byre.Recording(tmp_path / "no-such-recording")
    assert "no-such-recording" in raised.value.place and raised.value.reason and raised.value.remedy
    with pytest.raises(byre.InputError, match="caf"):
        byre.Recording("caf\udce9")
    with pytest.raises(byre.InputError, match="no-such.byre"):
        byre.Slam.on_map(byre.Recording(room).calibration, tmp_path / "no-such.byre")
    with pytest.raises(byre.InputError, match="map is still empty"):
        byre.Slam.mapping(byre.Recording(room).calibration).save(tmp_path / "empty.byre")
    assert issubclass(byre.InputError, ValueError)


def test_calibrations_can_be_constructed():
    camera = byre.Camera(640, 480, 400.0, 400.0, 319.5, 239.5, byre.CameraModel.radial_tangential, [0.1, -0.05])
    right_from_left = np.eye(4)
    right_from_left[0, 3] = -0.12
    pair = byre.Calibration(camera, camera, right_from_left)
    assert pair.right.fx == 400.0 and pair.left.distortion[:2] == [0.1, -0.05]
    assert (pair.right_from_left == right_from_left).all() and (pair.body_from_left == np.eye(4)).all()
    assert byre.Slam.mapping(pair).is_metric
    assert not byre.Slam.mapping(byre.Calibration(camera)).is_metric
    assert pair == byre.Calibration(camera, camera, right_from_left) and pair != byre.Calibration(camera)
    with pytest.raises(ValueError, match="needs a model"):
        byre.Camera(640, 480, 400.0, 400.0, 319.5, 239.5, distortion=[0.1])
    with pytest.raises(ValueError, match="must be given together"):
        byre.Calibration(camera, camera)
    with pytest.raises(byre.InputError, match="right_from_left"):
        byre.Calibration(camera, camera, 2 * right_from_left)


AHEAD = np.array([[0, 0, 1, 0.4], [-1, 0, 0, 0.1], [0, -1, 0, 0.9], [0, 0, 0, 1]], float)  # base_from_camera


def test_extrinsics_are_written_and_read(tmp_path):
    imu = np.eye(4)
    imu[:3, 3] = [0.1, 0.0, 0.3]
    given = byre.Extrinsics(
        byre.SensorMounting(AHEAD, sigma_m=0.01),
        imu=byre.SensorMounting(imu, sigma_rad=0.1),
        wheel_scale=1.02,
        wheel_scale_sigma=0.005,
        wheel_delay=0.03,
    )
    byre.write_extrinsics(tmp_path / "robot.yaml", given)
    read = byre.read_extrinsics(tmp_path / "robot.yaml")
    assert np.allclose(read.camera.base_from_sensor, AHEAD) and np.allclose(read.imu.base_from_sensor, imu)
    assert read.camera.sigma_m == 0.01 and read.imu.sigma_rad == pytest.approx(0.1)
    assert (read.wheel_scale, read.wheel_scale_sigma, read.wheel_delay) == (1.02, 0.005, 0.03)
    assert "at (0.4, 0.1, 0.9) m, sigma 0.01 m" in repr(read.camera) and repr(read.camera) in repr(read)
    unknown = byre.Extrinsics()
    assert unknown.camera is None and unknown.imu is None and unknown.wheel_delay is None
    assert repr(unknown) == "<Extrinsics camera None, imu None, wheel_scale 1.0, sigma 0.03, wheel_delay None>"


def test_extrinsics_of_a_urdf_have_frames(tmp_path):
    origin = '<origin xyz="0 {} 1" rpy="-1.570796327 0 -1.570796327"/>'
    joints = "".join(
        f'<joint name="{name}" type="fixed"><parent link="base_link"/><child link="{name}_optical_frame"/>'
        f"{origin.format(y)}</joint>"
        for name, y in (("front", 0.2), ("rear", -0.2))
    )
    links = "".join(f'<link name="{name}"/>' for name in ("base_link", "front_optical_frame", "rear_optical_frame"))
    (tmp_path / "robot.urdf").write_text(f'<robot name="r">{links}{joints}</robot>')
    rear = byre.read_extrinsics(tmp_path / "robot.urdf", camera="rear_optical_frame")
    assert rear.camera.base_from_sensor[:3, 3] == pytest.approx([0.0, -0.2, 1.0])
    with pytest.raises(byre.InputError, match="has 2 optical frames"):
        byre.read_extrinsics(tmp_path / "robot.urdf")


def test_tags_are_read(tmp_path):
    path = tmp_path / "tags.yaml"
    path.write_text("size: 0.2\ntags:\n  - {id: 7, position: [1, 2, 3]}\n")
    try:
        (tag,) = byre.read_tags(path)
    except byre.InputError as error:
        if "without libapriltag" in str(error):
            pytest.skip(str(error))
        raise
    assert (tag.name, tag.size, list(tag.position)) == ("tag36h11 7", 0.2, [1.0, 2.0, 3.0])
    assert byre.SlamOptions(tags=[tag]).tags[0].name == tag.name
    path.write_text("tags:\n  - {id: 7}\n")
    with pytest.raises(byre.InputError, match="size: is missing"):
        byre.read_tags(path)


def test_bad_extrinsics_are_rejected(tmp_path, room):
    calibration = byre.Recording(room).calibration
    with pytest.raises(byre.InputError, match="base_from_sensor"):
        byre.SensorMounting(2 * AHEAD)
    far = AHEAD.copy()
    far[:3, 3] *= 1000.0
    with pytest.raises(byre.InputError, match="too far for a robot"):
        byre.write_extrinsics(tmp_path / "far.yaml", byre.Extrinsics(byre.SensorMounting(far)))
    assert not (tmp_path / "far.yaml").exists()
    (tmp_path / "robot.yaml").write_text("base_from_camera: [0, 0, 1]\n")
    with pytest.raises(byre.InputError, match="has 3 numbers") as raised:
        byre.read_extrinsics(tmp_path / "robot.yaml")
    assert "robot.yaml" in raised.value.place
    for bad in (
        byre.Extrinsics(),
        byre.Extrinsics(byre.SensorMounting(AHEAD, sigma_m=0.0)),
        byre.Extrinsics(byre.SensorMounting(AHEAD), wheel_scale=-1.0),
        byre.Extrinsics(byre.SensorMounting(AHEAD), wheel_delay=float("nan")),
    ):
        with pytest.raises(byre.InputError, match="SlamOptions::extrinsics"):
            byre.Slam.mapping(calibration, byre.SlamOptions(extrinsics=bad))
    with pytest.raises(TypeError):
        byre.SlamOptions(extrinsics="robot.yaml")


def test_wheels_move_one_camera_as_it_is_mounted(room):
    recording = byre.Recording(room, camera=byre.CameraChoice.left)
    left = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 1], [0, 0, 0, 1]], float)  # its right is ahead
    positions = []
    for base_from_camera in (AHEAD, left):
        options = byre.SlamOptions(workers=byre.Workers.repeatable)
        options.extrinsics = byre.Extrinsics(byre.SensorMounting(base_from_camera))
        assert options.extrinsics.camera.base_from_sensor == pytest.approx(base_from_camera)
        slam = byre.Slam.mapping(recording.calibration, options)
        odometry_from_base = np.eye(4)
        for images in list(recording)[:3]:
            slam.add_wheel_odometry(images.time_ns, odometry_from_base)
            report = slam.process(images)
            odometry_from_base[0, 3] += 0.05
        positions.append(report.map_from_body[:3, 3])
    assert positions[0] == pytest.approx([0.0, 0.0, 0.1], abs=1e-6)
    assert positions[1] == pytest.approx([0.1, 0.0, 0.0], abs=1e-6)


def test_trajectories_are_written_and_read(tmp_path):
    times = np.arange(5, dtype=np.int64) * 100_000_000
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, :3, 3] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 1], [3, 0, 1]]
    truth = byre.Trajectory(times, poses)
    truth.write(tmp_path / "truth.txt")
    again = byre.read_trajectory(tmp_path / "truth.txt")
    assert (again.times_ns == times).all() and np.allclose(again.poses, poses)
    moved = poses.copy()
    moved[:, :3, 3] *= 2.0
    estimate = byre.Trajectory(times, moved)
    assert byre.absolute_trajectory_error(estimate, truth, scale=True).translation.rmse < 1e-9
    assert byre.absolute_trajectory_error(estimate, truth, scale=True).scale == pytest.approx(0.5)
    error = byre.absolute_trajectory_error(estimate, truth)
    assert error.errors.shape == (5,) and error.translation.rmse > 0.5
    assert byre.relative_pose_error(truth, truth, seconds=0.2).translation.rmse < 1e-9
    with pytest.raises(ValueError, match="must increase"):
        byre.Trajectory(times[::-1], poses)
    with pytest.raises(TypeError, match="integer nanoseconds"):
        byre.Trajectory(times * 1e-9, poses)
    with pytest.raises(byre.InputError, match="no common poses"):
        byre.relative_pose_error(truth, truth, metres=1000.0)


def test_other_threads_run_while_a_map_is_finished(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    for images in frames:
        slam.process(images)
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    threading.Thread(target=tick, daemon=True).start()
    before = time.monotonic()
    slam.finish()
    after = time.monotonic()
    stop.set()
    # With the GIL held, another thread would run at most once, after the call.
    assert sum(before < at < after - 0.002 for at in ticks) > 1


def test_submitted_frames_are_reported_in_order(room, frames):
    calibration = byre.Recording(room).calibration
    options = byre.SlamOptions(workers=byre.Workers.repeatable, max_waiting=len(frames))
    slam = byre.Slam.mapping(calibration, options)
    reports = []
    for images in frames[::2]:
        slam.submit(images, reports.append)
        pixels = images.left.copy()
        slam.submit(images.time_ns + 1000, pixels, images.right, on_report=lambda report: reports.append(slam.keyframes))
        pixels[:] = 0
        slam.add_gyro(images.time_ns, np.zeros(3))
    assert slam.frames == len(reports) == len(frames)
    assert [report.time_ns for report in reports[::2]] == [images.time_ns for images in frames[::2]]
    assert reports[-1] == slam.keyframes > 0 and reports[-2].map_from_body is not None
    slam.submit(frames[-1])
    slam.finish()
    assert slam.frames == len(frames) + 1


def test_newer_frames_replace_waiting_ones(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    reached, opened, faults = threading.Event(), threading.Event(), []

    def block(report):
        reached.set()
        opened.wait()
        faults.append(report.input)

    slam.submit(frames[0], block)
    reached.wait()
    for images in frames[1:4]:
        slam.submit(images, lambda report: faults.append(report.input))
    opened.set()
    assert slam.frames_with(byre.InputFault.replaced) == 2
    assert faults == [byre.InputFault[name] for name in ("none", "replaced", "replaced", "none")]


def test_exceptions_of_a_callback_reach_the_caller(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    slam.submit(frames[0], lambda report: report.no_such_field)
    assert slam.frames == 1
    with pytest.raises(AttributeError, match="no_such_field"):
        slam.submit(frames[1])
    slam.submit(frames[1])
    slam.finish()
    assert slam.frames == 2
    with pytest.raises(TypeError):
        slam.submit(frames[2], 3)


def test_a_callback_may_hold_the_last_reference(room, frames):
    slam = byre.Slam.mapping(byre.Recording(room).calibration, REPEATABLE)
    reached, opened, ended = threading.Event(), threading.Event(), threading.Event()

    class Owner:
        def __init__(self):
            self.slam = slam

        def __call__(self, report):
            reached.set()
            opened.wait()

        def __del__(self):
            ended.set()

    slam.submit(frames[0], Owner())
    reached.wait()
    del slam
    opened.set()
    assert ended.wait(60)


def test_submitted_frames_are_processed_before_exit(room):
    script = """
import sys, byre
recording = byre.Recording(sys.argv[1])
slam = byre.Slam.mapping(recording.calibration, byre.SlamOptions(max_waiting=6))
for images in list(recording)[:6]:
    slam.submit(images, lambda report: print(report.time_ns))
"""
    done = subprocess.run([sys.executable, "-c", script, room], check=True, capture_output=True, text=True)
    assert len(done.stdout.splitlines()) == 6, done.stderr


def test_everything_has_a_signature():
    stub = (pathlib.Path(byre.__file__).parent / "__init__.pyi").read_text()
    declared = set(re.findall(r"^(?:class|def) (\w+)", stub, re.MULTILINE))
    assert declared == set(byre.__all__)
    for name in declared:
        bound = getattr(byre, name)
        if not isinstance(bound, type) or issubclass(bound, Exception):
            continue
        body = re.search(rf"^class {name}\b.*?(?=^\S|\Z)", stub, re.MULTILINE | re.DOTALL)[0]
        members = [member for member in vars(bound) if not member.startswith("_") and member not in ("name", "value")]
        missing = [member for member in members if not re.search(rf"\b{member}\b", body)]
        assert not missing, f"{name}: {missing}"


def test_the_example_maps_and_prints_its_error(room, tmp_path):
    script = HERE.parent / "examples" / "map_and_plot.py"
    done = subprocess.run(
        [sys.executable, script, room, "--map", tmp_path / "room.byre"], check=True, capture_output=True, text=True
    )
    assert re.search(r"^ATE \d+\.\d mm over 30 of 30 poses", done.stdout, re.MULTILINE), done.stdout
    assert (tmp_path / "room.byre").exists()
