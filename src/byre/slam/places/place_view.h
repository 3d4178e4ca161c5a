#pragma once

#include "byre/slam/places/offline_map.h"
#include "byre/slam/tracking/image_mask.h"
#include "byre/slam/tracking/tracking.h"

#include <array>
#include <functional>
#include <span>

namespace byre {

// Points of one map cell (2 m cube; see PlaceViewQuery::metre) that should be in view, and those of them that are seen.
// Each seen point counts as expected.
struct CellInView {
  std::array<int, 3> cell{};  // index along x, y and z
  int expected = 0;
  int seen = 0;  // inliers with the same image patch, not only a similar corner
  Eigen::Vector3d centre_of_seen = Eigen::Vector3d::Zero();  // in the map, units of PlaceViewQuery::metre
  // Points that no look-alike place has, see PlaceViewQuery.
  int expected_alone = 0;
  int seen_alone = 0;
};

// A tag of the map in a frame, and whether its corners are where the pose predicts them.
struct TagInView {
  TagId id;
  bool agrees = false;
};

// The part of a map that a frame shows from a pose.
struct PlaceView {
  // True: the expected points were seen by keyframes near the pose, so only covering, moving or another light can hide
  // them. False: all points in the frustum are expected, though walls may hide them.
  bool is_near_keyframe = false;
  ScratchVector<CellInView> cells;    // ascending
  ScratchVector<PointId> expected{};  // points of the cells
  ScratchVector<PointId> seen{};      // seen points, ascending
  std::vector<TagInView> tags{};      // detected tags; without those that neither agree nor contradict
};

// Keyframes near a pose with a similar viewing direction, ascending, and the points that they saw, ascending.
ScratchVector<KeyframeId> keyframes_of_place(const OfflineMap& offline, const Pose& camera_from_world);
ScratchVector<PointId> points_of_place(const OfflineMap& offline, std::span<const KeyframeId> keyframes);

struct PlaceViewQuery {
  const MapGraph& map;
  const Rig& rig;
  const Frame& frame;
  const TrackedFrame& tracked;                  // pose and inliers, in the map's frame
  std::span<const PointId> nearby;              // points of keyframes near the pose
  std::span<const PointId> candidates;          // points around the pose, used if nearby ones are too few
  ImageMask hidden{};                           // image cells without expected points
  std::span<const MappedTag> tags{};            // tags of the map
  std::function<bool(PointId)> is_left_out{};   // points that are never expected; empty: none
  std::function<bool(PointId)> is_in_common{};  // points that a look-alike place has as well; empty: none
  double metre = 1.0;                           // one metre of cells in lengths of the map
};

PlaceView view_of_place(const PlaceViewQuery& query);

// Tags of the map in a frame from a pose, see PlaceView::tags.
std::vector<TagInView> tags_in_view(const Frame& frame, const Pose& camera_from_world, const Rig& rig,
                                    std::span<const MappedTag> tags);

}  // namespace byre
