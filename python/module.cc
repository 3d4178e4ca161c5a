#include "bindings.h"

#include "byre/input_error.h"

#include <string>

namespace byre::python {

Eigen::Matrix4d matrix_of(const Pose& pose) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.translation;
  return matrix;
}

std::optional<Eigen::Matrix4d> matrix_of(const std::optional<Pose>& pose) {
  return pose ? std::optional(matrix_of(*pose)) : std::nullopt;
}

Pose pose_of(const Eigen::Matrix4d& matrix, std::string_view name) {
  const auto rotation = rotation_from_matrix(matrix.topLeftCorner<3, 3>());
  const bool is_affine = matrix.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!rotation || !is_affine || !matrix.allFinite()) {
    throw InputError(std::string(name), "is no rigid motion", "give a 4x4 matrix of a rotation and a translation");
  }
  return {*rotation, matrix.topRightCorner<3, 1>()};
}

PYBIND11_MODULE(_byre, module) {
  module.attr("__version__") = BYRE_VERSION;
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Bad input: a file, a calibration, an argument. Says what, where, why and what to do.";
  bind_cameras(module);
  bind_slam(module);
  bind_evaluation(module);
}

}  // namespace byre::python
