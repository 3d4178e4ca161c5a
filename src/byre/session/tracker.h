#pragma once

#include "byre/localisation/mission.h"
#include "byre/localisation/place_bounds.h"
#include "byre/mapping/mapper.h"
#include "byre/pose_hint.h"
#include "byre/session/session_options.h"
#include "byre/slam/localisation.h"
#include "byre/slam/motion_model.h"

#include <optional>
#include <vector>

namespace byre {

// Whether a frame was found from nothing by so few of the points that should be seen there that it is another place,
// which looks alike, as the two ends of a barn do. For a map of the same drive, in which things look as they did: where
// a frame belongs, a larger share is seen.
bool is_like_another_place(const TrackedFrame& found);

// A frame found in one map alone.
HybridTrack found_in(Origin origin, TrackedFrame found);

// Finds where a frame was taken from: by prediction, or from nothing. Reads the maps, and changes nothing but what it
// keeps from frame to frame. Called from the session's thread.
class Tracker {
 public:
  explicit Tracker(const SessionOptions& options) : options_(options) {}

  // What frames are tracked on.
  struct Scene {
    const Rig& rig;
    const Mapper& mapper;
    const Mission* mission = nullptr;       // on an offline map
    bool weigh_focal_lengths = false;       // see FocalCheck
    std::optional<PoseHint> hint{};         // where alone a frame is looked for in the offline map
    bool is_place_proven = false;           // so offline points cannot put the camera just anywhere
    std::optional<PlaceBounds::Way> way{};  // since the robot was last trusted to be somewhere
    const DrivenGround* ground = nullptr;   // ground that the body is held to; nullptr for none
    bool is_pressed = false;                // few online points are looked for, see FrameCuts
    HiddenCells hidden{};                   // where no points are asked for
  };
  // The last frame that had a pose.
  struct LastPose {
    Timestamp time{};
    Pose camera_from_world;
    KeyframeId keyframe;  // it lay around
  };

  // From where the motion leads. Precondition: the map has a submap.
  std::optional<HybridTrack> track(const Frame& frame, const Scene& scene, const LastPose& last,
                                   const MotionModel& motion);
  struct Find {
    // Places that show the frame, most inliers first. Online or offline by their references; several only offline.
    std::vector<HybridTrack> places;
    Doubt refused = Doubt::none;  // why the robot cannot be where it was found in the offline map
  };
  // Anywhere in the maps, the offline one first.
  Find find(const Frame& frame, const Scene& scene) const;
  // Whether a tracked pose does not bear out what was found from nothing.
  bool is_doubtful(const HybridTrack& track, const Scene& scene) const;

  // That is where the frame was taken from, and where the next one is looked for.
  void note(const HybridTrack& track);
  // The frame has become a keyframe.
  void restart_from(KeyframeId newest) { reference_ = newest; }
  // Offline points around the last prediction, suspended ones included.
  const ReusedVector<PointId>& offline_points() const { return offline_.points; }

 private:
  // Points around a keyframe, kept while that and the map stay: frames come more often than either changes.
  struct PointsAround {
    std::optional<KeyframeId> keyframe;
    int revision = 0;  // revision of the map
    ReusedVector<PointId> points;
  };

  bool is_usable(const std::optional<KeyframeId>& reference, const Mapper& mapper) const;
  const ReusedVector<PointId>& points_around_reference(const Mapper& mapper);
  const ReusedVector<PointId>& online_points(const Scene& scene);
  const ReusedVector<PointId>& offline_points_around(const Pose& predicted, const Mission& mission);
  std::optional<HybridTrack> track_from(const Frame& frame, const Scene& scene, const Pose& predicted,
                                        const HybridLimits& limits);

  SessionOptions options_;  // constant after construction

  std::optional<KeyframeId> reference_;  // online, whose points are looked for
  int last_inliers_ = 0;                 // in the last frame tracked
  PointsAround online_;
  PointsAround offline_;
  ReusedVector<PointId> few_;         // online points looked for where time is short
  ReusedVector<PointId> candidates_;  // memory
};

}  // namespace byre
