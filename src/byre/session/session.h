#pragma once

#include "byre/features/features.h"
#include "byre/map/map_view.h"
#include "byre/session/executor.h"
#include "byre/slam/keyframes.h"
#include "byre/slam/mapping.h"
#include "byre/slam/state.h"
#include "byre/slam/tracking.h"

#include <memory>
#include <optional>
#include <vector>

namespace byre {

struct SessionOptions {
  int min_initial_points = 100;  // stereo points of the first keyframe
  int local_keyframes = 15;      // whose points are looked for in a frame
  double min_kept_share = 0.5;   // of the last frame's inliers; fewer, and the pose is sought without prediction too
  TrackOptions track;
  KeyframeOptions keyframes;
  MappingOptions mapping;
};

// What the caller learns about one frame.
struct FrameReport {
  Timestamp time{};
  State state = State::initialising;
  std::optional<Pose> world_from_body;   // empty while there is none
  Matrix6 covariance = Matrix6::Zero();  // of delta in world_from_body * exp_pose(delta), relative to the map's origin
  int features = 0;
  int expected_points = 0;  // map points in the frustum
  int matches = 0;
  int inliers = 0;
  bool keyframe_added = false;
  double track_seconds = 0.0;         // wall time on the calling thread
  double map_seconds = 0.0;           // of it for mapping: windows, deltas, new points, inline jobs
  std::optional<double> job_seconds;  // wall time of the mapping job whose result was taken over in this frame
};

// The one stateful object: give it frames in order of time. Call every method from one thread; only the executor has
// another.
class Session {
 public:
  Session(const Rig& rig, const SessionOptions& options, std::unique_ptr<Executor> executor);

  FrameReport process(const Frame& frame);

  // Takes over what mapping still has to give. Call it once, after the last frame.
  void finish();

  MapView map() const { return {nullptr, online_}; }

  // Every frame that had a pose, recomputed from its keyframe as that one lies now. world_from_body.
  Trajectory final_trajectory() const;

 private:
  // Where a frame lay relative to a keyframe, so that it moves along when mapping moves that one.
  struct AnchoredPose {
    Timestamp time{};
    KeyframeId keyframe;
    Pose camera_from_keyframe;
  };

  bool initialise(const Frame& frame);
  void take_over(const FinishedJob& job);
  void start_job();
  std::optional<TrackedFrame> find_pose(const Frame& frame) const;
  Pose predict(Timestamp time) const;
  Pose last_camera_from_world() const;
  KeyframeEvidence keyframe_evidence(const TrackedFrame& tracked) const;
  void add_keyframe(const Frame& frame, const TrackedFrame& tracked);
  void remember(const Frame& frame, const TrackedFrame& tracked);
  FrameReport report_of(const Frame& frame, const std::optional<TrackedFrame>& tracked) const;

  // Constant after construction.
  Rig rig_;
  SessionOptions options_;

  // Owned by the calling thread.
  std::unique_ptr<Executor> executor_;
  Map online_{Origin::online};
  State state_ = State::initialising;
  std::optional<KeyframeId> last_keyframe_;
  int frames_since_keyframe_ = 0;
  int last_inliers_ = 0;                // in the last frame tracked
  int fresh_inliers_ = 0;               // in the first frame tracked after the last keyframe
  std::vector<KeyframeId> pending_;     // keyframes mapping has not worked on
  std::vector<AnchoredPose> anchored_;  // one per frame with a pose
  Vector6 velocity_ = Vector6::Zero();  // of the camera, per second: exp_pose(velocity * dt) * last_camera_from_world
};

}  // namespace byre
