#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>

namespace byre {
namespace {

// A point matched with a feature of a keyframe.
struct Meeting {
  int point = 0;
  WindowObservation seen;
};

int find_keyframe(const MapWindow& window, KeyframeId id) {
  const auto found = std::ranges::find(window.keyframes, id, &WindowKeyframe::id);
  return found == window.keyframes.end() ? -1 : static_cast<int>(found - window.keyframes.begin());
}

bool sees(const WindowPoint& point, int keyframe) {
  return std::ranges::any_of(point.observations,
                             [&](const WindowObservation& observation) { return observation.keyframe == keyframe; });
}

std::vector<int> points_seen_by(const MapWindow& window, const std::vector<int>& keyframes) {
  std::vector<int> points;
  for (const int keyframe : keyframes) {
    for (const int point : window.keyframe(keyframe).point_of_feature) {
      if (point >= 0) points.push_back(point);
    }
  }
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::vector<Meeting> look_for(const MapWindow& window, const std::vector<int>& points, int keyframe,
                              const MappingOptions& options) {
  const SearchOptions search{options.search_radius, 50, 0.9f};
  const CameraView view = view_of(window, keyframe);
  const Eigen::Vector3d camera_in_world = inverse(view.camera_from_world).translation;
  std::vector<Meeting> meetings;
  for (const int index : points) {
    const WindowPoint& point = window.point(index);
    if (sees(point, keyframe)) continue;
    const auto projection = project_point(point.point, view.camera_from_world, camera_in_world, view.rig);
    if (!projection) continue;
    const auto found = find_feature(view.features, point.point.descriptor, *projection, search);
    if (found) meetings.push_back({index, {keyframe, found->feature}});
  }
  return meetings;
}

bool is_offline(const MapWindow& window, const WindowObservation& seen) {
  return is_offline(window.keyframe(seen.keyframe));
}

// The point to keep of two duplicates: an offline one, else the one with more observations, else the older.
int better_point(const MapWindow& window, int a, int b) {
  const WindowPoint& first = window.point(a);
  const WindowPoint& second = window.point(b);
  if (is_offline(first) != is_offline(second)) return is_offline(first) ? a : b;
  const auto count = [](const WindowPoint& point) {
    return static_cast<int>(point.observations.size()) + point.observations_elsewhere;
  };
  if (count(first) != count(second)) return count(first) > count(second) ? a : b;
  return std::min(a, b);
}

// Measures the observations of the removed point relative to the reference of the kept one: two corners of one spot may
// be a pixel apart. An offline keyframe never gets another offline point.
void fuse(MapWindow& window, int removed, int kept) {
  const std::vector<WindowObservation> observations = window.point(removed).observations;
  const bool kept_is_offline = is_offline(window.point(kept));
  remove_point(window, removed);
  for (const WindowObservation& observation : observations) {
    if (kept_is_offline && is_offline(window, observation)) continue;
    if (sees(window.point(kept), observation.keyframe)) continue;
    add_observation(window, kept, observation,
                    measure_in_window(window, kept, observation.keyframe, observation.feature));
  }
}

void merge(MapWindow& window, const Meeting& meeting) {
  const WindowPoint& point = window.point(meeting.point);
  if (point.removed || sees(point, meeting.seen.keyframe)) return;
  const int other =
      window.keyframe(meeting.seen.keyframe).point_of_feature[static_cast<std::size_t>(meeting.seen.feature)];
  if (other == kPointElsewhere) return;
  if (other == kNoPoint) {
    if (is_offline(point) && is_offline(window, meeting.seen)) return;
    add_observation(window, meeting.point, meeting.seen,
                    measure_in_window(window, meeting.point, meeting.seen.keyframe, meeting.seen.feature));
    return;
  }
  const int kept = better_point(window, meeting.point, other);
  const int removed = kept == other ? meeting.point : other;
  if (!is_offline(window.point(removed))) fuse(window, removed, kept);
}

}  // namespace

Sighting measure_in_window(const MapWindow& window, int point, int keyframe, int feature) {
  const MapPoint& value = window.point(point).point;
  const CameraView current = view_of(window, keyframe);
  PixelMeasurement measured = corner_measurement(current.features.keypoint(feature));
  const int reference = find_keyframe(window, value.reference.keyframe);
  if (reference >= 0) {
    const CameraView view = view_of(window, reference);
    const Sighting& sighting =
        window.keyframe(reference).keyframe.sightings[static_cast<std::size_t>(value.reference.feature)];
    measured =
        measure_pixel({view, value.reference.feature, sighting.pixel}, value.position_in_world, current, feature);
  }
  return {window.point(point).id, measured.pixel, measured.sigma};
}

void fuse_duplicates(MapWindow& window, int keyframe, const MappingOptions& options) {
  fuse_between(window, keyframe, nearest_neighbours(window, keyframe, options.fusion_neighbours, kOfflineNeighbours),
               options);
}

void fuse_between(MapWindow& window, int keyframe, const std::vector<int>& neighbours, const MappingOptions& options) {
  for (const Meeting& meeting : look_for(window, points_seen_by(window, neighbours), keyframe, options)) {
    merge(window, meeting);
  }
  const std::vector<int> own_points = points_seen_by(window, {keyframe});
  for (const int neighbour : neighbours) {
    for (const Meeting& meeting : look_for(window, own_points, neighbour, options)) merge(window, meeting);
  }
}

}  // namespace byre
