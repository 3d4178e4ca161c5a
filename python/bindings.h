#pragma once

#include "byre/image.h"
#include "byre/pose.h"
#include "byre/trajectory.h"

#include <optional>
#include <string_view>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

// Python gets a list of poses as an opaque object, not as a list.
PYBIND11_MAKE_OPAQUE(byre::Trajectory)

namespace byre::python {

namespace py = pybind11;

// Each adds its part of the package to the module.
void bind_cameras(py::module_& module);
void bind_extrinsics(py::module_& module);
void bind_map(py::module_& module);
void bind_slam(py::module_& module);
void bind_map_updates(py::module_& module);
void bind_tags(py::module_& module);
void bind_evaluation(py::module_& module);

// Decodes text that may not be UTF-8, such as file names.
py::str text_of(std::string_view text);

// Poses are 4x4 matrices in Python.
Eigen::Matrix4d matrix_of(const Pose& pose);
std::optional<Eigen::Matrix4d> matrix_of(const std::optional<Pose>& pose);
// Throws InputError if the matrix is no rigid motion. name: the argument's name.
Pose pose_of(const Eigen::Matrix4d& matrix, std::string_view name);

// Views of arrays, with times of zero. Raises TypeError or ValueError for arrays that are no images.
CameraImages images_of(const py::array& left, const std::optional<py::array>& right,
                       const std::optional<py::array>& depth, const std::optional<PixelFormat>& format, int bits);

}  // namespace byre::python
