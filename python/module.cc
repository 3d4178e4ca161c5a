#include "enums.h"

#include "byre/input_error.h"

#include <exception>
#include <string>
#include <utility>

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
    throw InputError(std::string(name), "is not a rigid motion", "give a 4x4 matrix of rotation and translation");
  }
  return {*rotation, matrix.topRightCorner<3, 1>()};
}

py::str text_of(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
}

namespace {

void bind_input_error(py::module_& module) {
  static py::handle type;  // never released
  type = py::exception<InputError>(module, "InputError", PyExc_ValueError).release();
  type.attr("__doc__") =
      "Bad input, such as a file, a calibration or a matrix. place: file, line or field; reason: fault; remedy: advice "
      "to the user, may be empty.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const InputError& error) {
      py::object raised = py::reinterpret_borrow<py::object>(type)(text_of(error.what()));
      raised.attr("place") = text_of(error.place());
      raised.attr("reason") = text_of(error.reason());
      raised.attr("remedy") = text_of(error.remedy());
      PyErr_SetObject(type.ptr(), raised.ptr());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_byre, module) {
  module.attr("__version__") = BYRE_VERSION;
  bind_input_error(module);
  bind_enums(module);
  bind_cameras(module);
  bind_evaluation(module);
  bind_extrinsics(module);
  bind_map_updates(module);
  bind_tags(module);
  bind_map(module);
  bind_slam(module);
}

}  // namespace byre::python
