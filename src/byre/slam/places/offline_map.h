#pragma once

#include "byre/map/map_file.h"
#include "byre/map/mapped_tag.h"
#include "byre/map/plan/driven_ground.h"
#include "byre/map/plan/plan_walls.h"
#include "byre/odometry/odometry_calibration.h"
#include "byre/place/place_index.h"

#include <optional>
#include <vector>

namespace byre {

// Walls of the floor plan on which a map is registered.
struct PlacedWalls {
  PlanRegistration registration;
  PlanWalls walls;
};

// Opens walls along the map's own path, which cannot cross a wall. Empty if a tenth of that path is deep inside walls:
// then the plan, or the registration, is wrong.
std::optional<PlacedWalls> place_walls(const MapGraph& map, const PlanRegistration& registration, PlanWalls walls);

// A saved map for missions. Immutable, so any number of sessions and threads may share it.
class OfflineMap {
 public:
  // Preconditions: the map is offline and has keyframes, with words of the vocabulary (see add_words).
  OfflineMap(MapGraph map, const Vocabulary& vocabulary, std::vector<SourceRecording> recordings = {},
             std::optional<PlacedWalls> walls = {}, const OdometryCalibration& extrinsics = {},
             std::vector<MappedTag> tags = {});

  const MapGraph& map() const { return map_; }
  const PlaceIndex& places() const { return places_; }

  // Recordings that the map was made from.
  const std::vector<SourceRecording>& recordings() const { return recordings_; }

  const OdometryCalibration& extrinsics() const {
    return extrinsics_;
  }  // extrinsics of the motion sensors of these recordings

  const std::vector<MappedTag>& tags() const { return tags_; }  // by id

  // Driven ground; nullptr if the map was not driven.
  const DrivenGround* ground() const { return ground_ ? &*ground_ : nullptr; }
  // Walls of the floor plan; nullptr if not given.
  const PlacedWalls* walls() const { return walls_ ? &*walls_ : nullptr; }

  // Covariance of the map's frame at a keyframe: the median over the keyframes' covariances, isotropic.
  const Matrix6& frame_covariance() const { return frame_covariance_; }

  // Unit of length of cells and of things that may move, metres: 1, or less for a map smaller than a room, such as of a
  // desk. All that such a map holds would otherwise be one thing, which may have moved.
  double cell_unit() const { return cell_unit_; }

  // Keyframes near a camera with a similar viewing direction, nearest first, by the distance in metres plus the angle
  // between the directions in radians.
  ScratchVector<KeyframeId> keyframes_near(const Pose& camera_from_world, double max_distance, int max_count) const;

 private:
  MapGraph map_;
  PlaceIndex places_;
  std::vector<SourceRecording> recordings_;
  struct View {
    KeyframeId keyframe;
    Eigen::Vector3d camera_in_world;
    Eigen::Vector3d viewing_direction;  // unit length, in world
  };
  std::vector<View> views_;
  Matrix6 frame_covariance_ = Matrix6::Zero();
  double cell_unit_ = 1.0;
  std::optional<DrivenGround> ground_;
  std::optional<PlacedWalls> walls_;
  OdometryCalibration extrinsics_;
  std::vector<MappedTag> tags_;
};

}  // namespace byre
