// Trajectories and their errors.

#include "enums.h"

#include "byre/input_error.h"
#include "byre/trajectory_error.h"
#include "byre/trajectory_file.h"

#include <string>

namespace byre::python {
namespace {

using Times = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;  // integers, see make_trajectory
using Matrices = py::array_t<double, py::array::c_style | py::array::forcecast>;

Trajectory make_trajectory(const py::array& times, const Matrices& poses) {
  if (times.dtype().kind() != 'i' && times.dtype().kind() != 'u')
    throw py::type_error("times must be integer nanoseconds");
  const Times times_ns(times);
  const bool fits = times_ns.ndim() == 1 && poses.ndim() == 3 && poses.shape(0) == times_ns.shape(0) &&
                    poses.shape(1) == 4 && poses.shape(2) == 4;
  if (!fits) throw py::value_error("a trajectory needs n times and n poses, n x 4 x 4");
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < times_ns.shape(0); ++i) {
    using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(poses.data(i));
    const Timestamp time(times_ns.at(i));
    if (!trajectory.empty() && time <= trajectory.back().time) throw py::value_error("times must increase strictly");
    trajectory.push_back({time, pose_of(matrix, "pose " + std::to_string(i))});
  }
  return trajectory;
}

Times times_of(const Trajectory& trajectory) {
  Times times(static_cast<py::ssize_t>(trajectory.size()));
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    times.mutable_at(static_cast<py::ssize_t>(i)) = trajectory[i].time.count();
  return times;
}

Matrices poses_of(const Trajectory& trajectory) {
  const auto count = static_cast<py::ssize_t>(trajectory.size());
  Matrices poses(std::vector<py::ssize_t>{count, 4, 4});
  for (py::ssize_t i = 0; i < count; ++i) {
    using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(poses.mutable_data(i)) = matrix_of(trajectory[static_cast<std::size_t>(i)].world_from_body);
  }
  return poses;
}

std::vector<PosePair> pairs_of(const Trajectory& estimate, const Trajectory& truth, double time_offset_s) {
  AssociationOptions options;
  options.time_offset = from_seconds(time_offset_s);
  return associate(estimate, truth, options);
}

AbsoluteTrajectoryError ate(const Trajectory& estimate, const Trajectory& truth, bool scale, double time_offset_s) {
  const auto error =
      absolute_trajectory_error(pairs_of(estimate, truth, time_offset_s), scale ? Scale::free : Scale::fixed);
  if (!error) throw InputError("the trajectories", "have fewer than three common poses, or collinear positions");
  return *error;
}

RelativePoseError rpe(const Trajectory& estimate, const Trajectory& truth, std::optional<double> metres,
                      std::optional<double> seconds, double scale, double time_offset_s) {
  if (metres && seconds) throw py::value_error("metres and seconds exclude each other; without both: one frame");
  const std::vector<PosePair> pairs = pairs_of(estimate, truth, time_offset_s);
  const RelativePoseError error = metres    ? relative_pose_error_by_distance(pairs, *metres, scale)
                                  : seconds ? relative_pose_error_by_time(pairs, from_seconds(*seconds), scale)
                                            : relative_pose_error_by_frame(pairs, scale);
  if (error.translation.count == 0) throw InputError("the trajectories", "have no common poses at this distance");
  return error;
}

void bind_trajectory(py::module_& module) {
  py::class_<Trajectory>(module, "Trajectory", "Poses of the body in the world, strictly increasing in time.")
      .def(py::init(&make_trajectory), py::arg("times_ns"), py::arg("poses"),
           "times_ns: n integers, nanoseconds.\n"
           "poses: world_from_body, n x 4 x 4, metres.\n"
           "Raises TypeError for times that are not integers, ValueError for other shapes and unordered times, and "
           "InputError for matrices that are not rigid motions.")
      .def("__len__", &Trajectory::size)
      .def_property_readonly("times_ns", &times_of, "Time stamps, nanoseconds, n, int64.")
      .def_property_readonly("poses", &poses_of, "world_from_body, metres, n x 4 x 4, float64.")
      .def(
          "write",
          [](const Trajectory& trajectory, const std::filesystem::path& path, TrajectoryFormat format) {
            write_trajectory(trajectory, path, format);
          },
          py::arg("path"), py::arg("format") = TrajectoryFormat::tum,
          "Writes a file; replaces an older trajectory atomically. Raises InputError if the file cannot be written, or "
          "exists and is no trajectory.\n"
          ">>> byre.read_trajectory(byre.find_ground_truth(room)).write(\"truth.txt\")");
  module.def("read_trajectory", &read_trajectory, py::arg("path"),
             "Reads a trajectory in TUM or EuRoC format, or the ground truth inside a EuRoC folder. Raises InputError "
             "with file and line for other formats and unordered times.\n"
             ">>> len(byre.read_trajectory(byre.find_ground_truth(room))) > 1\n"
             "True");
}

}  // namespace

void bind_evaluation(py::module_& module) {
  bind_trajectory(module);
  py::class_<ErrorStatistics>(module, "ErrorStatistics", "Statistics of errors, metres or degrees.")
      .def_readonly("rmse", &ErrorStatistics::rmse, "Root mean square.")
      .def_readonly("mean", &ErrorStatistics::mean)
      .def_readonly("median", &ErrorStatistics::median)
      .def_readonly("p95", &ErrorStatistics::p95, "95th percentile, interpolated.")
      .def_readonly("max", &ErrorStatistics::max)
      .def_readonly("count", &ErrorStatistics::count, "Number of errors.");
  py::class_<AbsoluteTrajectoryError>(module, "AbsoluteTrajectoryError",
                                      "Pose errors after alignment of the estimate to the truth (Sturm 2012).")
      .def_readonly("translation", &AbsoluteTrajectoryError::translation, "Metres.")
      .def_readonly("rotation", &AbsoluteTrajectoryError::rotation, "Degrees.")
      .def_property_readonly(
          "scale", [](const AbsoluteTrajectoryError& error) { return error.truth_from_estimate.scale; },
          "Scale of the alignment: true length per estimated length; 1 for rigid alignment.")
      .def_property_readonly(
          "errors",
          [](const AbsoluteTrajectoryError& error) {
            return py::array_t<double>(static_cast<py::ssize_t>(error.errors.size()), error.errors.data());
          },
          "Position error of each pair, metres.");
  py::class_<RelativePoseError>(module, "RelativePoseError",
                                "Errors of the motion between pairs of poses (Sturm 2012).")
      .def_readonly("translation", &RelativePoseError::translation, "Metres.")
      .def_readonly("rotation", &RelativePoseError::rotation, "Degrees.");
  module.def("absolute_trajectory_error", &ate, py::arg("estimate"), py::arg("truth"), py::arg("scale") = false,
             py::arg("time_offset_s") = 0.0,
             "Pose error after alignment of the estimate to the truth (Sturm 2012).\n"
             "scale: whether to estimate the scale of the alignment.\n"
             "time_offset_s: added to the stamps of the truth, seconds.\n"
             "Raises InputError for fewer than three common poses and for collinear positions.\n"
             ">>> truth = byre.read_trajectory(byre.find_ground_truth(room))\n"
             ">>> byre.absolute_trajectory_error(truth, truth).translation.rmse < 1e-9\n"
             "True");
  module.def("relative_pose_error", &rpe, py::arg("estimate"), py::arg("truth"), py::kw_only(),
             py::arg("metres") = py::none(), py::arg("seconds") = py::none(), py::arg("scale") = 1.0,
             py::arg("time_offset_s") = 0.0,
             "Error of the motion over one frame, or over the given length or interval (Sturm 2012).\n"
             "metres: length of the true path; seconds: interval; without both: one frame.\n"
             "scale: factor of the estimated translations.\n"
             "time_offset_s: added to the stamps of the truth, seconds.\n"
             "Raises ValueError if metres and seconds are given, and InputError without common poses.\n"
             ">>> truth = byre.read_trajectory(byre.find_ground_truth(room))\n"
             ">>> byre.relative_pose_error(truth, truth, seconds=0.2).translation.rmse < 1e-9\n"
             "True");
}

}  // namespace byre::python
