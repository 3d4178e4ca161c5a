// Cameras, calibrations and recordings.

#include "enums.h"

#include "byre/calibration.h"
#include "byre/calibration_file.h"
#include "byre/input_error.h"
#include "byre/recording.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace byre::python {
namespace {

Camera make_camera(int width, int height, double fx, double fy, double cx, double cy, CameraModel model,
                   const std::vector<double>& distortion) {
  Camera camera{model, width, height, fx, fy, cx, cy, {}};
  if (distortion.size() > camera.distortion.size())
    throw py::value_error("distortion has at most fourteen coefficients");
  const bool is_distorted = std::ranges::any_of(distortion, [](double value) { return value != 0.0; });
  if (is_distorted && model == CameraModel::pinhole) throw py::value_error("distortion needs a model with distortion");
  std::ranges::copy(distortion, camera.distortion.begin());
  return camera;
}

Calibration make_calibration(const Camera& left, const std::optional<Camera>& right,
                             const std::optional<Eigen::Matrix4d>& right_from_left,
                             const std::optional<Eigen::Matrix4d>& body_from_left,
                             const std::optional<DepthCamera>& depth, double readout_time) {
  if (right.has_value() != right_from_left.has_value()) {
    throw py::value_error("right and right_from_left must be given together");
  }
  Calibration calibration;
  calibration.left = left;
  if (right) calibration.right = StereoPartner{*right, pose_of(*right_from_left, "right_from_left")};
  if (body_from_left) calibration.body_from_left = pose_of(*body_from_left, "body_from_left");
  calibration.depth = depth;
  calibration.readout_time = readout_time;
  return calibration;
}

void bind_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera",
                     "Intrinsics of a camera. Pixels: origin at the centre of the top left pixel, u right, v down.")
      .def(py::init(&make_camera), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("model") = CameraModel::pinhole, py::arg("distortion") = std::vector<double>{},
           "distortion: at most fourteen coefficients, see CameraModel. Raises ValueError for more coefficients, and "
           "for "
           "distortion of a pinhole camera.")
      .def_readonly("model", &Camera::model)
      .def_readonly("width", &Camera::width, "Pixels.")
      .def_readonly("height", &Camera::height, "Pixels.")
      .def_readonly("fx", &Camera::fx, "Pixels.")
      .def_readonly("fy", &Camera::fy, "Pixels.")
      .def_readonly("cx", &Camera::cx, "Pixels.")
      .def_readonly("cy", &Camera::cy, "Pixels.")
      .def_readonly("distortion", &Camera::distortion, "Fourteen coefficients, see CameraModel; unused ones are zero.")
      .def("__eq__", [](const Camera& camera, const Camera& other) { return camera == other; });
}

void bind_calibration(py::module_& module) {
  py::class_<DepthCamera>(module, "DepthCamera",
                          "Depth camera next to the left camera. Its images hold depths along its optical axis.")
      .def(py::init([](double units_per_metre, double sigma_at_one_metre, const std::optional<Camera>& camera,
                       const std::optional<Eigen::Matrix4d>& left_from_depth) {
             DepthCamera depth;
             depth.units_per_metre = units_per_metre;
             depth.sigma_at_one_metre = sigma_at_one_metre;
             depth.camera = camera;
             if (left_from_depth) depth.left_from_depth = pose_of(*left_from_depth, "left_from_depth");
             return depth;
           }),
           py::arg("units_per_metre") = DepthCamera{}.units_per_metre,
           py::arg("sigma_at_one_metre") = DepthCamera{}.sigma_at_one_metre, py::arg("camera") = py::none(),
           py::arg("left_from_depth") = py::none(),
           "Without camera the depth images are registered to the left camera's pixels. Raises InputError if "
           "left_from_depth is not a rigid motion.")
      .def_readonly("units_per_metre", &DepthCamera::units_per_metre, "Units of uint16 depth images per metre.")
      .def_readonly("sigma_at_one_metre", &DepthCamera::sigma_at_one_metre,
                    "Standard deviation of a depth of one metre, metres; grows with the square of depth.")
      .def_readonly("camera", &DepthCamera::camera, "None if depth images are registered to the left camera's pixels.")
      .def_property_readonly(
          "left_from_depth", [](const DepthCamera& depth) { return matrix_of(depth.left_from_depth); },
          "4x4 pose of the depth camera in the left camera, metres.");
  py::class_<Calibration>(module, "Calibration",
                          "Cameras before rectification: one camera, a stereo pair, or a camera with a depth camera.")
      .def(py::init(&make_calibration), py::arg("left"), py::arg("right") = py::none(),
           py::arg("right_from_left") = py::none(), py::arg("body_from_left") = py::none(),
           py::arg("depth") = py::none(), py::arg("readout_time") = 0.0,
           "Raises ValueError if only one of right and right_from_left is given, and InputError if a matrix is not a "
           "rigid motion.")
      .def_readonly("left", &Calibration::left)
      .def_property_readonly(
          "right",
          [](const Calibration& calibration) {
            return calibration.right ? std::optional(calibration.right->camera) : std::nullopt;
          },
          "Right camera of a stereo pair, or None.")
      .def_property_readonly(
          "right_from_left",
          [](const Calibration& calibration) {
            return calibration.right ? std::optional(matrix_of(calibration.right->right_from_left)) : std::nullopt;
          },
          "4x4 pose of the left camera in the right camera, metres; None without a right camera.")
      .def_property_readonly(
          "body_from_left", [](const Calibration& calibration) { return matrix_of(calibration.body_from_left); },
          "4x4 pose of the left camera in the body, metres; identity by default.")
      .def_readonly("depth", &Calibration::depth, "Depth camera, or None.")
      .def_readonly("readout_time", &Calibration::readout_time,
                    "Rolling-shutter readout time from the first row to the last, seconds; negative if the last row is "
                    "read first; zero for a global shutter.")
      .def("__eq__", [](const Calibration& calibration, const Calibration& other) { return calibration == other; });
  module.def(
      "read_calibration", &read_calibration, py::arg("path"), py::arg("right") = py::none(),
      "Reads the calibration of one camera or a stereo pair in any format of the reference page "
      "\"calibration_files\". right: file of the right camera, if each camera has its own. \"FILE#NAME\" reads one "
      "of several cameras. "
      "Raises InputError with the field for an unsupported model and for a missing or invalid value.\n"
      ">>> byre.read_calibration(room / \"mav0/cam0/sensor.yaml\", room / \"mav0/cam1/sensor.yaml\").left.fx > 0\n"
      "True");
}

// A view of the pixels; keeps the frame alive.
template <typename Number>
py::array array_of(const std::vector<Number>& numbers, int width, int height, const py::object& owner) {
  return py::array_t<Number>({height, width}, numbers.data(), owner);
}

// A recording with serialised, thread-safe access.
class SharedRecording {
 public:
  explicit SharedRecording(std::unique_ptr<Recording> recording) : recording_(std::move(recording)) {}

  const Recording& constant() const { return *recording_; }  // access to what reading does not change
  int size() const { return recording_->size(); }
  std::optional<ImageFrame> read(int index) {
    const std::scoped_lock lock(mutex_);
    return recording_->read(index);
  }
  std::vector<std::string> warnings() {
    const std::scoped_lock lock(mutex_);
    return recording_->warnings();
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Recording> recording_;
};

std::shared_ptr<SharedRecording> open(const std::filesystem::path& path, const std::optional<CameraChoice>& camera,
                                      const std::optional<std::filesystem::path>& calibration,
                                      std::optional<double> frame_rate_hz, std::optional<double> start_s,
                                      std::optional<double> end_s, int stride,
                                      const std::optional<std::string>& left_topic,
                                      const std::optional<std::string>& right_topic, std::optional<double> baseline,
                                      const std::optional<std::filesystem::path>& right_calibration,
                                      const std::optional<std::string>& depth_topic,
                                      std::optional<double> pair_tolerance_s) {
  FrameRange range;
  range.start_s = start_s;
  range.end_s = end_s;
  range.stride = stride;
  if (stride < 1) throw py::value_error("stride must be at least one");
  const py::gil_scoped_release release;
  OpenOptions options{camera, calibration, frame_rate_hz, left_topic, right_topic};
  options.baseline = baseline;
  options.right_calibration = right_calibration;
  options.depth_topic = depth_topic;
  options.pair_tolerance_s = pair_tolerance_s;
  return std::make_shared<SharedRecording>(open_recording(path, range, options));
}

std::optional<ImageFrame> frame_of(SharedRecording& recording, int index) {
  if (index < 0) index += recording.size();
  if (index < 0 || index >= recording.size()) throw py::index_error("frame index out of range");
  const py::gil_scoped_release release;
  return recording.read(index);
}

py::array_t<std::int64_t> times_of(const SharedRecording& recording) {
  py::array_t<std::int64_t> times(recording.size());
  auto to = times.mutable_unchecked<1>();
  for (py::ssize_t i = 0; i < to.shape(0); ++i)
    to(i) = recording.constant().times()[static_cast<std::size_t>(i)].count();
  return times;
}

py::list warnings_of(SharedRecording& recording) {
  std::vector<std::string> warnings;
  {
    const py::gil_scoped_release release;
    warnings = recording.warnings();
  }
  py::list texts;
  for (const std::string& warning : warnings) texts.append(text_of(warning));
  return texts;
}

// Skips unreadable frames.
struct FrameIterator {
  std::shared_ptr<SharedRecording> recording;
  int next = 0;

  ImageFrame take() {
    while (next < recording->size()) {
      if (auto frame = frame_of(*recording, next++)) return std::move(*frame);
    }
    throw py::stop_iteration();
  }
};

void bind_images(py::module_& module) {
  py::class_<ImageFrame>(module, "Images",
                         "Decoded images of one frame of a recording. Arrays are views and keep the frame alive.")
      .def_property_readonly(
          "time_ns", [](const ImageFrame& frame) { return frame.time.count(); }, "Time stamp, nanoseconds.")
      .def_property_readonly(
          "left",
          [](const py::object& self) {
            const Image& image = self.cast<const ImageFrame&>().left;
            return array_of(image.pixels, image.width, image.height, self);
          },
          "Grey values, height x width, uint8.")
      .def_property_readonly(
          "right",
          [](const py::object& self) -> py::object {
            const auto& image = self.cast<const ImageFrame&>().right;
            if (!image) return py::none();
            return array_of(image->pixels, image->width, image->height, self);
          },
          "Grey values, height x width, uint8; None without a right image.")
      .def_property_readonly(
          "depth",
          [](const py::object& self) -> py::object {
            const auto& image = self.cast<const ImageFrame&>().depth;
            if (!image) return py::none();
            return array_of(image->units, image->width, image->height, self);
          },
          "Depths in units of DepthCamera.units_per_metre, zero if invalid, height x width, uint16; None without a "
          "depth image.");
}

void bind_recording(py::module_& module) {
  py::class_<FrameIterator>(module, "_Frames")
      .def("__iter__", [](FrameIterator& iterator) -> FrameIterator& { return iterator; })
      .def("__next__", &FrameIterator::take);
  py::class_<SharedRecording, std::shared_ptr<SharedRecording>>(
      module, "Recording", "Recorded sequence of frames, decoded on access. Access from several threads is safe.")
      .def(py::init(&open), py::arg("path"), py::kw_only(), py::arg("camera") = py::none(),
           py::arg("calibration") = py::none(), py::arg("frame_rate_hz") = py::none(), py::arg("start_s") = py::none(),
           py::arg("end_s") = py::none(), py::arg("stride") = 1, py::arg("left_topic") = py::none(),
           py::arg("right_topic") = py::none(), py::arg("baseline") = py::none(),
           py::arg("right_calibration") = py::none(), py::arg("depth_topic") = py::none(),
           py::arg("pair_tolerance_s") = py::none(),
           "Opens a EuRoC, KITTI or TUM RGB-D folder, a folder of images, a video or a ROS bag.\n"
           "camera: cameras to use; default: a stereo pair if available, with depth if available.\n"
           "calibration: calibration file; replaces that of the recording.\n"
           "frame_rate_hz: frame rate of images and videos, Hz.\n"
           "start_s, end_s: limits in seconds from the first frame; end_s is exclusive.\n"
           "stride: every n-th frame is read.\n"
           "left_topic, right_topic: image topics of a bag; default: detected.\n"
           "baseline: baseline of the stereo pair, metres; replaces that of the calibration.\n"
           "right_calibration: calibration file of the right camera, if each camera has its own.\n"
           "depth_topic: topic of depth images in a bag; default: detected.\n"
           "pair_tolerance_s: largest time difference within a stereo pair, seconds; default: 0.002.\n"
           "Raises InputError for missing files, an invalid calibration, an absent camera and a range without frames, "
           "and ValueError for a stride below one.")
      .def_property_readonly(
          "calibration", [](const SharedRecording& recording) { return recording.constant().calibration(); },
          "Calibration of the cameras used.")
      .def_property_readonly("warnings", &warnings_of, "Warnings of opening, then of reading.")
      .def_property_readonly("times_ns", &times_of, "Times of the frames, nanoseconds, int64, strictly increasing.")
      .def("__len__", &SharedRecording::size)
      .def("__getitem__", &frame_of,
           "Images of a frame; a negative index counts from the end. None if the left image cannot be read, with a "
           "warning. Raises IndexError.")
      .def(
          "__iter__", [](const std::shared_ptr<SharedRecording>& recording) { return FrameIterator{recording}; },
          "Iterates over the frames, without unreadable ones.");
  module.def("find_ground_truth", &find_ground_truth, py::arg("path"),
             "Path of the ground truth of a recording, or None.\n"
             ">>> byre.find_ground_truth(room) is None\n"
             "False");
}

}  // namespace

void bind_cameras(py::module_& module) {
  bind_camera(module);
  bind_calibration(module);
  bind_images(module);
  bind_recording(module);
}

}  // namespace byre::python
