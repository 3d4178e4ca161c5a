#pragma once

#include "byre/body_motion.h"
#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/floor_plan.h"
#include "byre/frame_report.h"
#include "byre/image.h"
#include "byre/input_error.h"
#include "byre/motion_warning.h"
#include "byre/pose.h"
#include "byre/pose_hint.h"
#include "byre/rig.h"
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

// Where mapping is worked out beside tracking.
//   live        on threads of their own, taken over when it is ready: for robots
//   repeatable  on threads of their own, taken over after a fixed number of frames: the same images give the same poses
//   none        in process(), which then takes as long as mapping does
enum class Workers : std::uint8_t { live, repeatable, none };

struct SlamOptions {
  Workers workers = Workers::live;
  bool refine_calibration = true;      // whether the calibration is refined by what is seen
  bool map_online = true;              // whether a mission maps; false: it tracks on the kept map alone
  double max_pair_difference = 0.005;  // seconds between left image and right or depth image
  double max_gap = 1.0;                // seconds between frames, until one is told to come after a gap
  int max_features = 1000;             // most features a frame
  int image_threads = 2;               // threads that work on the images of a frame; poses do not depend on them
  // Baseline of a stereo pair in metres, replaces that of the calibration. A calibration with a baseline outside 2 mm
  // to 1 m is refused unless it is confirmed here, as extrinsics in centimetres or millimetres are likelier.
  std::optional<double> baseline{};
  std::string recording = "live";                     // name of the frames in a kept map
  std::string site;                                   // place where the map was made, noted in it unless empty
  std::optional<std::filesystem::path> vocabulary{};  // empty: the one that comes with byre
  // Options of docs/options.md, by name, and their values, as text. They win over the fields above.
  std::vector<std::pair<std::string, std::string>> settings{};
  // The floor plan that the map of a mission lies on (read_drawn_floor_plan): where it says what a wall is, the robot
  // is not taken to be behind one. Empty: walls are not known.
  std::optional<DrawnFloorPlan> plan{};
};

// One robot's SLAM: images in, poses out. Call it from one thread; mapping has threads of its own.
// Making one throws InputError: a calibration that makes no sense or cannot be rectified, a map or a vocabulary that
// cannot be loaded, settings that are none.
// Later, whatever is wrong with a frame is told in its report.
class Slam {
 public:
  // Maps what is seen. Without right and depth camera lengths have no unit, and poses are those of the camera.
  static Slam mapping(const Calibration& calibration, const SlamOptions& options = {});

  // Goes on with a kept map: finds itself in it first, and what it maps becomes part of it.
  static Slam extending(const Calibration& calibration, const std::filesystem::path& map,
                        const SlamOptions& options = {});

  // A mission on a kept map, which stays as it is: poses are in its frame, with verdicts.
  static Slam on_map(const Calibration& calibration, const std::filesystem::path& map, const SlamOptions& options = {});

  Slam(Slam&&) noexcept;
  Slam& operator=(Slam&&) noexcept;
  ~Slam();

  // Tracks the next frame. The images are borrowed for the time of the call.
  // told: how the body has moved since the frame handed over before, in metres. It takes the place of the guess that
  // the body moves on as it did. Where nothing is recognised the pose goes on by it, with a covariance that grows, and
  // is caught again by the map. Of no use where lengths are no metres, and left alone there. Empty: what wheels and a
  // gyroscope told, if they did.
  FrameReport process(const CameraImages& images, const std::optional<BodyMotion>& told = {});

  // Tracks the next frame by features of one's own, in pixels of rig().
  FrameReport process(const Frame& frame, const std::optional<BodyMotion>& told = {});

  // What wheels tell, at any rate: the pose of the robot's base in a frame of their own, which drifts; metres. In order
  // of time, by the clock of the images, before the frames that it leads to; what comes up to a fifth of a second late
  // is made up for. How the camera is mounted on the base, how late wheels stamp and, with one camera, how long the
  // map's unit is, byre finds out while the robot drives and turns; until then it presumes it, with errors to match.
  // Where wheels slip they are left out. What one camera maps has metres by them once it is finished.
  void tell_wheels(const StampedPose& odometry_from_base);
  // The same by wheels that tell how fast the base moves, and no poses. No motion is made up where none was told for
  // three tenths of a second. One robot's wheels tell the one or the other.
  void tell_wheels(const BaseVelocity& velocity);
  // What a gyroscope tells, likewise. Its bias and how it is turned against the body are found out.
  void tell_gyroscope(const AngularRate& rate);
  // What an accelerometer of the same part tells, about the same axes, likewise. It tells which way is up while the
  // robot stands still, and nothing else.
  void tell_accelerometer(const Acceleration& acceleration);
  // How gyroscope and accelerometer are turned against the left camera, where somebody has calibrated it: to a degree
  // or two. Before anything is told; found out otherwise.
  void tell_gyroscope_mounting(const Eigen::Quaterniond& left_from_gyroscope);

  // Where the robot is, as somebody says: of use where places look alike, such as the two ends of a barn. While a
  // mission finds itself from nothing it looks in the kept map there alone, for the hint's seconds; then everywhere
  // again. What is tracked goes on as it is. The last hint counts. No other task has a use for it.
  void look_near(const PoseHint& hint);

  // While it is paused nothing is added to the map, and frames are tracked on what there is: where the robot stands
  // among cows, or the way is known. No map begins meanwhile.
  void pause_mapping(bool is_paused);
  bool is_mapping_paused() const;

  // Damage of the file of a mission's map: file, section, reason and remedy; empty without damage. A mission reads its
  // map as it drives. After damage it continues on the parts read before, untrusted; save() works.
  std::optional<std::string> map_damage() const;

  // Waits for mapping, closes the last loops and adjusts the map as a whole, which takes seconds to minutes.
  // should_stop is asked before and between the steps; then the map stays as far as it was adjusted. Frames that come
  // later are dropped.
  void finish(const std::function<bool()>& should_stop = {});

  // Writes the map, with or without finish() before; of a mission, the online map. Replaces the file as a whole. Blocks
  // tracking for some milliseconds per keyframe. Throws InputError if the file cannot be written, is there and is no
  // map, or is the map of the mission, and if nothing was mapped yet.
  void save(const std::filesystem::path& path) const;

  // Every frame that had a pose, as the map has it now. Where wheels lead on from these poses, or back to the frames
  // before the first one, frames without a pose have one here as well.
  Trajectory trajectory() const;

  // Where a pose in the map lies on the floor plan that the map is registered on; empty when it is on none.
  std::optional<Pose> plan_from_body(const Pose& map_from_body) const;
  // How well it is known there: as FrameReport::covariance, which is that of the pose in the map, with what the
  // registration leaves open. Empty when the map is on no plan.
  std::optional<Matrix6> plan_covariance(const Pose& map_from_body, const Matrix6& covariance) const;

  const Rig& rig() const;           // the ideal camera that features are given in
  Calibration calibration() const;  // calibration as it is known by now
  bool is_metric() const;           // whether lengths are metres; see tell_wheels
  // Keyframes and points of the map that is made, with those of a map that it goes on with; not of the map that a
  // mission is on.
  int keyframes() const;
  int points() const;
  std::vector<Eigen::Vector3d> point_positions() const;  // places of these points, in the frame of map_from_body
  // Faults of motion inputs so far, each kind once. FrameReport::warnings holds the new ones of each frame.
  const std::vector<MotionWarning>& motion_warnings() const;
  int frames() const;                  // all frames handed over
  int frames(InputFault fault) const;  // frames handed over with that fault

 private:
  struct Parts;
  explicit Slam(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace byre
