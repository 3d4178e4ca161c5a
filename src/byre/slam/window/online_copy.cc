#include "byre/slam/window/online_copy.h"

#include "byre/slam/tracking/measurement.h"

#include <utility>

namespace byre {
namespace {

void make_online(Sighting& sighting, const Features& features, int feature) {
  if (sighting.point) {
    sighting.point = PointId{Origin::online, sighting.point->number};
  } else {
    sighting = {std::nullopt, features.keypoint(feature).pixel, reference_sigma(features, feature)};
  }
}

}  // namespace

MapGraph online_copy(const MapGraph& offline) {
  MapParts parts{offline.rigs(), {}, {}};
  for (const KeyframeId id : offline.keyframe_ids()) {
    Keyframe keyframe = *offline.find_keyframe(id);
    for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
      make_online(keyframe.sightings[i], *keyframe.frame.features, static_cast<int>(i));
    }
    if (keyframe.parent) keyframe.parent->origin = Origin::online;
    parts.keyframes.push_back(std::move(keyframe));
  }
  for (const PointId id : offline.point_ids()) {
    MapPoint point = *offline.find_point(id);
    point.reference.keyframe.origin = Origin::online;
    parts.points.push_back(point);
  }
  return MapGraph(Origin::online, std::move(parts));
}

}  // namespace byre
