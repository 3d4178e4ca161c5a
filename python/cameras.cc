// Cameras, calibrations and recordings.

#include "bindings.h"

#include "byre/calibration.h"
#include "byre/calibration_file.h"
#include "byre/recording.h"

#include <algorithm>
#include <string>
#include <vector>

namespace byre::python {
namespace {

Camera make_camera(int width, int height, double fx, double fy, double cx, double cy, CameraModel model,
                   const std::vector<double>& distortion) {
  Camera camera{model, width, height, fx, fy, cx, cy, {}};
  if (distortion.size() > camera.distortion.size()) throw py::value_error("distortion has at most five coefficients");
  std::ranges::copy(distortion, camera.distortion.begin());
  return camera;
}

Calibration make_calibration(const Camera& left, const std::optional<Camera>& right,
                             const std::optional<Eigen::Matrix4d>& right_from_left,
                             const std::optional<Eigen::Matrix4d>& body_from_left, double readout_time) {
  if (right.has_value() != right_from_left.has_value()) {
    throw py::value_error("right and right_from_left belong together");
  }
  Calibration calibration{left};
  if (right) calibration.right = StereoPartner{*right, pose_of(*right_from_left, "right_from_left")};
  if (body_from_left) calibration.body_from_left = pose_of(*body_from_left, "body_from_left");
  calibration.readout_time = readout_time;
  return calibration;
}

void bind_camera(py::module_& module) {
  py::enum_<CameraModel>(module, "CameraModel", "Lens models as EuRoC, Kalibr and OpenCV define them.")
      .value("pinhole", CameraModel::pinhole)
      .value("radial_tangential", CameraModel::radial_tangential)
      .value("equidistant", CameraModel::equidistant);
  py::class_<Camera>(module, "Camera", "A camera as calibrated. Pixels count from the centre of the top-left one.")
      .def(py::init(&make_camera), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("model") = CameraModel::pinhole, py::arg("distortion") = std::vector<double>{})
      .def_readonly("model", &Camera::model)
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_readonly("fx", &Camera::fx)
      .def_readonly("fy", &Camera::fy)
      .def_readonly("cx", &Camera::cx)
      .def_readonly("cy", &Camera::cy)
      .def_readonly("distortion", &Camera::distortion);
}

void bind_calibration(py::module_& module) {
  py::class_<DepthCamera>(module, "DepthCamera", "A camera whose images hold depths along the optical axis.")
      .def(py::init([](double units_per_metre, double sigma_at_one_metre) {
             DepthCamera depth;
             depth.units_per_metre = units_per_metre;
             depth.sigma_at_one_metre = sigma_at_one_metre;
             return depth;
           }),
           py::arg("units_per_metre") = DepthCamera{}.units_per_metre,
           py::arg("sigma_at_one_metre") = DepthCamera{}.sigma_at_one_metre,
           "Registered to the left camera, pixel by pixel.")
      .def_readonly("units_per_metre", &DepthCamera::units_per_metre)
      .def_readonly("sigma_at_one_metre", &DepthCamera::sigma_at_one_metre);
  py::class_<Calibration>(module, "Calibration", "What is known of a robot's cameras, before any rectification.")
      .def(py::init(&make_calibration), py::arg("left"), py::arg("right") = py::none(),
           py::arg("right_from_left") = py::none(), py::arg("body_from_left") = py::none(),
           py::arg("readout_time") = 0.0)
      .def_readonly("left", &Calibration::left)
      .def_property_readonly("right",
                             [](const Calibration& calibration) {
                               return calibration.right ? std::optional(calibration.right->camera) : std::nullopt;
                             })
      .def_property_readonly("right_from_left",
                             [](const Calibration& calibration) {
                               return calibration.right ? std::optional(matrix_of(calibration.right->right_from_left))
                                                        : std::nullopt;
                             })
      .def_property_readonly("body_from_left",
                             [](const Calibration& calibration) { return matrix_of(calibration.body_from_left); })
      .def_readwrite("depth", &Calibration::depth, "The depth camera, of which and a right one there is one at most.")
      .def_readwrite("readout_time", &Calibration::readout_time, "Seconds from the first row to the last.");
  module.def("read_calibration", &read_calibration, py::arg("path"),
             "The calibration of a file: EuRoC's sensor.yaml, a camera chain of Kalibr, OpenCV or ROS.");
}

// A view of the pixels that keeps the frame alive.
template <typename Number>
py::array array_of(const std::vector<Number>& numbers, int width, int height, const py::object& owner) {
  return py::array_t<Number>({height, width}, numbers.data(), owner);
}

void bind_recording(py::module_& module) {
  py::class_<ImageFrame>(module, "Images", "What the cameras took at one time.")
      .def_property_readonly("time_ns", [](const ImageFrame& frame) { return frame.time.count(); })
      .def_property_readonly("left",
                             [](const py::object& self) {
                               const Image& image = self.cast<const ImageFrame&>().left;
                               return array_of(image.pixels, image.width, image.height, self);
                             })
      .def_property_readonly("right",
                             [](const py::object& self) -> py::object {
                               const auto& image = self.cast<const ImageFrame&>().right;
                               if (!image) return py::none();
                               return array_of(image->pixels, image->width, image->height, self);
                             })
      .def_property_readonly("depth", [](const py::object& self) -> py::object {
        const auto& image = self.cast<const ImageFrame&>().depth;
        if (!image) return py::none();
        return array_of(image->units, image->width, image->height, self);
      });
  py::enum_<CameraChoice>(module, "CameraChoice", "Which of a recording's cameras to use.")
      .value("stereo", CameraChoice::stereo)
      .value("left", CameraChoice::left)
      .value("right", CameraChoice::right)
      .value("rgbd", CameraChoice::rgbd);
  py::class_<Recording>(module, "Recording", "A recorded sequence; a list of frames, read when they are asked for.")
      .def(py::init([](const std::filesystem::path& path, const std::optional<CameraChoice>& camera,
                       const std::optional<std::filesystem::path>& calibration, std::optional<double> start_s,
                       std::optional<double> end_s) {
             FrameRange range;
             range.start_s = start_s;
             range.end_s = end_s;
             return open_recording(path, range, {camera, calibration, std::nullopt});
           }),
           py::arg("path"), py::kw_only(), py::arg("camera") = py::none(), py::arg("calibration") = py::none(),
           py::arg("start_s") = py::none(), py::arg("end_s") = py::none(),
           "EuRoC, KITTI, TUM RGB-D, a folder of images or a video. Raises InputError.")
      .def_property_readonly("calibration", [](const Recording& recording) { return recording.calibration(); })
      .def_property_readonly("warnings", [](const Recording& recording) { return recording.warnings(); })
      .def_property_readonly("times_ns",
                             [](const Recording& recording) {
                               py::array_t<std::int64_t> times(recording.size());
                               auto to = times.mutable_unchecked<1>();
                               for (py::ssize_t i = 0; i < to.shape(0); ++i)
                                 to(i) = recording.times()[static_cast<std::size_t>(i)].count();
                               return times;
                             })
      .def("__len__", &Recording::size)
      .def(
          "__getitem__",
          [](Recording& recording, int index) {
            if (index < 0) index += recording.size();
            if (index < 0 || index >= recording.size()) throw py::index_error("the recording has no such frame");
            const py::gil_scoped_release release;
            return recording.read(index);
          },
          "The images of a frame; None when they cannot be read, see warnings.");
}

}  // namespace

void bind_cameras(py::module_& module) {
  bind_camera(module);
  bind_calibration(module);
  bind_recording(module);
}

}  // namespace byre::python
