#pragma once

#include "byre/pose_hint.h"
#include "byre/slam/localisation/mission.h"
#include "byre/slam/localisation/place_bounds.h"
#include "byre/slam/mapping/mapper.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/session/session_options.h"
#include "byre/slam/tracking/motion_model.h"

#include <optional>
#include <vector>

namespace byre {

// Whether a find has so few of the expected points as inliers that it is a look-alike place, such as the other end of a
// barn. For maps of the same drive, in which nothing changes: the right place has a larger share.
bool is_like_another_place(const TrackedFrame& found);

// Track of a frame on one map alone.
HybridTrack found_in(Origin origin, TrackedFrame found);

// Localises frames by prediction or by place recognition. Reads the maps; changes only its own state from frame to
// frame. Called from the session's thread.
class Tracker {
 public:
  explicit Tracker(const SessionOptions& options) : options_(options) {}

  // Maps and constraints for a frame.
  struct Scene {
    const Rig& rig;
    const Mapper& mapper;
    const Mission* mission = nullptr;              // nullptr without an offline map
    bool compare_focal_lengths = false;            // see FocalCheck
    std::optional<PoseHint> hint{};                // limits localisation in the offline map
    bool is_place_accepted = false;                // limits the pose from offline points
    std::optional<PlaceBounds::Reach> reach{};     // motion since the last trusted pose
    double online_sigma = HybridLimits::kNoLimit;  // see HybridLimits
    const DrivenGround* ground = nullptr;          // ground that constrains the body; nullptr: none
    bool is_pressed = false;                       // few online points are matched, see FrameCuts
    ImageMask hidden{};                            // image cells without expected points
  };
  // Tracks from the pose predicted from the last one. Precondition: the map has a submap.
  std::optional<HybridTrack> track(const Frame& frame, const Scene& scene, const AnchoredPose& last,
                                   const MotionModel& motion);
  struct Find {
    // Places that show the frame, most inliers first. Online or offline by their references; several only offline.
    std::vector<HybridTrack> places;
    DistrustReason refused = DistrustReason::none;  // why a place that shows the frame was rejected
    std::optional<FocalEvidence> focal;             // see Localisation
  };
  // Localises in all of the maps, the offline one first, separate submaps last. is_in_map: not in separate submaps.
  Find find(const Frame& frame, const Scene& scene, bool is_in_map = false) const;
  // Whether a tracked pose does not meet the criteria of localisation.
  bool is_doubtful(const HybridTrack& track, const Scene& scene) const;

  // Makes the track the reference of the next frame.
  void note(const HybridTrack& track);
  // The frame has become a keyframe.
  void restart_from(KeyframeId newest) { reference_ = newest; }
  // Offline points around the last prediction, suspended points included.
  const ScratchVector<PointId>& offline_points() const { return offline_.points; }

 private:
  // Points around a keyframe, cached until the keyframe or the map changes.
  struct PointsAround {
    std::optional<KeyframeId> keyframe;
    int revision = 0;  // revision of the map
    ScratchVector<PointId> points;
  };

  bool is_usable(const std::optional<KeyframeId>& reference, const Mapper& mapper) const;
  const ScratchVector<PointId>& points_around_reference(const Mapper& mapper);
  const ScratchVector<PointId>& online_points(const Scene& scene);
  const ScratchVector<PointId>& offline_points_around(const Pose& predicted, const Mission& mission);
  std::optional<HybridTrack> track_from(const Frame& frame, const Scene& scene, const Pose& predicted,
                                        const HybridLimits& limits);

  SessionOptions options_;  // constant after construction

  std::optional<KeyframeId> reference_;  // online keyframe whose points are matched
  int last_inliers_ = 0;                 // inliers of the last tracked frame
  PointsAround online_;
  PointsAround offline_;
  ScratchVector<PointId> few_;         // online points matched if time is short
  ScratchVector<PointId> candidates_;  // buffer
};

}  // namespace byre
