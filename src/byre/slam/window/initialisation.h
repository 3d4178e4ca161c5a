#pragma once

#include "byre/features/match.h"
#include "byre/geometry/two_view.h"
#include "byre/map/map_graph.h"
#include "byre/slam/window/mapping.h"

#include <optional>
#include <vector>

namespace byre {

struct MonocularStartOptions {
  // Metres, assumed distance from the first camera to the points; the scale is not observable.
  double median_depth = 1.0;
  double lever_arm_sigma = 0.3;        // metres, of the camera on the base that wheels measure
  bool is_scaled_by_odometry = false;  // with measured motion, waits until that determines the scale
};

// First map of one camera: two keyframes and the points that both see. The world is the body at the first keyframe. The
// unit of length is arbitrary, so a metric lever arm of body_from_camera does not apply.
struct MonocularStart {
  MapGraph map;
  KeyframeId first;
  KeyframeId second;  // keyframe of the tried frame
  // Radians, of the translation between both keyframes along its least certain direction.
  double direction_sigma = 0.0;
};

struct MonocularAttempt {
  std::optional<MonocularStart> start;  // empty after a failure
  TwoViewFailure failure = TwoViewFailure::none;
  int matches = 0;  // with the reference frame; 0 without one
};

// Initialises a monocular map: matches frames with a reference frame until the two determine the camera's motion. A
// frame with too few matches becomes the new reference.
class MonocularInitialiser {
 public:
  // Precondition: the rig has no baseline.
  MonocularInitialiser(const Rig& rig, const MonocularStartOptions& options, const MappingOptions& mapping = {});

  // Frames in order of time. After a start the next frame becomes the reference. Poses by odometry leave time for a
  // more accurate start, by the median parallax. measured: camera of the frame from that of the reference, by odometry
  // that determines its direction. The nearest points then suffice, and once the camera stands, less of their parallax.
  MonocularAttempt try_start(const Frame& frame, bool has_odometry = false, const std::optional<Pose>& measured = {});

  // Time of the reference frame; empty before the first.
  std::optional<Timestamp> reference_time() const {
    return reference_ ? std::optional(reference_->time) : std::nullopt;
  }

 private:
  void begin_with(const Frame& frame);
  std::vector<Match> match_with_reference(const Features& features) const;
  void update_expected(const std::vector<Match>& matches, const Features& features);

  // Constant after construction.
  Rig rig_;
  MonocularStartOptions options_;
  MappingOptions mapping_;

  // Owned by the calling thread.
  std::optional<Frame> reference_;
  std::optional<Pose> measured_;  // at the frame before
  // Pixels, one per feature of the reference: its expected position in the next frame.
  std::vector<Eigen::Vector2f> expected_;
};

// Poses of the two cameras of a monocular start in an existing map, measured by wheels. The distance between them gives
// the scale of the start.
struct StartPoses {
  Pose first_camera_from_world;
  Pose second_camera_from_world;
};

// Adds the keyframes and points of a start to a map: the first camera at its measured pose, all lengths scaled by the
// measured motion. parent: of the first keyframe, from which the motion was measured. Returns the two keyframes; empty,
// and nothing is added, if the cameras turned or moved differently than measured.
std::vector<KeyframeId> add_monocular_submap(const MonocularStart& start, const StartPoses& odometry,
                                             const std::optional<KeyframeId>& parent, int recording, MapGraph& map);

// Same without odometry: world and lengths of the start are kept, so the submap has a coordinate frame and a scale of
// its own.
std::vector<KeyframeId> add_separate_submap(const MonocularStart& start, const std::optional<KeyframeId>& parent,
                                            int recording, MapGraph& map);

// Whether the cameras of a start turned and moved in the measured direction.
bool agrees_with_odometry(const MonocularStart& start, const StartPoses& odometry);

// Whether odometry measures length and direction of a camera's motion: the camera moved, and turned so little that the
// error of the lever arm (standard deviation, metres) hardly changes its motion.
bool is_determined(const Pose& measured, double lever_arm_sigma);

// Factor for the lengths of a start by the measured motion. Empty if odometry does not determine that.
std::optional<double> odometry_scale(const MonocularStart& start, const StartPoses& odometry, double lever_arm_sigma);

// Moves a first map so that its second camera is at its measured pose, with lengths multiplied by the scale. The
// mounting of the wheels may be unknown at that time, so the direction of the motion is not used.
MonocularStart align_to_odometry(const MonocularStart& start, const StartPoses& odometry, double scale);

}  // namespace byre
