// Slam and its reports.

#include "byre/slam.h"

#include "bindings.h"

#include <array>
#include <string>
#include <vector>

namespace byre::python {
namespace {

template <typename Enum>
using Named = std::pair<Enum, const char*>;

template <typename Enum, std::size_t kCount>
void bind_enum(py::module_& module, const char* name, const char* doc, const std::array<Named<Enum>, kCount>& values) {
  py::enum_<Enum> bound(module, name, doc);
  for (const auto& [value, value_name] : values) bound.value(value_name, value);
}

void bind_enums(py::module_& module) {
  bind_enum<State>(module, "State", "Whether the robot knows where it is.",
                   std::array<Named<State>, 4>{{{State::initialising, "initialising"},
                                                {State::tracking, "tracking"},
                                                {State::relocalising, "relocalising"},
                                                {State::lost, "lost"}}});
  bind_enum<Verdict>(
      module, "Verdict", "How far the pose in the map may be relied on.",
      std::array<Named<Verdict>, 3>{
          {{Verdict::trusted, "trusted"}, {Verdict::degraded, "degraded"}, {Verdict::untrusted, "untrusted"}}});
  bind_enum<Doubt>(module, "Doubt", "What speaks against a pose most.",
                   std::array<Named<Doubt>, 15>{{{Doubt::none, "none"},
                                                 {Doubt::no_pose, "no_pose"},
                                                 {Doubt::blinded, "blinded"},
                                                 {Doubt::not_registered, "not_registered"},
                                                 {Doubt::unconfirmed, "unconfirmed"},
                                                 {Doubt::off_the_map, "off_the_map"},
                                                 {Doubt::few_points, "few_points"},
                                                 {Doubt::few_offline_points, "few_offline_points"},
                                                 {Doubt::clustered, "clustered"},
                                                 {Doubt::uncertain, "uncertain"},
                                                 {Doubt::maps_disagree, "maps_disagree"},
                                                 {Doubt::frozen, "frozen"},
                                                 {Doubt::right_camera, "right_camera"},
                                                 {Doubt::cameras_disagree, "cameras_disagree"},
                                                 {Doubt::calibration, "calibration"}}});
  bind_enum<InputFault>(module, "InputFault", "What was wrong with a frame as it was handed over.",
                        std::array<Named<InputFault>, 13>{{{InputFault::none, "none"},
                                                           {InputFault::after_gap, "after_gap"},
                                                           {InputFault::missing_right, "missing_right"},
                                                           {InputFault::late_right, "late_right"},
                                                           {InputFault::missing_depth, "missing_depth"},
                                                           {InputFault::late_depth, "late_depth"},
                                                           {InputFault::no_image, "no_image"},
                                                           {InputFault::wrong_size, "wrong_size"},
                                                           {InputFault::wrong_format, "wrong_format"},
                                                           {InputFault::wrong_features, "wrong_features"},
                                                           {InputFault::repeated_time, "repeated_time"},
                                                           {InputFault::out_of_order, "out_of_order"},
                                                           {InputFault::after_finishing, "after_finishing"}}});
  bind_enum<SessionEvent>(
      module, "Event", "What happened in a frame.",
      std::array<Named<SessionEvent>, 13>{{{SessionEvent::initialised, "initialised"},
                                           {SessionEvent::localised, "localised"},
                                           {SessionEvent::pose_lost, "pose_lost"},
                                           {SessionEvent::relocalised, "relocalised"},
                                           {SessionEvent::blinded, "blinded"},
                                           {SessionEvent::left_mapped_area, "left_mapped_area"},
                                           {SessionEvent::entered_mapped_area, "entered_mapped_area"},
                                           {SessionEvent::navigation_error, "navigation_error"},
                                           {SessionEvent::restarted, "restarted"},
                                           {SessionEvent::online_corrected, "online_corrected"},
                                           {SessionEvent::loop_found, "loop_found"},
                                           {SessionEvent::map_corrected, "map_corrected"},
                                           {SessionEvent::recalibrated, "recalibrated"}}});
  bind_enum<Workers>(module, "Workers", "Where mapping is worked out beside tracking.",
                     std::array<Named<Workers>, 3>{
                         {{Workers::live, "live"}, {Workers::repeatable, "repeatable"}, {Workers::none, "none"}}});
}

void bind_reports(py::module_& module) {
  py::class_<Health>(module, "Health", "What one frame tells of how well the robot knows where it is.")
      .def_readonly("verdict", &Health::verdict)
      .def_readonly("doubt", &Health::doubt)
      .def_readonly("offline_expected", &Health::offline_expected)
      .def_readonly("offline_matches", &Health::offline_matches)
      .def_readonly("offline_inliers", &Health::offline_inliers)
      .def_readonly("online_inliers", &Health::online_inliers)
      .def_readonly("suspended", &Health::suspended)
      .def_readonly("inlier_share", &Health::inlier_share)
      .def_readonly("spread", &Health::spread)
      .def_readonly("position_sigma", &Health::position_sigma, "Metres.")
      .def_readonly("rotation_sigma", &Health::rotation_sigma, "Radians.")
      .def_readonly("distance_since_offline", &Health::distance_since_offline, "Metres.")
      .def_readonly("seconds_since_offline", &Health::seconds_since_offline);
  py::class_<FrameReport>(module, "FrameReport", "What is known after one frame. Poses are 4x4 matrices.")
      .def_property_readonly("time_ns", [](const FrameReport& report) { return report.time.count(); })
      .def_readonly("state", &FrameReport::state)
      .def_readonly("input", &FrameReport::input)
      .def_property_readonly(
          "map_from_body", [](const FrameReport& report) { return matrix_of(report.map_from_body); },
          "The pose in the map, which is corrected when more is known; None while it is not known.")
      .def_readonly("covariance", &FrameReport::covariance,
                    "6x6, translation first, of a small motion as seen in the body.")
      .def_property_readonly(
          "correction", [](const FrameReport& report) { return matrix_of(report.correction); },
          "By what a correction of the map moved the robot since the frame before, or None.")
      .def_property_readonly(
          "odometry_from_body", [](const FrameReport& report) { return matrix_of(report.odometry_from_body); },
          "The smooth pose, in a frame of its own.")
      .def_readonly("odometry_covariance", &FrameReport::odometry_covariance)
      .def_readonly("health", &FrameReport::health)
      .def_property_readonly("verdict", [](const FrameReport& report) { return report.health.verdict; })
      .def_readonly("events", &FrameReport::events)
      .def_readonly("features", &FrameReport::features)
      .def_readonly("matches", &FrameReport::matches)
      .def_readonly("inliers", &FrameReport::inliers)
      .def_readonly("keyframe_added", &FrameReport::keyframe_added)
      .def("__repr__", [](const FrameReport& report) {
        return "<FrameReport " + std::to_string(to_seconds(report.time)) + " s, " +
               std::string(to_string(report.state)) + ", " + std::string(to_string(report.health.verdict)) + ">";
      });
}

PixelFormat format_of(const py::array& image, bool is_depth) {
  const bool is_bytes = image.dtype().is(py::dtype::of<std::uint8_t>());
  const bool is_words = image.dtype().is(py::dtype::of<std::uint16_t>());
  if (is_depth && image.ndim() == 2 && is_words) return PixelFormat::depth16;
  if (is_depth && image.ndim() == 2 && image.dtype().is(py::dtype::of<float>())) return PixelFormat::depth_metres;
  if (!is_depth && image.ndim() == 2 && is_bytes) return PixelFormat::grey8;
  if (!is_depth && image.ndim() == 2 && is_words) return PixelFormat::grey16;
  if (!is_depth && image.ndim() == 3 && image.shape(2) == 3 && is_bytes) return PixelFormat::bgr8;
  throw py::type_error(is_depth
                           ? "depth is an array of uint16 (units) or float32 (metres), height x width"
                           : "an image is an array of uint8 or uint16, height x width, or of uint8, height x width "
                             "x 3 (blue, green, red)");
}

// The array's own memory: rows may be apart, pixels in a row not.
ImageView view_of(const py::array& image, std::int64_t time_ns, int bits, bool is_depth = false) {
  const PixelFormat format = format_of(image, is_depth);
  const bool is_packed = image.strides(image.ndim() - 1) == image.itemsize() &&
                         (image.ndim() == 2 || image.strides(1) == 3 * image.itemsize()) && image.strides(0) > 0;
  if (!is_packed) throw py::value_error("the pixels of a row do not lie side by side; use numpy.ascontiguousarray");
  return {image.data(),
          static_cast<int>(image.shape(1)),
          static_cast<int>(image.shape(0)),
          static_cast<std::size_t>(image.strides(0)),
          format,
          bits,
          Timestamp(time_ns)};
}

FrameReport process(Slam& slam, std::int64_t time_ns, const py::array& left, const std::optional<py::array>& right,
                    const std::optional<py::array>& depth, const std::optional<Eigen::Matrix4d>& last_from_body,
                    int bits) {
  CameraImages images{view_of(left, time_ns, bits)};
  if (right) images.right = view_of(*right, time_ns, bits);
  if (depth) images.depth = view_of(*depth, time_ns, bits, true);
  std::optional<Pose> motion;
  if (last_from_body) motion = pose_of(*last_from_body, "last_from_body");
  const py::gil_scoped_release release;
  return slam.process(images, motion);
}

FrameReport process_images(Slam& slam, const ImageFrame& images, const std::optional<Eigen::Matrix4d>& last_from_body) {
  std::optional<Pose> motion;
  if (last_from_body) motion = pose_of(*last_from_body, "last_from_body");
  const py::gil_scoped_release release;
  return slam.process(view_of(images), motion);
}

SlamOptions options_of(Workers workers, bool refine_calibration, bool map_online, const std::string& recording,
                       const std::string& site, int max_features,
                       const std::optional<std::filesystem::path>& vocabulary) {
  SlamOptions options;
  options.workers = workers;
  options.refine_calibration = refine_calibration;
  options.map_online = map_online;
  options.recording = recording;
  options.site = site;
  options.max_features = max_features;
  options.vocabulary = vocabulary;
  return options;
}

void bind_options(py::module_& module) {
  const SlamOptions defaults;
  py::class_<SlamOptions>(module, "SlamOptions", "How a Slam works; none needs to be given.")
      .def(py::init(&options_of), py::kw_only(), py::arg("workers") = defaults.workers,
           py::arg("refine_calibration") = defaults.refine_calibration, py::arg("map_online") = defaults.map_online,
           py::arg("recording") = defaults.recording, py::arg("site") = defaults.site,
           py::arg("max_features") = defaults.max_features, py::arg("vocabulary") = py::none())
      .def_readwrite("workers", &SlamOptions::workers)
      .def_readwrite("refine_calibration", &SlamOptions::refine_calibration)
      .def_readwrite("map_online", &SlamOptions::map_online)
      .def_readwrite("recording", &SlamOptions::recording)
      .def_readwrite("site", &SlamOptions::site)
      .def_readwrite("max_features", &SlamOptions::max_features);
}

void bind_slam_itself(py::module_& module) {
  const auto released = py::call_guard<py::gil_scoped_release>();
  py::class_<Slam>(module, "Slam", "One robot's SLAM: images in, poses out. Call it from one thread.")
      .def_static("mapping", &Slam::mapping, py::arg("calibration"), py::arg("options") = SlamOptions{}, released,
                  "Maps what is seen.")
      .def_static("extending", &Slam::extending, py::arg("calibration"), py::arg("map"),
                  py::arg("options") = SlamOptions{}, released, "Goes on with a kept map.")
      .def_static("on_map", &Slam::on_map, py::arg("calibration"), py::arg("map"), py::arg("options") = SlamOptions{},
                  released, "A mission on a kept map.")
      .def("process", &process_images, py::arg("images"), py::arg("last_from_body") = py::none(),
           "Tracks the next frame of a Recording.")
      .def(
          "process", &process, py::arg("time_ns"), py::arg("left"), py::arg("right") = py::none(),
          py::arg("depth") = py::none(), py::arg("last_from_body") = py::none(), py::arg("bits") = 16,
          "Tracks the next frame: arrays height x width of uint8 or uint16 (of so many bits), or height x width x 3 of "
          "uint8 (blue, green, red); depth of uint16 (units) or float32 (metres). Nothing is copied.")
      .def(
          "finish", [](Slam& slam) { slam.finish(); }, released,
          "Closes the last loops and adjusts the map as a whole. Later frames are dropped.")
      .def("save", &Slam::save, py::arg("path"), released, "Keeps what was mapped.")
      .def("trajectory", &Slam::trajectory, "Every frame that had a pose, as the map has it now.")
      .def(
          "plan_from_body",
          [](const Slam& slam, const Eigen::Matrix4d& map_from_body) {
            return matrix_of(slam.plan_from_body(pose_of(map_from_body, "map_from_body")));
          },
          py::arg("map_from_body"), "The pose on the floor plan that the map is registered on, or None.")
      .def_property_readonly("calibration", &Slam::calibration, "As it is known by now.")
      .def_property_readonly("is_metric", &Slam::is_metric)
      .def_property_readonly("keyframes", &Slam::keyframes)
      .def_property_readonly("points", &Slam::points)
      .def_property_readonly("frames", py::overload_cast<>(&Slam::frames, py::const_), "Frames handed over.")
      .def("frames_with", py::overload_cast<InputFault>(&Slam::frames, py::const_), py::arg("fault"));
}

}  // namespace

void bind_slam(py::module_& module) {
  bind_enums(module);
  bind_reports(module);
  bind_options(module);
  bind_slam_itself(module);
}

}  // namespace byre::python
