#pragma once

#include "byre/map/driven_ground.h"
#include "byre/map/map_file.h"
#include "byre/map/plan_walls.h"
#include "byre/motion/known_mounting.h"
#include "byre/place/place_index.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace byre {

// The walls of the floor plan that a map lies on.
struct PlacedWalls {
  PlanRegistration registration;
  PlanWalls walls;
};

// Walls opened along the map's own path, which cannot lead through one. Empty where a tenth of that path would lie
// deep inside: then the plan, or the registration, is of something else.
std::optional<PlacedWalls> place_walls(const Map& map, const PlanRegistration& registration, PlanWalls walls);

// A kept map as missions use it. Never changed once made, so that any number of sessions and threads may share it.
class OfflineMap {
 public:
  // Preconditions: the map is an offline one and holds keyframes; those have words of the vocabulary, see add_words.
  OfflineMap(Map map, const Vocabulary& vocabulary, std::vector<SourceRecording> recordings = {},
             std::optional<PlacedWalls> walls = {}, const KnownMounting& mounting = {});

  const Map& map() const { return map_; }
  const PlaceIndex& places() const { return places_; }

  const std::vector<SourceRecording>& recordings() const { return recordings_; }  // what the map was made from

  const KnownMounting& mounting() const { return mounting_; }  // mounting of what told the motion then

  // What it was driven on; nullptr where it was not driven.
  const DrivenGround* ground() const { return ground_ ? &*ground_ : nullptr; }
  // The walls around; nullptr where none are known.
  const PlacedWalls* walls() const { return walls_ ? &*walls_ : nullptr; }

  // How exactly its frame is known where a keyframe stands: what a keyframe's pose is uncertain by relative to the
  // others on the whole, the median of them. The same in all directions.
  const Matrix6& frame_covariance() const { return frame_covariance_; }

  // Keyframes near a camera that look in a similar direction, nearest first. Nearness is distance in metres, and a
  // metre for each radian between the directions.
  ReusedVector<KeyframeId> keyframes_near(const Pose& camera_from_world, double max_distance, int max_count) const;
  // Metres from a camera to the nearest keyframe, whatever the directions.
  double distance_to_keyframes(const Eigen::Vector3d& camera_in_world) const;

 private:
  Map map_;
  PlaceIndex places_;
  std::vector<SourceRecording> recordings_;
  struct View {
    KeyframeId keyframe;
    Eigen::Vector3d camera_in_world;
    Eigen::Vector3d viewing_direction;  // unit length, in world
  };
  std::vector<View> views_;
  Matrix6 frame_covariance_ = Matrix6::Zero();
  std::optional<DrivenGround> ground_;
  std::optional<PlacedWalls> walls_;
  KnownMounting mounting_;
};

}  // namespace byre
