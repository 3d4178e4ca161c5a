#pragma once

#include "byre/frame_cuts.h"
#include "byre/health.h"
#include "byre/motion_warning.h"
#include "byre/pose.h"
#include "byre/session_event.h"
#include "byre/state.h"
#include "byre/trajectory.h"
#include "byre/two_view_failure.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace byre {

// What was wrong with a frame as it was handed over. From no_image on it was dropped: nothing was made of it.
enum class InputFault : std::uint8_t {
  none,
  after_gap,       // the frame came long after the one before: the pose may have been lost for it
  missing_right,   // the left image of a stereo pair came alone
  late_right,      // the right image was taken at another time, and left out
  missing_depth,   // the image of a depth camera came without depths
  late_depth,      // the depth image was taken at another time, and left out
  no_image,        // the left image holds nothing
  wrong_size,      // an image is not of the calibration's size, or its rows are shorter than their pixels
  wrong_format,    // a depth image where a picture is to be, or the other way round
  wrong_features,  // own features outside the image, of an octave that does not exist, or a disparity without its sigma
  repeated_time,   // the frame has the time of the one before
  out_of_order,    // the frame has an earlier time than the one before
  after_finishing  // Slam::finish was called before
};

std::string_view to_string(InputFault fault);

inline bool is_dropped(InputFault fault) {
  return fault >= InputFault::no_image;
}

// What the caller learns about one frame.
struct FrameReport {
  Timestamp time{};
  State state = State::initialising;
  InputFault input = InputFault::none;  // fault of the images handed over; a frame that was dropped has no pose
  // In the frame of the offline map, or in that of the session's own map where there is no offline one. Corrected
  // whenever more is known, so it may jump. Empty while it is not known.
  std::optional<Pose> map_from_body;
  // Covariance of delta in map_from_body * exp_pose(delta), relative to the map's origin.
  Matrix6 covariance = Matrix6::Zero();
  // How a correction of the map moved the robot since the frame before: after_from_before, both in the map's frame.
  // Poses kept from earlier frames are as they were: Slam::trajectory has them as they are now.
  std::optional<Pose> correction;
  // Smooth: moves with what was seen from one frame to the next, and never jumps; its frame is the body's at the start.
  std::optional<Pose> odometry_from_body;
  Matrix6 odometry_covariance = Matrix6::Zero();  // covariance of delta in odometry_from_body * exp_pose(delta)
  Health health;
  int features = 0;
  int expected_points = 0;  // map points in the frustum
  int matches = 0;
  int inliers = 0;
  bool keyframe_added = false;
  FrameCuts cuts;        // what was left out
  bool is_late = false;  // it took longer than its deadline all the same
  // Why the robot cannot be where this frame, or one shortly before, was found in the offline map: Health::doubt tells
  // it as well where there is no other pose.
  Doubt refused_place = Doubt::none;
  TwoViewFailure start_failure = TwoViewFailure::none;  // why one camera could not begin a map with this frame
  std::vector<SessionEvent> events;                     // what happened in this frame, in order
  std::vector<MotionWarning> warnings;                  // faults of motion inputs since the last frame; each kind once
  double track_seconds = 0.0;                           // wall time of tracking on the calling thread
  double map_seconds = 0.0;                             // wall time of mapping on the calling thread, with inline jobs
  std::optional<double> job_seconds;  // wall time of the mapping job whose result was taken over in this frame

  bool has(SessionEvent event) const { return std::ranges::find(events, event) != events.end(); }
};

}  // namespace byre
