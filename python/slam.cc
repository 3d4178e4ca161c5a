// Slam and its reports.

#include "byre/slam.h"

#include "enums.h"

#include <memory>
#include <string>

namespace byre::python {
namespace {

// Releases the GIL during destruction, because Slam waits for its workers.
struct ReleasingDelete {
  void operator()(Slam* slam) const {
    const py::gil_scoped_release release;
    delete slam;
  }
};

std::optional<Matrix6> covariance_of(const std::optional<Pose>& pose, const Matrix6& covariance) {
  return pose ? std::optional(covariance) : std::nullopt;
}

std::vector<std::string> texts_of(const std::vector<MotionWarning>& warnings) {
  std::vector<std::string> texts;
  for (const MotionWarning& warning : warnings) texts.push_back(to_text(warning));
  return texts;
}

void bind_reports(py::module_& module) {
  py::class_<Health>(module, "Health", "Localisation quality of a frame.")
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
      .def_readonly("seconds_since_offline", &Health::seconds_since_offline)
      .def_readonly("hidden_share", &Health::hidden_share, "Share of the left image covered by dirt.")
      .def_readonly("hidden_share_right", &Health::hidden_share_right, "Share of the right image covered by dirt.")
      .def_property_readonly("note_on_dirt", &note_on_dirt, "Remedy for dirt on the lenses; empty without dirt.");
  py::class_<FrameReport>(module, "FrameReport", "Result of a frame. Poses are 4x4 matrices.")
      .def_property_readonly("time_ns", [](const FrameReport& report) { return report.time.count(); })
      .def_readonly("state", &FrameReport::state)
      .def_readonly("input", &FrameReport::input)
      .def_property_readonly(
          "map_from_body", [](const FrameReport& report) { return matrix_of(report.map_from_body); },
          "Pose in the map, which may jump by corrections; None without a pose.")
      .def_property_readonly(
          "covariance",
          [](const FrameReport& report) { return covariance_of(report.map_from_body, report.covariance); },
          "6x6, translation first, of a small motion in the body frame; None without a pose.")
      .def_property_readonly(
          "correction", [](const FrameReport& report) { return matrix_of(report.correction); },
          "Jump of the pose by a map correction since the previous frame, or None.")
      .def_property_readonly(
          "odometry_from_body", [](const FrameReport& report) { return matrix_of(report.odometry_from_body); },
          "Pose without jumps, in the odometry frame.")
      .def_property_readonly("odometry_covariance",
                             [](const FrameReport& report) {
                               return covariance_of(report.odometry_from_body, report.odometry_covariance);
                             })
      .def_readonly("health", &FrameReport::health)
      .def_property_readonly("verdict", [](const FrameReport& report) { return report.health.verdict; })
      .def_readonly("events", &FrameReport::events)
      .def_property_readonly(
          "warnings", [](const FrameReport& report) { return texts_of(report.warnings); },
          "Faults of wheels, gyroscope and accelerometer since the last frame, as text; each kind once.")
      .def_readonly("features", &FrameReport::features)
      .def_readonly("matches", &FrameReport::matches)
      .def_readonly("inliers", &FrameReport::inliers)
      .def_readonly("keyframe_added", &FrameReport::keyframe_added)
      .def_property_readonly(
          "online_points_left_out", [](const FrameReport& report) { return report.cuts.online_points; },
          "Whether online points were limited to meet the deadline.")
      .def_property_readonly(
          "right_image_left_out", [](const FrameReport& report) { return report.cuts.right_image; },
          "Whether only the left image was tracked, to meet the deadline.")
      .def_readonly("is_late", &FrameReport::is_late, "Whether the frame exceeded its deadline.")
      .def_readonly("refused_place", &FrameReport::refused_place,
                    "Reason for rejecting a place in the offline map; DistrustReason.none without a rejection.")
      .def("__repr__", [](const FrameReport& report) {
        return "<FrameReport " + std::to_string(to_seconds(report.time)) + " s, " +
               std::string(to_string(report.state)) + ", " + std::string(to_string(report.health.verdict)) + ">";
      });
}

constexpr const char* kPictures =
    "an image is an array of uint8 or uint16, height x width, or of uint8, height x width x 3";
constexpr const char* kDepths = "depth is an array of uint16 (units) or float32 (metres), height x width";

bool is_of(const py::array& image, char kind, py::ssize_t size) {
  return image.dtype().kind() == kind && image.itemsize() == size && image.dtype().byteorder() != '>';
}

PixelFormat depth_format(const py::array& image) {
  if (image.ndim() == 2 && is_of(image, 'u', 2)) return PixelFormat::depth16;
  if (image.ndim() == 2 && is_of(image, 'f', 4)) return PixelFormat::depth_metres;
  throw py::type_error(kDepths);
}

PixelFormat picture_format(const py::array& image, const std::optional<PixelFormat>& given) {
  const bool is_flat = image.ndim() == 2 || (image.ndim() == 3 && image.shape(2) == 1);
  const bool is_colour = image.ndim() == 3 && image.shape(2) == 3 && is_of(image, 'u', 1);
  if (is_colour) return given.value_or(PixelFormat::bgr8);
  if (is_flat && is_of(image, 'u', 1)) return PixelFormat::grey8;
  if (is_flat && is_of(image, 'u', 2)) return PixelFormat::grey16;
  throw py::type_error(kPictures);
}

// Borrows the array's memory: rows may be strided, pixels within a row must be packed.
ImageView view_of(const py::array& image, PixelFormat format, Timestamp time, int bits) {
  if (image.size() == 0) return {};
  const py::ssize_t channels = image.ndim() == 3 ? image.shape(2) : 1;
  const bool is_packed = image.strides(1) == channels * image.itemsize() && image.strides(0) > 0 &&
                         (channels == 1 || image.strides(2) == image.itemsize());
  if (!is_packed) throw py::value_error("the pixels of a row are not contiguous; use numpy.ascontiguousarray");
  ImageView view{image.data(), static_cast<int>(image.shape(1)), static_cast<int>(image.shape(0))};
  view.stride = static_cast<std::size_t>(image.strides(0));
  view.format = format;
  view.bits = bits;
  view.time = time;
  return view;
}

std::optional<BodyMotion> motion_of(const std::optional<Eigen::Matrix4d>& last_from_body) {
  if (!last_from_body) return std::nullopt;
  return BodyMotion(pose_of(*last_from_body, "last_from_body"));
}

FrameReport process(Slam& slam, std::int64_t time_ns, const py::array& left, const std::optional<py::array>& right,
                    const std::optional<py::array>& depth, const std::optional<Eigen::Matrix4d>& last_from_body,
                    const std::optional<PixelFormat>& format, int bits, std::optional<std::int64_t> right_time_ns,
                    std::optional<std::int64_t> depth_time_ns) {
  const Timestamp time(time_ns);
  CameraImages images{view_of(left, picture_format(left, format), time, bits)};
  images.left.time = time;
  if (right)
    images.right = view_of(*right, picture_format(*right, format), Timestamp(right_time_ns.value_or(time_ns)), bits);
  if (depth) images.depth = view_of(*depth, depth_format(*depth), Timestamp(depth_time_ns.value_or(time_ns)), bits);
  const std::optional<BodyMotion> motion = motion_of(last_from_body);
  const py::gil_scoped_release release;
  return slam.process(images, motion);
}

FrameReport process_images(Slam& slam, const ImageFrame& images, const std::optional<Eigen::Matrix4d>& last_from_body) {
  const std::optional<BodyMotion> motion = motion_of(last_from_body);
  const py::gil_scoped_release release;
  return slam.process(view_of(images), motion);
}

// Ctrl-C stops finishing; the adjustments so far are kept.
void finish(Slam& slam) {
  bool is_interrupted = false;
  {
    const py::gil_scoped_release release;
    slam.finish([&is_interrupted] {
      if (is_interrupted) return true;
      const py::gil_scoped_acquire acquire;
      return is_interrupted = PyErr_CheckSignals() != 0;
    });
  }
  if (is_interrupted) throw py::error_already_set();
}

// Sets fields by name.
SlamOptions options_of(const py::kwargs& fields) {
  SlamOptions options;
  const py::object self = py::cast(&options, py::return_value_policy::reference);
  for (const auto& [name, value] : fields) {
    if (!py::hasattr(self, name)) throw py::type_error("SlamOptions has no field " + py::str(name).cast<std::string>());
    py::setattr(self, name, value);
  }
  return options;
}

std::string text_of(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  return py::str(value).cast<std::string>();
}

void set_settings(SlamOptions& options, const py::dict& settings) {
  options.settings.clear();
  for (const auto& [name, value] : settings) options.settings.emplace_back(py::str(name), text_of(value));
}

py::dict settings_of(const SlamOptions& options) {
  py::dict settings;
  for (const auto& [name, value] : options.settings) settings[py::str(name)] = value;
  return settings;
}

void bind_options(py::module_& module) {
  py::class_<SlamOptions>(module, "SlamOptions", "Options of a Slam; all have defaults.")
      .def(py::init(&options_of))
      .def_property(
          "workers", [](const SlamOptions& options) { return options.workers; },
          [](SlamOptions& options, Workers workers) { options.workers = workers; })
      .def_readwrite("refine_calibration", &SlamOptions::refine_calibration)
      .def_readwrite("map_online", &SlamOptions::map_online)
      .def_readwrite("max_pair_difference", &SlamOptions::max_pair_difference, "Seconds.")
      .def_readwrite("max_gap", &SlamOptions::max_gap, "Seconds.")
      .def_readwrite("max_features", &SlamOptions::max_features)
      .def_readwrite("image_threads", &SlamOptions::image_threads)
      .def_readwrite("baseline", &SlamOptions::baseline,
                     "Metres, replaces that of the calibration; required to confirm one outside 2 mm to 1 m.")
      .def_readwrite("recording", &SlamOptions::recording)
      .def_readwrite("site", &SlamOptions::site)
      .def_readwrite("vocabulary", &SlamOptions::vocabulary)
      .def_property(
          "plan",
          [](const SlamOptions& options) {
            return options.plan ? std::optional(options.plan->plan.name) : std::nullopt;
          },
          [](SlamOptions& options, const std::optional<std::filesystem::path>& file) {
            options.plan = file ? std::optional(read_drawn_floor_plan(*file)) : std::nullopt;
          },
          "Floor plan on which the mission's map is registered: set to a file, reads as its name.")
      .def_property("settings", &settings_of, &set_settings, "Options of docs/reference/options.md by name.");
}

using SlamClass = py::class_<Slam, std::unique_ptr<Slam, ReleasingDelete>>;

void bind_making(SlamClass& type) {
  const auto released = py::call_guard<py::gil_scoped_release>();
  type.def_static("mapping", &Slam::mapping, py::arg("calibration"), py::arg("options") = SlamOptions{}, released,
                  "Makes a new map.")
      .def_static("extending", &Slam::extending, py::arg("calibration"), py::arg("map"),
                  py::arg("options") = SlamOptions{}, released, "Extends a stored map.")
      .def_static("on_map", &Slam::on_map, py::arg("calibration"), py::arg("map"), py::arg("options") = SlamOptions{},
                  released, "Mission on an offline map.");
}

void bind_input(SlamClass& type) {
  type.def("process", &process_images, py::arg("images"), py::arg("last_from_body") = py::none(),
           "Processes the next frame of a Recording.")
      .def("process", &process, py::arg("time_ns"), py::arg("left"), py::arg("right") = py::none(),
           py::arg("depth") = py::none(), py::arg("last_from_body") = py::none(), py::arg("format") = py::none(),
           py::arg("bits") = 16, py::arg("right_time_ns") = py::none(), py::arg("depth_time_ns") = py::none(),
           "Processes the next frame: arrays height x width of uint8 or uint16 (with `bits` bits), or height x width x "
           "3 of uint8 (BGR unless format is rgb8); depth of uint16 (units) or float32 (metres). Arrays are borrowed "
           "for the call.")
      .def(
          "add_wheel_odometry",
          [](Slam& slam, std::int64_t time_ns, const Eigen::Matrix4d& odometry_from_base) {
            slam.add_wheel_odometry({Timestamp(time_ns), pose_of(odometry_from_base, "odometry_from_base")});
          },
          py::arg("time_ns"), py::arg("odometry_from_base"),
          "Adds wheel odometry, before the frames that follow it: base pose in the drifting odometry frame.")
      .def(
          "add_wheel_velocity",
          [](Slam& slam, std::int64_t time_ns, double vx, double vy, double wz) {
            slam.add_wheel_odometry(BaseTwist{Timestamp(time_ns), vx, vy, wz});
          },
          py::arg("time_ns"), py::arg("vx"), py::arg("vy"), py::arg("wz"),
          "Adds wheel odometry without poses: velocity of the base in its own axes, metres and radians per second.")
      .def(
          "add_gyro",
          [](Slam& slam, std::int64_t time_ns, const Eigen::Vector3d& rate) {
            slam.add_gyro({Timestamp(time_ns), rate});
          },
          py::arg("time_ns"), py::arg("rate"),
          "Adds a gyroscope sample, before the frames that follow it: radians per second.")
      .def(
          "add_accel",
          [](Slam& slam, std::int64_t time_ns, const Eigen::Vector3d& acceleration) {
            slam.add_accel({Timestamp(time_ns), acceleration});
          },
          py::arg("time_ns"), py::arg("acceleration"),
          "Adds an accelerometer sample of the same IMU: m/s^2 including gravity, along the same axes.")
      .def(
          "set_initial_pose",
          [](Slam& slam, const Eigen::Matrix4d& map_from_body, double radius, double turn, double seconds) {
            slam.set_initial_pose({pose_of(map_from_body, "map_from_body"), radius, turn, seconds});
          },
          py::arg("map_from_body"), py::arg("radius") = 2.0, py::arg("turn") = 1.0, py::arg("seconds") = 10.0,
          "Initial pose by an operator: a mission without a pose searches the offline map only near it for the given "
          "seconds, then everywhere. Metres, radians.")
      .def("pause_mapping", &Slam::pause_mapping, py::arg("is_paused"),
           "Pauses mapping: frames are tracked on the existing maps, which do not grow.")
      .def_property_readonly("is_mapping_paused", &Slam::is_mapping_paused);
}

void bind_results(SlamClass& type) {
  const auto released = py::call_guard<py::gil_scoped_release>();
  type.def("finish", &finish, "Closes the last loops and adjusts the whole map. Later frames are dropped.")
      .def("save", &Slam::save, py::arg("path"), released, "Saves the map.")
      .def("trajectory", &Slam::trajectory, "Poses of all localised frames, as corrected by the map so far.")
      .def(
          "plan_from_body",
          [](const Slam& slam, const Eigen::Matrix4d& map_from_body) {
            return matrix_of(slam.plan_from_body(pose_of(map_from_body, "map_from_body")));
          },
          py::arg("map_from_body"), "Pose on the floor plan of the map, or None.")
      .def(
          "plan_covariance",
          [](const Slam& slam, const Eigen::Matrix4d& map_from_body, const Matrix6& covariance) {
            return slam.plan_covariance(pose_of(map_from_body, "map_from_body"), covariance);
          },
          py::arg("map_from_body"), py::arg("covariance"),
          "Covariance of the pose on the floor plan, including that of the registration, or None.")
      .def_property_readonly("calibration", &Slam::calibration, "Current calibration, with refinements.")
      .def_property_readonly("is_metric", &Slam::is_metric)
      .def_property_readonly("map_damage", &Slam::map_damage,
                             "Damage of the mission's map file, as text; None without damage.")
      .def_property_readonly("keyframes", &Slam::keyframes)
      .def_property_readonly("points", &Slam::points)
      .def_property_readonly(
          "motion_warnings", [](const Slam& slam) { return texts_of(slam.motion_warnings()); },
          "Faults of wheels, gyroscope and accelerometer so far, as text; each kind once.")
      .def_property_readonly("frames", py::overload_cast<>(&Slam::frames, py::const_), "Number of processed frames.")
      .def("frames_with", py::overload_cast<InputFault>(&Slam::frames, py::const_), py::arg("fault"));
}

void bind_slam_itself(py::module_& module) {
  SlamClass slam(module, "Slam", "One robot's SLAM: images in, poses out. Call it from one thread.");
  bind_making(slam);
  bind_input(slam);
  bind_results(slam);
}

}  // namespace

void bind_slam(py::module_& module) {
  bind_reports(module);
  bind_options(module);
  bind_slam_itself(module);
}

}  // namespace byre::python
