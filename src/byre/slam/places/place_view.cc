#include "byre/slam/places/place_view.h"

#include "byre/geometry/tag_pose.h"
#include "byre/slam/tracking/tracking_steps.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace byre {
namespace {

ScratchVector<PointId> points_shown(const TrackedFrame& tracked, Origin origin, const Features& features) {
  ScratchVector<PointId> shown;
  for (const TrackedFeature& feature : tracked.features) {
    if (feature.point.origin == origin && shows_patch(feature, features)) shown.push_back(feature.point);
  }
  std::ranges::sort(shown);
  return shown;
}

std::array<int, 3> cell_at(const Eigen::Vector3d& position) {
  constexpr double kSide = 2.0;  // metres
  const Eigen::Vector3d along = (position / kSide).array().max(-1e6).min(1e6).floor();
  return {static_cast<int>(along.x()), static_cast<int>(along.y()), static_cast<int>(along.z())};
}

// Leaves out points of recordings that the frame hardly shows, compared with another one: in another light, corners are
// found elsewhere. A frame at a wrong pose shows little of every recording. shown: ascending.
void leave_out_other_lights(const MapGraph& map, const ScratchVector<PointId>& shown,
                            ScratchVector<ExpectedPoint>& expected) {
  constexpr double kHardly = 0.5;  // relative to the recording of which the largest share is seen
  constexpr double kPrior = 30.0;  // points, seen like the whole, of each recording
  struct Count {
    double expected = 0.0, seen = 0.0;
  };
  ScratchVector<Count> counts;
  const auto count_of = [&](PointId id) -> Count& {
    const auto recording =
        static_cast<std::size_t>(map.keyframe_header(map.find_point(id)->reference.keyframe)->recording);
    if (recording >= counts.size()) counts.resize(recording + 1);
    return counts[recording];
  };
  Count all;
  for (const ExpectedPoint& point : expected) {
    const double seen = std::ranges::binary_search(shown, point.id) ? 1.0 : 0.0;
    for (Count* const count : {&all, &count_of(point.id)}) {
      ++count->expected;
      count->seen += seen;
    }
  }
  if (counts.size() < 2) return;
  const auto share_of = [&](const Count& count) {
    return (count.seen + kPrior * all.seen / all.expected) / (count.expected + kPrior);
  };
  const double largest = share_of(*std::ranges::max_element(counts, {}, share_of));
  std::erase_if(expected, [&](const ExpectedPoint& point) { return share_of(count_of(point.id)) < kHardly * largest; });
}

// Mean distance of a tag's corners from those predicted by the pose, pixels; empty behind the camera.
std::optional<double> corner_error(const TagSighting& seen, const MappedTag& tag, const Pose& camera_from_world,
                                   const Rig& rig) {
  const Pose camera_from_tag = camera_from_world * tag.map_from_tag;
  const auto in_tag = tag_corners(tag.size);
  double sum = 0.0;
  for (std::size_t i = 0; i < in_tag.size(); ++i) {
    const Eigen::Vector3d in_camera = camera_from_tag * in_tag[i];
    if (!(in_camera.z() > 0.0)) return std::nullopt;
    sum += (rig.project(in_camera).head<2>() - seen.corners[i]).norm();
  }
  return sum / static_cast<double>(in_tag.size());
}

}  // namespace

ScratchVector<KeyframeId> keyframes_of_place(const OfflineMap& offline, const Pose& camera_from_world) {
  constexpr double kNear = 1.0;     // metres, plus a metre per radian between viewing directions
  constexpr double kMaxTurn = 0.6;  // radians
  constexpr int kKeyframes = 3;
  ScratchVector<KeyframeId> keyframes = offline.keyframes_near(camera_from_world, kNear, kKeyframes);
  std::erase_if(keyframes, [&](KeyframeId id) {
    const Pose& pose = offline.map().keyframe_header(id)->camera_from_world;
    return angle_between(pose.rotation, camera_from_world.rotation) > kMaxTurn;
  });
  std::ranges::sort(keyframes);
  return keyframes;
}

ScratchVector<PointId> points_of_place(const OfflineMap& offline, std::span<const KeyframeId> keyframes) {
  ScratchVector<PointId> points;
  for (const KeyframeId id : keyframes) {
    for (const Sighting& sighting : offline.map().find_keyframe(id)->sightings) {
      if (sighting.point) points.push_back(*sighting.point);
    }
  }
  std::ranges::sort(points);
  points.erase(std::ranges::unique(points).begin(), points.end());
  return points;
}

PlaceView view_of_place(const PlaceViewQuery& query) {
  constexpr std::size_t kEnough = 60;  // points of nearby keyframes in view
  const MapView map(query.map);
  const Pose& pose = query.tracked.camera_from_world;
  PlaceView view;
  ScratchVector<ExpectedPoint> expected = project_visible(map, query.nearby, pose, query.rig, query.hidden);
  view.is_near_keyframe = expected.size() >= kEnough;
  if (!view.is_near_keyframe) expected = project_visible(map, query.candidates, pose, query.rig, query.hidden);
  ScratchVector<PointId> shown = points_shown(query.tracked, query.map.origin(), *query.frame.features);
  if (view.is_near_keyframe) leave_out_other_lights(query.map, shown, expected);
  const auto position_of = [&](PointId id) -> Eigen::Vector3d {
    return map.find_point(id)->position_in_world / query.metre;
  };
  ScratchVector<std::pair<std::array<int, 3>, PointId>> points;  // by cell
  const auto add = [&](PointId id) {
    if (!query.is_left_out || !query.is_left_out(id)) points.emplace_back(cell_at(position_of(id)), id);
  };
  for (const ExpectedPoint& point : expected) add(point.id);
  for (const PointId id : shown) add(id);
  std::ranges::sort(points);
  points.erase(std::ranges::unique(points).begin(), points.end());
  view.expected.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || points[i].first != points[i - 1].first) view.cells.push_back({points[i].first});
    CellInView& cell = view.cells.back();
    view.expected.push_back(points[i].second);
    const bool is_alone = !query.is_in_common || !query.is_in_common(points[i].second);
    ++cell.expected;
    cell.expected_alone += is_alone;
    if (!std::ranges::binary_search(shown, points[i].second)) continue;
    ++cell.seen;
    cell.seen_alone += is_alone;
    cell.centre_of_seen += (position_of(points[i].second) - cell.centre_of_seen) / cell.seen;
  }
  view.seen = std::move(shown);
  view.tags = tags_in_view(query.frame, pose, query.rig, query.tags);
  return view;
}

// Between the limits of agreement and contradiction the error may be that of the pose or of the tag's own pose.
std::vector<TagInView> tags_in_view(const Frame& frame, const Pose& camera_from_world, const Rig& rig,
                                    std::span<const MappedTag> tags) {
  constexpr double kAgrees = 3.0;       // pixels
  constexpr double kAgreesShare = 0.1;  // share of the tag's side in the image
  constexpr double kContradicts = 2.0;  // limits of agreement
  std::vector<TagInView> in_view;
  for (const TagSighting& seen : frame.tags) {
    const auto tag = std::ranges::find(tags, seen.id, &MappedTag::id);
    if (tag == tags.end()) continue;
    const auto error = corner_error(seen, *tag, camera_from_world, rig);
    const double limit = kAgrees + kAgreesShare * (seen.corners[1] - seen.corners[0]).norm();
    if (error && *error > limit && *error <= kContradicts * limit) continue;
    in_view.push_back({seen.id, error && *error <= limit});
  }
  return in_view;
}

}  // namespace byre
