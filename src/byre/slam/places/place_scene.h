#pragma once

// A mapped simulated room and its vocabulary, for tests of place recognition.

#include "byre/geometry/tag_pose.h"
#include "byre/place/place_index.h"
#include "byre/slam/places/offline_map.h"
#include "byre/slam/tracking/mission_scene.h"

#include <memory>
#include <utility>
#include <vector>

namespace byre {

inline Vocabulary vocabulary_of(const SimulatedMission& mission) {
  std::vector<std::vector<Descriptor>> images;
  for (std::size_t i = 0; i < mission.frames.size(); i += 5)
    images.push_back(to_vector(mission.frames[i].features->descriptors()));
  return Vocabulary::train(images, {.branching = 8, .depth = 3, .rounds = 5, .seed = 1});
}

// True map of a mission; every fifth frame is a keyframe.
struct MappedPlace {
  explicit MappedPlace(const SimulatedMission& mission)
      : map(true_map(mission, 5, Origin::offline)), index(vocabulary_of(mission)) {
    for (const KeyframeId id : map.keyframe_ids()) {
      map.set_words(id, index.vocabulary().words_of(*map.find_keyframe(id)->frame.features));
      index.add(id, map.find_keyframe(id)->words);
    }
  }

  MapView view() const { return map; }

  MapGraph map;
  PlaceIndex index;
};

// Map of two equal rooms, 10 m apart; each frame fits both.
inline MappedPlace twin_rooms(const SimulatedMission& mission) {
  MappedPlace place(mission);
  const MapGraph once = place.map;
  const Eigen::Vector3d shift(10.0, 0.0, 0.0);
  std::vector<KeyframeId> copied;
  for (const KeyframeId id : once.keyframe_ids()) {
    Keyframe keyframe = *once.find_keyframe(id);
    keyframe.camera_from_world = keyframe.camera_from_world * Pose{Eigen::Quaterniond::Identity(), -shift};
    for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
    copied.push_back(place.map.add_keyframe(keyframe));
    place.index.add(copied.back(), keyframe.words);
  }
  for (const PointId id : once.point_ids()) {
    MapPoint point = *once.find_point(id);
    point.position_in_world += shift;
    point.reference.keyframe = copied[point.reference.keyframe.number];
    const PointId copy = place.map.add_point(point);
    for (const Observation& seen : once.observations(id)) {
      Sighting sighting = once.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)];
      sighting.point = copy;
      place.map.add_observation({copied[seen.keyframe.number], seen.feature}, sighting);
    }
  }
  return place;
}

// Tag that faces the camera of a frame from two metres.
inline MappedTag tag_before(const Pose& camera_from_world, int number = 7) {
  MappedTag tag{{TagFamily::tag36h11, number}, 0.25, {}, 0.001};
  tag.map_from_tag = inverse(camera_from_world) * Pose{rotation_exp({0.0, 0.5, 0.0}), {0.2, -0.2, 2.0}};
  return tag;
}

// The frame, with the corners of a tag if it is in view.
inline Frame with_tag(Frame frame, const MappedTag& tag, const Pose& camera_from_world, const Rig& rig) {
  TagSighting seen{tag.id, {}};
  const auto in_tag = tag_corners(tag.size);
  for (std::size_t i = 0; i < in_tag.size(); ++i) {
    const Eigen::Vector3d in_camera = camera_from_world * tag.map_from_tag * in_tag[i];
    if (in_camera.z() < 0.3) return frame;
    seen.corners[i] = rig.project(in_camera).head<2>();
    if (!rig.contains(seen.corners[i])) return frame;
  }
  frame.tags.push_back(seen);
  return frame;
}

// Vocabulary of a lap in a simulated room.
inline const Vocabulary& simulated_vocabulary() {
  static const Vocabulary trained =
      vocabulary_of(simulate_mission(simulated_rig(), circling_trajectory(120, 10.0, 2.0, 1.0), {}));
  return trained;
}

// True map of an earlier visit; every fourth frame is a keyframe.
inline std::shared_ptr<const OfflineMap> offline_map_of(const SimulatedMission& visit) {
  MapGraph map = true_map(visit, 4, Origin::offline);
  for (const KeyframeId id : map.keyframe_ids()) {
    map.set_words(id, simulated_vocabulary().words_of(*map.find_keyframe(id)->frame.features));
  }
  return std::make_shared<const OfflineMap>(std::move(map), simulated_vocabulary());
}

}  // namespace byre
