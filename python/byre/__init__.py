"""Visual SLAM for robots that work in the same building every day.

    import byre

    recording = byre.Recording("MH_01_easy")
    slam = byre.Slam.mapping(recording.calibration)
    for images in recording:
        report = slam.process(images)
        print(report.verdict, report.map_from_body)
    slam.finish()
    slam.save("hall.byre")

Live images are numpy arrays: slam.process(time_ns, left, right). A camera's callback calls slam.submit(time_ns, left,
right, on_report=show), which returns at once and calls show(report) from another thread. A saved map is a byre.Map:

    hall = byre.Map.load("hall.byre")
    print(hall, hall.positions.mean(axis=0))
    print(hall.localise(recording[10]).map_from_body)

Poses are 4x4 matrices named a_from_b: point_in_a = a_from_b @ point_in_b. Covariances are 6x6, translation before
rotation. Units: metres, radians, nanoseconds. Unknown values are None. Bad input raises InputError, a ValueError.
"""
from ._byre import (
    AbsoluteTrajectoryError,
    Calibration,
    Camera,
    CameraChoice,
    CameraModel,
    DepthCamera,
    DistrustReason,
    ErrorStatistics,
    Event,
    Extrinsics,
    FrameReport,
    Health,
    Images,
    InputError,
    InputFault,
    LocalisationFailure,
    LocalisationReport,
    Map,
    MapKeyframe,
    MapObservation,
    MapRecording,
    MapUpdateResult,
    MappedTag,
    PixelFormat,
    PlanFit,
    PlanRegistration,
    Recording,
    RelativePoseError,
    SensorMounting,
    Slam,
    SlamOptions,
    State,
    Tag,
    Trajectory,
    TrajectoryFormat,
    Verdict,
    Workers,
    __version__,
    absolute_trajectory_error,
    advice_for,
    find_ground_truth,
    read_calibration,
    read_extrinsics,
    read_tags,
    read_trajectory,
    relative_pose_error,
    update_map_file,
    write_extrinsics,
)

__all__ = [name for name in dir() if not name.startswith("_")]
