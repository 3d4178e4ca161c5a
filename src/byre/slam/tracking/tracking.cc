#include "byre/slam/tracking/tracking.h"

#include "byre/features/match.h"
#include "byre/geometry/absolute_pose.h"
#include "byre/slam/tracking/tracking_steps.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <utility>

namespace byre {
namespace {

// Appends the distinct points of one map, ascending, by a bit for each point. Numbers of neighbouring points are close:
// this takes a tenth of the time of sorting.
void append_distinct(Origin origin, std::span<const PointId> points, ScratchVector<PointId>& distinct) {
  std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), last = 0;
  for (const PointId id : points) {
    if (id.origin != origin) continue;
    first = std::min(first, id.number);
    last = std::max(last, id.number);
  }
  if (first > last) return;
  constexpr std::size_t kBits = 64;
  ScratchVector<std::uint64_t> marks(std::size_t{last - first} / kBits + 1, 0);
  for (const PointId id : points) {
    if (id.origin != origin) continue;
    const std::size_t bit = id.number - first;
    marks[bit / kBits] |= std::uint64_t{1} << (bit % kBits);
  }
  for (std::size_t word = 0; word < marks.size(); ++word) {
    for (std::uint64_t left = marks[word]; left != 0; left &= left - 1) {
      const auto bit = word * kBits + static_cast<std::size_t>(std::countr_zero(left));
      distinct.push_back({origin, first + static_cast<std::uint32_t>(bit)});
    }
  }
}

// Distinct points, ascending.
ScratchVector<PointId> distinct(std::span<const PointId> points) {
  ScratchVector<PointId> once;
  once.reserve(points.size());
  append_distinct(Origin::offline, points, once);
  append_distinct(Origin::online, points, once);
  return once;
}

std::optional<TrackedFrame> refine_on_matches(const Frame& frame, const Pose& camera_from_world, const Rig& rig,
                                              const MapView& map, std::span<const PointMatch> matches,
                                              const TrackOptions& options) {
  const MeasuredPoints measured = measure_matches(frame, camera_from_world, rig, map, matches);
  const auto refined = refine_pose(camera_from_world, rig, measured.observations, {});
  if (!refined || !is_sound(*refined, measured.features.size(), options.min_inliers)) return std::nullopt;
  ScratchVector<TrackedFeature> inliers = inliers_of(*refined, measured);
  const KeyframeId reference = most_shared(count_shared_points(map, inliers)).value_or(KeyframeId{});
  TrackedFrame tracked = tracked_frame(*refined, std::move(inliers), reference, map);
  tracked.matches = static_cast<int>(measured.features.size());
  tracked.outliers = outliers_of(*refined, measured);
  return tracked;
}

}  // namespace

std::vector<int> contradicting_features(const TrackedFrame& tracked, const Features& features) {
  std::vector<int> contradicting;
  for (const TrackedFeature& feature : tracked.outliers) {
    if (shows_patch(feature, features)) contradicting.push_back(feature.feature);
  }
  std::ranges::sort(contradicting);
  return contradicting;
}

void append_seen_points(const TrackedFrame& tracked, std::vector<SeenPoint>& seen) {
  reserve_pow2(seen, seen.size() + tracked.features.size() + tracked.outliers.size());
  for (const TrackedFeature& feature : tracked.features) seen.push_back({feature.point, feature.pixel, true});
  for (const TrackedFeature& feature : tracked.outliers) seen.push_back({feature.point, feature.pixel, false});
}

ScratchVector<PointId> local_points(const MapView& map, KeyframeId reference, int max_keyframes) {
  ScratchVector<PointId> points;
  const auto append = [&](KeyframeId id) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe == nullptr) return;
    for (const Sighting& sighting : keyframe->sightings) {
      if (sighting.point) points.push_back(*sighting.point);
    }
  };
  append(reference);
  for (const Covisible& neighbour : map.covisible_keyframes(reference, max_keyframes - 1)) append(neighbour.keyframe);
  return distinct(points);
}

std::optional<TrackedFrame> track(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                  const MapView& map, std::span<const PointId> candidates,
                                  const TrackOptions& options) {
  ScratchVector<ExpectedPoint> expected =
      project_visible(map, candidates, predicted_camera_from_world, rig, options.hidden);
  const auto first = first_pose(frame, predicted_camera_from_world, rig, map, expected, options);
  if (!first) return std::nullopt;

  expected = project_visible(map, candidates, *first, rig, options.hidden);
  const auto matches = match_expected(*frame.features, map, expected, {kNarrowRadius, 90, 0.9f});
  auto tracked = refine_on_matches(frame, *first, rig, map, matches, options);
  if (tracked) tracked->expected = static_cast<int>(expected.size());
  return tracked;
}

std::optional<Pose> pose_from_keyframe(const Frame& frame, const Rig& rig, const MapView& map, KeyframeId id) {
  const Keyframe* const keyframe = map.find_keyframe(id);
  if (keyframe == nullptr) return std::nullopt;
  std::vector<PointSighting> sightings;
  for (const Match& match : match_features(*keyframe->frame.features, *frame.features, {})) {
    const auto& point_id = keyframe->sightings[static_cast<std::size_t>(match.first)].point;
    const MapPoint* const point = point_id ? map.find_point(*point_id) : nullptr;
    if (point == nullptr) continue;
    sightings.push_back({point->position_in_world, frame.features->keypoint(match.second).pixel.cast<double>()});
  }
  constexpr int kMinInliers = 15;
  const auto pose = estimate_absolute_pose(sightings, rig, {});
  if (!pose || pose->inlier_count < kMinInliers) return std::nullopt;
  return pose->camera_from_world;
}

}  // namespace byre
