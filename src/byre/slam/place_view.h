#pragma once

#include "byre/slam/hidden_cells.h"
#include "byre/slam/offline_map.h"
#include "byre/slam/tracking.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace byre {

// Offline points of one cell of the map that should be in view, and those of them that are.
struct CellInView {
  std::array<int, 3> cell{};  // its index along x, y and z, see MapCells
  int expected = 0;
  int seen = 0;  // inliers whose very patch was found, not just a similar corner
  Eigen::Vector3d centre_of_seen = Eigen::Vector3d::Zero();  // metres, in the map
};

// What a frame shows of the offline map from a pose.
struct PlaceView {
  // Keyframes have looked at the map from about there: what they saw should be in view, unless it is covered, moved or
  // lit otherwise. Elsewhere all points in the frustum are expected, though walls may hide them.
  bool is_near_keyframe = false;
  ReusedVector<CellInView> cells;  // ascending
};

// Keyframes that looked at the map from about a pose, ascending, and the points that they saw, ascending.
ReusedVector<KeyframeId> keyframes_of_place(const OfflineMap& offline, const Pose& camera_from_world);
ReusedVector<PointId> points_of_place(const OfflineMap& offline, std::span<const KeyframeId> keyframes);

struct PlaceViewQuery {
  const OfflineMap& offline;
  const Rig& rig;
  const Frame& frame;
  const TrackedFrame& tracked;                 // its camera_from_world is the pose, in the offline map's frame
  std::span<const PointId> nearby;             // points_of_place of the pose
  std::span<const PointId> candidates;         // offline points around, where those are too few
  HiddenCells hidden{};                        // where no points are expected
  std::function<bool(PointId)> is_left_out{};  // points not expected anywhere; empty: none
};

PlaceView view_of_place(const PlaceViewQuery& query);

}  // namespace byre
