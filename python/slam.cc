// Slam and its reports.

#include "byre/slam.h"
#include "byre/site.h"

#include "enums.h"

#include <memory>
#include <string>
#include <utility>

#include <pybind11/functional.h>

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
  py::class_<Health>(module, "Health", "Quality measures of one frame. Counts are of map points.")
      .def_readonly("verdict", &Health::verdict, "Reliability of the pose in the map.")
      .def_readonly("doubt", &Health::doubt, "Main reason against trusting the pose.")
      .def_readonly("offline_expected", &Health::offline_expected,
                    "Offline points in the frustum, without suspended ones and those hidden by dirt.")
      .def_readonly("offline_matches", &Health::offline_matches, "Offline points matched.")
      .def_readonly("offline_inliers", &Health::offline_inliers, "Offline points that fit the pose.")
      .def_readonly("online_inliers", &Health::online_inliers, "Online points that fit the pose.")
      .def_readonly("suspended", &Health::suspended, "Offline points excluded for this mission, as they have moved.")
      .def_readonly("inlier_share", &Health::inlier_share, "Inliers as a share of matches.")
      .def_readonly("spread", &Health::spread,
                    "Standard deviation of inliers in the direction of least spread, as a share of the image diagonal.")
      .def_readonly("position_sigma", &Health::position_sigma, "Metres, root of the trace of the position covariance.")
      .def_readonly("rotation_sigma", &Health::rotation_sigma, "Radians, root of the trace of the rotation covariance.")
      .def_readonly("distance_since_offline", &Health::distance_since_offline,
                    "Path length since offline points last held the pose, metres.")
      .def_readonly("seconds_since_offline", &Health::seconds_since_offline,
                    "Time since offline points last held the pose, seconds.")
      .def_readonly("hidden_share", &Health::hidden_share, "Share of the left image hidden by dirt, 0 to 1.")
      .def_readonly("hidden_share_right", &Health::hidden_share_right,
                    "Share of the right image hidden by dirt, 0 to 1.")
      .def_property_readonly("note_on_dirt", &note_on_dirt, "Advice on dirt on the lenses; empty without dirt.");
  py::class_<FrameReport>(module, "FrameReport",
                          "Result of one frame. Poses are 4x4, in metres. A dropped frame has no pose.")
      .def_property_readonly(
          "time_ns", [](const FrameReport& report) { return report.time.count(); }, "Time stamp, nanoseconds.")
      .def_readonly("state", &FrameReport::state, "State of tracking.")
      .def_readonly("input", &FrameReport::input, "Fault of the input.")
      .def_property_readonly(
          "map_from_body", [](const FrameReport& report) { return matrix_of(report.map_from_body); },
          "Pose in the offline map, or in the session's own map; jumps when the map is corrected. None while unknown.")
      .def_readonly("map", &FrameReport::map,
                    "Name in the site of the map that map_from_body refers to; empty without a site.")
      .def_property_readonly(
          "covariance",
          [](const FrameReport& report) { return covariance_of(report.map_from_body, report.covariance); },
          "Covariance of map_from_body, 6x6: small motion in the body frame, translation before rotation, metres and "
          "radians. None without a pose.")
      .def_property_readonly(
          "correction", [](const FrameReport& report) { return matrix_of(report.correction); },
          "Correction of the map since the previous frame, applied to the pose: after_from_before in the map frame; or "
          "None.")
      .def_property_readonly(
          "odometry_from_body", [](const FrameReport& report) { return matrix_of(report.odometry_from_body); },
          "Pose in the odometry frame, which is that of the body at the start: drifts, never jumps. None while "
          "unknown.")
      .def_property_readonly(
          "odometry_covariance",
          [](const FrameReport& report) {
            return covariance_of(report.odometry_from_body, report.odometry_covariance);
          },
          "Covariance of odometry_from_body, 6x6 as covariance; None without that pose.")
      .def_readonly("health", &FrameReport::health, "Quality measures of the frame.")
      .def_property_readonly(
          "verdict", [](const FrameReport& report) { return report.health.verdict; }, "Verdict of health.")
      .def_readonly("events", &FrameReport::events, "Events in order.")
      .def_readonly("moved_tags", &FrameReport::moved_tags,
                    "AprilTags found moved in this frame, list of MappedTag at their places now; ignored from here on.")
      .def_property_readonly(
          "warnings", [](const FrameReport& report) { return texts_of(report.warnings); },
          "Faults of wheels, gyroscope, accelerometer and AprilTags since the previous frame, as text.")
      .def_readonly("features", &FrameReport::features, "Features detected.")
      .def_readonly("matches", &FrameReport::matches, "Map points matched.")
      .def_readonly("inliers", &FrameReport::inliers, "Matches that fit the pose.")
      .def_readonly("keyframe_added", &FrameReport::keyframe_added,
                    "Whether the frame was added to the map as a keyframe.")
      .def_property_readonly(
          "online_points_left_out", [](const FrameReport& report) { return report.cuts.online_points; },
          "Whether fewer online points were searched to keep the deadline.")
      .def_property_readonly(
          "right_image_left_out", [](const FrameReport& report) { return report.cuts.right_image; },
          "Whether the right image was skipped to keep the deadline.")
      .def_readonly("is_late", &FrameReport::is_late, "Whether the frame exceeded its deadline despite the cuts.")
      .def_readonly("refused_place", &FrameReport::refused_place,
                    "Reason for rejecting the place found in the offline map, in this or a recent frame; "
                    "DistrustReason.none without a rejection.")
      .def("__repr__", [](const FrameReport& report) {
        return "<FrameReport " + std::to_string(to_seconds(report.time)) + " s, " +
               std::string(to_string(report.state)) + ", " + std::string(to_string(report.health.verdict)) + ">";
      });
}

std::optional<BodyMotion> motion_of(const std::optional<Eigen::Matrix4d>& last_from_body) {
  if (!last_from_body) return std::nullopt;
  return BodyMotion(pose_of(*last_from_body, "last_from_body"));
}

// Weak references to Slams with submitted frames. These are processed before the interpreter ends, because it then ends
// all threads that take the GIL, as for a callback. Created by bind_slam, never released.
py::handle submitting;

void note_submitting(const Slam& slam) {
  submitting.attr("add")(py::cast(slam, py::return_value_policy::reference));
}

void process_before_exit() {
  submitting = py::module_::import("weakref").attr("WeakSet")().release();
  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const py::list slams(py::reinterpret_borrow<py::object>(submitting));
    for (const py::handle slam : slams) py::getattr(slam, "frames");
  }));
}

CameraImages images_at(std::int64_t time_ns, CameraImages images, std::optional<std::int64_t> right_time_ns,
                       std::optional<std::int64_t> depth_time_ns) {
  images.left.time = Timestamp(time_ns);
  if (images.right) images.right->time = Timestamp(right_time_ns.value_or(time_ns));
  if (images.depth) images.depth->time = Timestamp(depth_time_ns.value_or(time_ns));
  return images;
}

FrameReport process(Slam& slam, std::int64_t time_ns, const py::array& left, const std::optional<py::array>& right,
                    const std::optional<py::array>& depth, const std::optional<Eigen::Matrix4d>& last_from_body,
                    const std::optional<PixelFormat>& format, int bits, std::optional<std::int64_t> right_time_ns,
                    std::optional<std::int64_t> depth_time_ns) {
  const CameraImages images =
      images_at(time_ns, images_of(left, right, depth, format, bits), right_time_ns, depth_time_ns);
  const std::optional<BodyMotion> motion = motion_of(last_from_body);
  const py::gil_scoped_release release;
  return slam.process(images, motion);
}

void submit(Slam& slam, std::int64_t time_ns, const py::array& left, const std::optional<py::array>& right,
            const std::optional<py::array>& depth, ReportCallback on_report,
            const std::optional<Eigen::Matrix4d>& last_from_body, const std::optional<PixelFormat>& format, int bits,
            std::optional<std::int64_t> right_time_ns, std::optional<std::int64_t> depth_time_ns) {
  const CameraImages images =
      images_at(time_ns, images_of(left, right, depth, format, bits), right_time_ns, depth_time_ns);
  const std::optional<BodyMotion> motion = motion_of(last_from_body);
  note_submitting(slam);
  const py::gil_scoped_release release;
  slam.submit(images, std::move(on_report), motion);
}

FrameReport process_images(Slam& slam, const ImageFrame& images, const std::optional<Eigen::Matrix4d>& last_from_body) {
  const std::optional<BodyMotion> motion = motion_of(last_from_body);
  const py::gil_scoped_release release;
  return slam.process(view_of(images), motion);
}

void submit_images(Slam& slam, const ImageFrame& images, ReportCallback on_report,
                   const std::optional<Eigen::Matrix4d>& last_from_body) {
  const std::optional<BodyMotion> motion = motion_of(last_from_body);
  note_submitting(slam);
  const py::gil_scoped_release release;
  slam.submit(images, std::move(on_report), motion);
}

// Ctrl-C stops finishing; the map keeps the steps done.
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

void bind_advice(py::module_& module) {
  module.def(
      "advice_for", [](DistrustReason doubt) { return std::string(advice_for(doubt)); }, py::arg("doubt"),
      "Remedy for an operator against a reason of distrust; empty for none.\n"
      ">>> byre.advice_for(byre.DistrustReason.dirty)\n"
      "'clean the lens'");
}

void bind_options(py::module_& module) {
  py::class_<SlamOptions>(module, "SlamOptions",
                          "Options of a Slam. The constructor takes fields by name; all have defaults.")
      .def(py::init(&options_of), "Raises TypeError for an unknown field.")
      .def_property(
          "workers", [](const SlamOptions& options) { return options.workers; },
          [](SlamOptions& options, Workers workers) { options.workers = workers; }, "Threads of mapping.")
      .def_readwrite("refine_calibration", &SlamOptions::refine_calibration,
                     "Whether to refine the calibration from the images.")
      .def_readwrite("map_online", &SlamOptions::map_online,
                     "Whether a mission maps; False: localises on the offline map only.")
      .def_readwrite("max_pair_difference", &SlamOptions::max_pair_difference,
                     "Largest time difference between left and right or depth image, seconds.")
      .def_readwrite("max_gap", &SlamOptions::max_gap,
                     "Largest time difference between frames without InputFault.after_gap, seconds.")
      .def_readwrite("pictures", &SlamOptions::pictures,
                     "Whether keyframes of a new or extended map keep a small grey picture.")
      .def_readwrite("max_features", &SlamOptions::max_features, "Features per frame.")
      .def_readwrite("image_threads", &SlamOptions::image_threads,
                     "Threads for the images of a frame; no effect on poses.")
      .def_readwrite("max_waiting", &SlamOptions::max_waiting, "Frames of submit() that wait for its thread.")
      .def_readwrite("baseline", &SlamOptions::baseline,
                     "Baseline of a stereo pair, metres; replaces that of the calibration. Required to confirm one "
                     "outside 2 mm to 1 m.")
      .def_readwrite("recording", &SlamOptions::recording, "Name of this session in a saved map.")
      .def_readwrite("site", &SlamOptions::site, "Place where the map was made, stored in it unless empty.")
      .def_readwrite("vocabulary", &SlamOptions::vocabulary, "Vocabulary file; None: the installed one.")
      .def_property(
          "plan",
          [](const SlamOptions& options) {
            return options.plan ? std::optional(options.plan->plan.name) : std::nullopt;
          },
          [](SlamOptions& options, const std::optional<std::filesystem::path>& file) {
            options.plan = file ? std::optional(read_drawn_floor_plan(*file)) : std::nullopt;
          },
          "Floor plan on which the mission's map is registered; places behind its walls are rejected. Takes the path "
          "of the plan, returns its name; None: no walls. Raises InputError for an unreadable plan.")
      .def_property(
          "extrinsics", [](const SlamOptions& options) { return options.extrinsics; },
          [](SlamOptions& options, const std::optional<Extrinsics>& extrinsics) { options.extrinsics = extrinsics; },
          "How camera and IMU are mounted on the robot's base. With it wheels yield poses from the first "
          "frame on, and one camera makes a map in metres. The camera's is required. None: taken from the "
          "map, or estimated while driving.")
      .def_readwrite(
          "tags", &SlamOptions::tags,
          "AprilTags on the robot's way, whose poses the map stores, see read_tags. One camera makes a map "
          "in metres by the sizes of two or more. Missions detect the tags of their map without this option.")
      .def_property("settings", &settings_of, &set_settings,
                    "Options of docs/reference/options.md, as dict of name and value. They override the fields above.");
}

using SlamClass = py::class_<Slam, std::unique_ptr<Slam, ReleasingDelete>>;

// Every call releases the GIL, because it may wait for a callback of submit(), which takes the GIL.
using Released = py::call_guard<py::gil_scoped_release>;

template <typename Getter>
py::cpp_function released(const Getter& getter) {
  return py::cpp_function(getter, Released());
}

void bind_making(SlamClass& type) {
  type.def_static(
          "mapping", &Slam::mapping, py::arg("calibration"), py::arg("options") = SlamOptions{}, Released(),
          "Makes a new map. One camera without depth has an arbitrary scale, and poses are those of the camera. Raises "
          "InputError for an invalid calibration, vocabulary or setting.\n"
          ">>> byre.Slam.mapping(recording.calibration).process(images)\n"
          "<FrameReport ...>")
      .def_static(
          "extending", &Slam::extending, py::arg("calibration"), py::arg("map"), py::arg("options") = SlamOptions{},
          Released(),
          "Continues a saved map: relocalises in it first, then adds to it. Raises InputError as mapping(), and if the "
          "map cannot be loaded.\n"
          ">>> byre.Slam.extending(recording.calibration, path).keyframes > 0\n"
          "True")
      .def_static(
          "on_map",
          [](const Calibration& calibration, const std::filesystem::path& map, const SlamOptions& options) {
            if (!is_site_file(map)) return Slam::on_map(calibration, map, options);
            Site site = read_site(map);
            for (SiteMap& one : site.maps) {
              if (one.plan) one.drawn_plan = read_drawn_floor_plan(*one.plan);
            }
            return Slam::on_site(calibration, site, options);
          },
          py::arg("calibration"), py::arg("map"), py::arg("options") = SlamOptions{}, Released(),
          "Mission on an offline map, which is not modified, or on a site file. Poses are in the frame of the map, "
          "on a site of FrameReport.map, with verdicts. Raises InputError as mapping(), and if a map cannot be "
          "loaded.\n"
          ">>> byre.Slam.on_map(recording.calibration, path).process(images)\n"
          "<FrameReport ...>");
}

void bind_input(SlamClass& type) {
  type.def("process", &process_images, py::arg("images"), py::arg("last_from_body") = py::none(),
           "Tracks the next frame, with images of a Recording. last_from_body: measured motion of the body since the "
           "previous call, 4x4, metres; None: wheel and gyroscope samples are used, if any. Raises InputError if it is "
           "not a rigid motion.\n"
           ">>> slam = byre.Slam.mapping(recording.calibration)\n"
           ">>> slam.process(images).health.verdict\n"
           "<Verdict...>")
      .def("process", &process, py::arg("time_ns"), py::arg("left"), py::arg("right") = py::none(),
           py::arg("depth") = py::none(), py::arg("last_from_body") = py::none(), py::arg("format") = py::none(),
           py::arg("bits") = 16, py::arg("right_time_ns") = py::none(), py::arg("depth_time_ns") = py::none(),
           "Tracks the next frame. Arrays are borrowed for the call; rows may be padded.\n"
           "time_ns: middle of the exposure, nanoseconds, by any monotonic clock.\n"
           "left, right: uint8, height x width; uint16, height x width, with bits significant bits; or uint8, height x "
           "width x 3.\n"
           "depth: height x width, uint16 in units of DepthCamera.units_per_metre, or float32 in metres; zero is "
           "invalid.\n"
           "last_from_body: measured motion of the body since the previous call, 4x4, metres. Ignored while the scale "
           "is unknown.\n"
           "format: order of colours, bgr8 by default.\n"
           "right_time_ns, depth_time_ns: default time_ns.\n"
           "Raises TypeError for other arrays, ValueError for pixels that are not contiguous, and InputError if "
           "last_from_body is not a rigid motion. Faults of the frame are reported in FrameReport.input.")
      .def("submit", &submit_images, py::arg("images"), py::arg("on_report") = py::none(),
           py::arg("last_from_body") = py::none(),
           "Queues the next frame for process() on a thread of this Slam, and returns at once. on_report is called on "
           "that thread with the FrameReport, once for each frame, in order. If more than SlamOptions.max_waiting "
           "frames wait, the oldest is not processed but reported with InputFault.replaced: the newest wins. finish() "
           "processes waiting frames first. The first exception of a frame or of on_report is raised by the next "
           "submit(), process() or finish().\n"
           ">>> live = byre.Slam.mapping(recording.calibration)\n"
           ">>> reports = []\n"
           ">>> for images in recording:\n"
           "...     live.submit(images, reports.append)\n"
           ">>> live.frames == len(reports) == len(recording)\n"
           "True")
      .def("submit", &submit, py::arg("time_ns"), py::arg("left"), py::arg("right") = py::none(),
           py::arg("depth") = py::none(), py::arg("on_report") = py::none(), py::arg("last_from_body") = py::none(),
           py::arg("format") = py::none(), py::arg("bits") = 16, py::arg("right_time_ns") = py::none(),
           py::arg("depth_time_ns") = py::none(), "Same with arrays as for process(), which are copied.")
      .def(
          "add_wheel_odometry",
          [](Slam& slam, std::int64_t time_ns, const Eigen::Matrix4d& odometry_from_base) {
            slam.add_wheel_odometry({Timestamp(time_ns), pose_of(odometry_from_base, "odometry_from_base")});
          },
          py::arg("time_ns"), py::arg("odometry_from_base"), Released(),
          "Adds wheel odometry at any rate: pose of the base in a drifting odometry frame, 4x4, metres. Samples are in "
          "order of time, by the clock of the images, and precede the frame that they lead to. Raises InputError if "
          "the matrix is not a rigid motion.\n"
          ">>> slam = byre.Slam.mapping(recording.calibration)\n"
          ">>> slam.add_wheel_odometry(0, np.eye(4))")
      .def(
          "add_wheel_velocity",
          [](Slam& slam, std::int64_t time_ns, double vx, double vy, double wz) {
            slam.add_wheel_odometry(BaseTwist{Timestamp(time_ns), vx, vy, wz});
          },
          py::arg("time_ns"), py::arg("vx"), py::arg("vy"), py::arg("wz"), Released(),
          "Adds wheel odometry as velocity of the base in its own axes, x ahead, y left: vx and vy in metres per "
          "second, wz in radians per second, positive to the left. Give either poses or velocities.\n"
          ">>> slam = byre.Slam.mapping(recording.calibration)\n"
          ">>> slam.add_wheel_velocity(0, vx=0.5, vy=0.0, wz=0.1)")
      .def(
          "add_gyro",
          [](Slam& slam, std::int64_t time_ns, const Eigen::Vector3d& rate) {
            slam.add_gyro({Timestamp(time_ns), rate});
          },
          py::arg("time_ns"), py::arg("rate"), Released(),
          "Adds a gyroscope sample: rate about its axes, radians per second. Order and clock as for wheels. Bias and "
          "rotation to the body are estimated.\n"
          ">>> byre.Slam.mapping(recording.calibration).add_gyro(0, [0.0, 0.0, 0.1])")
      .def(
          "add_accel",
          [](Slam& slam, std::int64_t time_ns, const Eigen::Vector3d& acceleration) {
            slam.add_accel({Timestamp(time_ns), acceleration});
          },
          py::arg("time_ns"), py::arg("acceleration"), Released(),
          "Adds an accelerometer sample: specific force along the axes of the gyroscope, m/s^2. Order and clock as for "
          "wheels. Only used at standstill, as the direction of gravity.\n"
          ">>> byre.Slam.mapping(recording.calibration).add_accel(0, [0.0, 0.0, 9.81])")
      .def(
          "set_initial_pose",
          [](Slam& slam, const Eigen::Matrix4d& map_from_body, double radius, double turn, double seconds) {
            slam.set_initial_pose({pose_of(map_from_body, "map_from_body"), radius, turn, seconds});
          },
          py::arg("map_from_body"), py::arg("radius") = 2.0, py::arg("turn") = 1.0, py::arg("seconds") = 10.0,
          Released(),
          "Limits relocalisation to the surroundings of a pose. Does not affect tracking. Replaces an earlier hint. "
          "Only for on_map().\n"
          "radius: largest position error, metres; turn: largest rotation error, radians.\n"
          "seconds: lifetime from the next frame on, seconds of frame time.\n"
          "Raises InputError if map_from_body is not a rigid motion.\n"
          ">>> mission = byre.Slam.on_map(recording.calibration, path)\n"
          ">>> mission.set_initial_pose(np.eye(4), radius=3.0)")
      .def("pause_mapping", &Slam::pause_mapping, py::arg("is_paused"), Released(),
           "While paused, frames are tracked, but the map is neither initialised nor extended.\n"
           ">>> slam = byre.Slam.mapping(recording.calibration)\n"
           ">>> slam.pause_mapping(True)\n"
           ">>> slam.is_mapping_paused\n"
           "True")
      .def_property_readonly("is_mapping_paused", released(&Slam::is_mapping_paused), "Whether mapping is paused.");
}

void bind_results(SlamClass& type) {
  type.def("finish", &finish,
           "Waits for mapping jobs, closes remaining loops and adjusts the whole map; takes seconds to minutes. Later "
           "frames are dropped. Ctrl-C stops it and keeps the steps done.\n"
           ">>> mapped.finish()")
      .def("save", &Slam::save, py::arg("path"), Released(),
           "Writes the map, for a mission the online map. Replaces the file atomically. Raises InputError if nothing "
           "was mapped yet, or if the file cannot be written, exists and is no map, or is the mission's offline map.\n"
           ">>> mapped.save(\"room.byre\")")
      .def("save_session", &Slam::save_session, py::arg("path"), Released(),
           "Writes what a mission learned about its offline map, without images, for \"byre update\". Raises "
           "InputError as save(), and without an offline map.\n"
           ">>> mission.save_session(\"room.session\")")
      .def("trajectory", &Slam::trajectory, Released(),
           "map_from_body of all tracked frames, with all corrections so far. Gaps are filled by wheel odometry.\n"
           ">>> len(mapped.trajectory()) > 0\n"
           "True")
      .def(
          "plan_from_body",
          [](const Slam& slam, const Eigen::Matrix4d& map_from_body) {
            return matrix_of(slam.plan_from_body(pose_of(map_from_body, "map_from_body")));
          },
          py::arg("map_from_body"), Released(),
          "Pose on the floor plan of a pose in the map, 4x4, metres; None if the map is not registered on a plan. "
          "Raises InputError if map_from_body is not a rigid motion.\n"
          ">>> mission.plan_from_body(np.eye(4)) is None\n"
          "True")
      .def(
          "plan_covariance",
          [](const Slam& slam, const Eigen::Matrix4d& map_from_body, const Matrix6& covariance) {
            return slam.plan_covariance(pose_of(map_from_body, "map_from_body"), covariance);
          },
          py::arg("map_from_body"), py::arg("covariance"), Released(),
          "Covariance of plan_from_body(), 6x6 as FrameReport.covariance: the given covariance in the map plus that of "
          "the registration. None if the map is not registered on a plan.\n"
          ">>> mission.plan_covariance(np.eye(4), np.eye(6)) is None\n"
          "True")
      .def_property_readonly("calibration", released(&Slam::calibration), "Calibration with all refinements so far.")
      .def_property_readonly("is_metric", released(&Slam::is_metric), "Whether lengths are metres.")
      .def_property_readonly("map_damage", released(&Slam::map_damage),
                             "Damage of the offline map's file: file, section, reason and remedy; None if undamaged.")
      .def_property_readonly("keyframes", released(&Slam::keyframes),
                             "Keyframes of the map being made; without the offline map of a mission.")
      .def_property_readonly("points", released(&Slam::points),
                             "Points of the map being made; without the offline map of a mission.")
      .def_property_readonly("motion_warnings",
                             released([](const Slam& slam) { return texts_of(slam.motion_warnings()); }),
                             "Faults of wheels, gyroscope, accelerometer and AprilTags so far, as text.")
      .def_property_readonly("frames", released(py::overload_cast<>(&Slam::frames, py::const_)),
                             "Number of frames, including dropped ones.")
      .def("frames_with", py::overload_cast<InputFault>(&Slam::frames, py::const_), py::arg("fault"), Released(),
           "Number of frames with this fault.\n"
           ">>> mapped.frames_with(byre.InputFault.after_gap)\n"
           "0");
}

void bind_slam_itself(py::module_& module) {
  SlamClass slam(
      module, "Slam",
      "Visual SLAM of one robot: images in, poses out. Calls from several threads take effect one at a time, in their "
      "order. All release the interpreter lock.");
  bind_making(slam);
  bind_input(slam);
  bind_results(slam);
}

}  // namespace

void bind_slam(py::module_& module) {
  process_before_exit();
  bind_reports(module);
  bind_advice(module);
  bind_options(module);
  bind_slam_itself(module);
}

}  // namespace byre::python
