#pragma once

#include "byre/body_motion.h"
#include "byre/calibration.h"
#include "byre/extrinsics.h"
#include "byre/features.h"
#include "byre/floor_plan.h"
#include "byre/frame_report.h"
#include "byre/image.h"
#include "byre/input_error.h"
#include "byre/motion_warning.h"
#include "byre/pose.h"
#include "byre/pose_hint.h"
#include "byre/rig.h"
#include "byre/tag.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

struct Site;
class SlamImpl;

// Threads of mapping.
//   live        worker threads; results are applied when ready: for robots
//   repeatable  worker threads; results are applied after a fixed number of frames: equal images yield equal poses
//   none        no threads; process() includes the time of mapping
enum class Workers : std::uint8_t { live, repeatable, none };

struct SlamOptions {
  Workers workers = Workers::live;
  bool refine_calibration = true;      // whether to refine the calibration from the images
  bool map_online = true;              // whether a mission maps; false: localises on the offline map only
  double max_pair_difference = 0.005;  // largest time difference between left and right or depth image, seconds
  double max_gap = 1.0;                // largest time difference between frames without InputFault::after_gap, seconds
  bool pictures = true;                // whether keyframes of a new or extended map keep a small grey picture
  int max_features = 1000;             // features per frame
  int image_threads = 2;               // threads for the images of a frame; no effect on poses
  int max_waiting = 1;                 // frames of submit() that wait for its thread
  // Baseline of a stereo pair in metres; replaces that of the calibration. A calibrated baseline outside 2 mm to 1 m is
  // rejected unless confirmed here, as extrinsics in centimetres or millimetres are likelier.
  std::optional<double> baseline{};
  std::string recording = "live";                     // name of this session in a saved map
  std::string site;                                   // place where the map was made, stored in it unless empty
  std::optional<std::filesystem::path> vocabulary{};  // empty: the vocabulary installed with byre
  // Options of docs/reference/options.md as pairs of name and value. They override the fields above.
  std::vector<std::pair<std::string, std::string>> settings{};
  // Floor plan on which the mission's map is registered (read_drawn_floor_plan). Places behind its walls are rejected.
  // Empty: no walls.
  std::optional<DrawnFloorPlan> plan{};
  // How camera and IMU are mounted on the robot's base. With it wheels yield poses from their second sample on, and
  // one camera begins its map in metres. Empty: taken from the map, or estimated while driving. The camera's is
  // required.
  std::optional<Extrinsics> extrinsics{};
  // AprilTags on the robot's way (read_tags), whose poses the map stores. One camera makes a map in metres by the sizes
  // of two or more. Missions detect the tags of their map without this option, as evidence for a place.
  std::vector<Tag> tags{};
};

// Called with the report of a frame. May call the Slam, and destroy it.
using ReportCallback = std::function<void(const FrameReport&)>;

// Visual SLAM of one robot: images in, poses out. Construction throws InputError for a calibration that is invalid or
// cannot be rectified, a map or a vocabulary that cannot be loaded, and invalid settings. Faults of frames are reported
// in FrameReport::input. Calls from several threads take effect one at a time, in their order: those that return a
// result, save() and finish() wait for frames submitted before; after the first submit() the others return at once.
class Slam {
 public:
  // Makes a new map. One camera without depth has an arbitrary scale until extrinsics, wheels or tags determine it, and
  // poses are those of the camera.
  static Slam mapping(const Calibration& calibration, const SlamOptions& options = {});

  // Continues a saved map: relocalises in it first, then adds to it.
  static Slam extending(const Calibration& calibration, const std::filesystem::path& map,
                        const SlamOptions& options = {});

  // Mission on an offline map, which is not modified. Poses are in its frame, with verdicts.
  static Slam on_map(const Calibration& calibration, const std::filesystem::path& map, const SlamOptions& options = {});
  // Mission on the maps of a site. Begins on any of them and changes between them; poses are in the frame of
  // FrameReport::map. Sessions and saved maps are of the active map.
  static Slam on_site(const Calibration& calibration, const Site& site, const SlamOptions& options = {});

  Slam(Slam&&) noexcept;
  Slam& operator=(Slam&&) noexcept;
  ~Slam();

  // Tracks the next frame. The images are borrowed for the duration of the call.
  // body_motion: measured motion of the body since the previous call, metres. It replaces the constant-velocity
  // prediction, and bridges frames without recognised points, with growing covariance. Ignored while the scale is
  // unknown. Empty: wheel and gyroscope samples are used, if any.
  FrameReport process(const CameraImages& images, const std::optional<BodyMotion>& body_motion = {});

  // Tracks the next frame with the caller's features, in pixels of rig().
  FrameReport process(const Frame& frame, const std::optional<BodyMotion>& body_motion = {});

  // Queues the next frame for process() on a thread of this Slam, and returns at once. on_report is called on that
  // thread, once for each frame, in order. If more than SlamOptions::max_waiting frames wait, the oldest is not
  // processed but reported with InputFault::replaced: the newest wins. finish() processes waiting frames first;
  // destruction discards them without a report. The first exception of a frame or of on_report is rethrown by the next
  // submit(), process() or finish(). images: taken over; move them to avoid a copy.
  void submit(ImageFrame images, ReportCallback on_report = {}, const std::optional<BodyMotion>& body_motion = {});
  // Copies the images.
  void submit(const CameraImages& images, ReportCallback on_report = {},
              const std::optional<BodyMotion>& body_motion = {});

  // Wheel odometry at any rate: pose of the base in a drifting odometry frame, metres. Samples are in order of time, by
  // the clock of the images, and precede the frame that they lead to; delays up to 0.2 s are bridged. Driving and
  // turning determine the mounting of the camera on the base, the offset of the stamps (0.2 s at most) and, for one
  // camera, the metric scale; until then defaults with a larger covariance are used. Wheel slip is rejected. finish()
  // scales a monocular map to metres.
  void add_wheel_odometry(const StampedPose& odometry_from_base);
  // Wheel odometry as velocities. Motion is not interpolated across gaps of more than 0.3 s. Give either poses or
  // velocities.
  void add_wheel_odometry(const BaseTwist& velocity);
  // Gyroscope sample; order and clock as for wheels. Its bias and its rotation to the body are estimated.
  void add_gyro(const AngularRate& rate);
  // Sample of the accelerometer on the gyroscope's axes; order and clock as for wheels. Only used at standstill, as the
  // direction of gravity.
  void add_accel(const Acceleration& acceleration);
  // Calibrated rotation from gyroscope and accelerometer to the left camera, accurate to one or two degrees. Call it
  // before the first sample. Without it the rotation is estimated.
  void set_gyro_extrinsics(const Eigen::Quaterniond& left_from_gyroscope);

  // Limits relocalisation to the surroundings of a pose for the hint's lifetime, for buildings with similar-looking
  // places. Does not affect tracking. Replaces an earlier hint. Invalid poses are ignored. Only for missions.
  void set_initial_pose(const PoseHint& hint);

  // While paused, frames are tracked, but the map is neither initialised nor extended, for example among cows.
  void pause_mapping(bool is_paused);
  bool is_mapping_paused() const;

  // Damage of the offline map's file: file, section, reason and remedy; empty if undamaged. A mission reads its map
  // while driving. After damage it continues, untrusted, on the parts already read; save() works.
  std::optional<std::string> map_damage() const;

  // Waits for mapping jobs, closes remaining loops and adjusts the whole map; takes seconds to minutes. should_stop is
  // called before and between steps; the map keeps the steps done. Later frames are dropped as after_finishing.
  void finish(const std::function<bool()>& should_stop = {});

  // Writes the map, before or after finish(); for a mission the online map. Replaces the file atomically. Blocks the
  // calling thread for some milliseconds per keyframe. Throws InputError if nothing was mapped yet, if the file cannot
  // be written, exists and is no map, or is the mission's offline map.
  void save(const std::filesystem::path& path) const;

  // Writes what a mission learned about its offline map, without images, for "byre update": the online map, sightings
  // and misses of the offline map's points, poses with verdicts. Throws InputError like save(), and without an offline
  // map.
  void save_session(const std::filesystem::path& path) const;

  // map_from_body of all tracked frames, with all corrections so far; on a site each in its FrameReport::map. Gaps,
  // also before the first pose, are filled by wheel odometry.
  Trajectory trajectory() const;

  // Pose on the floor plan of a pose in the map; empty if the map is not registered on a plan.
  std::optional<Pose> plan_from_body(const Pose& map_from_body) const;
  // Covariance of plan_from_body() as in FrameReport::covariance: the given covariance in the map plus that of the
  // registration. Empty if the map is not registered on a plan.
  std::optional<Matrix6> plan_covariance(const Pose& map_from_body, const Matrix6& covariance) const;

  // Rectified camera, in whose pixels features are given.
  const Rig& rig() const;
  // Calibration with all refinements so far.
  Calibration calibration() const;
  // Whether lengths are metres.
  bool is_metric() const;
  // Size of the map being made, including a map that it extends; without the offline map of a mission.
  int keyframes() const;
  int points() const;
  // Positions of these points, in the frame of map_from_body.
  std::vector<Eigen::Vector3d> point_positions() const;
  // Their grey values in the same order, 0 to 255; empty for a point whose patch was not kept.
  std::vector<std::optional<std::uint8_t>> point_greys() const;
  // Faults of motion inputs, each kind once, and of tags so far. FrameReport::warnings holds those new in a frame.
  std::vector<MotionWarning> motion_warnings() const;
  int frames() const;                  // all frames, including dropped ones
  int frames(InputFault fault) const;  // frames with this fault

  // Internals for the programs of byre; their type is not public.
  SlamImpl& impl() { return *impl_; }
  const SlamImpl& impl() const { return *impl_; }

 private:
  explicit Slam(std::unique_ptr<SlamImpl> impl);
  std::unique_ptr<SlamImpl> impl_;
};

}  // namespace byre
