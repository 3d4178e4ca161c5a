#pragma once

#include "byre/frame_cuts.h"
#include "byre/health.h"
#include "byre/motion_warning.h"
#include "byre/pose.h"
#include "byre/session_event.h"
#include "byre/state.h"
#include "byre/tag.h"
#include "byre/trajectory.h"
#include "byre/two_view_failure.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Fault of the input of a frame. Frames with a fault from no_image on are dropped without processing.
enum class InputFault : std::uint8_t {
  none,
  after_gap,       // more than SlamOptions::max_gap after the previous frame; tracking may have been lost
  missing_right,   // no right image for a stereo pair
  late_right,      // right image ignored: its time differs by more than max_pair_difference
  missing_depth,   // no depth image for a depth camera
  late_depth,      // depth image ignored: its time differs by more than max_pair_difference
  no_image,        // left image without data
  wrong_size,      // image size differs from the calibration, or the stride is shorter than a row
  wrong_format,    // depth format for a grey or colour image, or vice versa
  wrong_features,  // caller's features: outside the image, invalid octave, or disparity without sigma
  repeated_time,   // time equal to that of the previous frame
  out_of_order,    // earlier than the previous frame
  replaced,        // not processed, as newer frames were submitted (Slam::submit)
  after_finishing  // after Slam::finish
};

std::string_view to_string(InputFault fault);

inline bool is_dropped(InputFault fault) {
  return fault >= InputFault::no_image;
}

// Result of one frame. A dropped frame has no pose.
struct FrameReport {
  Timestamp time{};
  State state = State::initialising;
  InputFault input = InputFault::none;
  // Pose in the frame of the offline map; without one in the frame of the session's own map. Corrected as the map is
  // refined, so it may jump. Empty while the pose is unknown.
  std::optional<Pose> map_from_body;
  std::string map;  // name in the site of the map that map_from_body refers to; empty without a site
  // Covariance of delta in map_from_body * exp_pose(delta), relative to the map's origin.
  Matrix6 covariance = Matrix6::Zero();
  // Correction of the map since the previous frame, applied to the pose: after_from_before, both in the map frame.
  // Poses of earlier reports are not updated; Slam::trajectory() returns them corrected.
  std::optional<Pose> correction;
  // Smooth odometry: integrates frame-to-frame motion, drifts, never jumps. Its frame is the body's at the start.
  std::optional<Pose> odometry_from_body;
  Matrix6 odometry_covariance = Matrix6::Zero();  // covariance of delta in odometry_from_body * exp_pose(delta)
  Health health;
  int features = 0;         // features detected
  int expected_points = 0;  // map points in the frustum
  int matches = 0;          // map points matched
  int inliers = 0;          // matches that fit the pose
  bool keyframe_added = false;
  FrameCuts cuts;
  bool is_late = false;  // exceeded its deadline despite the cuts
  // Reason for rejecting the place where this or a recent frame was found in the offline map. Repeated in Health::doubt
  // if there is no other pose.
  DistrustReason refused_place = DistrustReason::none;
  TwoViewFailure start_failure = TwoViewFailure::none;  // reason why a monocular map was not initialised
  std::vector<SessionEvent> events;                     // in order
  std::vector<MotionWarning> warnings;                  // faults of motion inputs and tags since the previous frame
  std::vector<MappedTag> moved_tags;  // found moved in this frame, at their places now; ignored from here on
  double track_seconds = 0.0;         // wall time of tracking on the calling thread
  double map_seconds = 0.0;           // wall time of mapping on the calling thread, including inline jobs
  std::optional<double> job_seconds;  // wall time of the mapping job whose result was applied in this frame

  bool has(SessionEvent event) const { return std::ranges::find(events, event) != events.end(); }
};

}  // namespace byre
