#include "byre/slam/tracking/deferred_refinement.h"

#include "byre/slam/tracking/tracking_steps.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

constexpr double kMinShareAgreeing = 0.7;  // share of the points still in the map that must agree on the pose

DeferredPoint remember(const TrackedFeature& seen, const Keypoint& keypoint) {
  return {seen.point,
          {seen.pixel.x(), seen.pixel.y(), keypoint.disparity},
          seen.pixel_sigma,
          keypoint.has_disparity() ? keypoint.disparity_sigma : -1.0f};
}

PoseObservation observation_of(const DeferredPoint& seen, const MapPoint& point, const AdjustedOffline& offline,
                               double offline_weight) {
  PoseObservation observation =
      pose_observation(point, seen.measured.cast<double>(), seen.pixel_sigma, seen.disparity_sigma);
  const auto adjusted = offline.points_in_world.find(seen.point);
  if (adjusted != offline.points_in_world.end()) {
    observation.point_in_world = adjusted->second;
  } else if (seen.point.origin == Origin::offline) {
    observation.weight = offline_weight;
  }
  return observation;
}

}  // namespace

bool is_held_by_offline(const DeferredFrame& frame) {
  const auto offline =
      std::ranges::count(frame.points, Origin::offline, [](const DeferredPoint& seen) { return seen.point.origin; });
  return 2 * offline > std::ssize(frame.points);
}

void DeferredRefinement::note(std::size_t number, const Rig& rig, const Features& features,
                              const TrackedFrame& tracked) {
  constexpr std::size_t kBlock = std::size_t{1} << 16U;  // points, 2 MB
  constexpr std::size_t kFrames = 512;
  if (frames_.capacity() == 0) frames_.reserve(kFrames);
  if (blocks_.empty() || blocks_.back().size() + tracked.features.size() > blocks_.back().capacity()) {
    blocks_.emplace_back().reserve(std::max(kBlock, tracked.features.size()));
  }
  std::vector<DeferredPoint>& points = blocks_.back();
  const std::size_t begin = points.size();
  for (const TrackedFeature& seen : tracked.features) {
    points.push_back(remember(seen, features.keypoint(seen.feature)));
  }
  frames_.push_back({{number, rig, Pose{}, {}}, first_block_ + blocks_.size() - 1, begin, points.size()});
}

void DeferredRefinement::rotate_rig(const Pose& after_from_before) {
  for (Kept& kept : frames_) kept.frame.now_from_then = after_from_before * kept.frame.now_from_then;
}

void DeferredRefinement::forget_from(std::size_t number) {
  while (frames_.size() > taken_ && frames_.back().frame.number >= number) frames_.pop_back();
}

std::optional<std::size_t> DeferredRefinement::first() const {
  return frames_.size() == taken_ ? std::nullopt : std::optional(frames_[taken_].frame.number);
}

std::optional<DeferredFrame> DeferredRefinement::take_overdue() {
  return frames_.size() - taken_ > options_.frames ? take_oldest() : std::nullopt;
}

std::optional<DeferredFrame> DeferredRefinement::take_oldest() {
  if (frames_.size() == taken_) return std::nullopt;
  const Kept& oldest = frames_[taken_++];
  for (; first_block_ < oldest.block; ++first_block_) blocks_.pop_front();
  const std::vector<DeferredPoint>& points = blocks_.front();
  DeferredFrame frame = oldest.frame;
  frame.points.assign(points.begin() + static_cast<std::ptrdiff_t>(oldest.begin),
                      points.begin() + static_cast<std::ptrdiff_t>(oldest.end));
  if (2 * taken_ > frames_.size()) {
    frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(std::exchange(taken_, 0)));
  }
  return frame;
}

std::optional<Pose> refine_deferred_pose(const DeferredFrame& frame, const Pose& camera_from_world, const MapView& map,
                                         const TrackOptions& tracking, const AdjustedOffline& offline) {
  std::vector<PoseObservation> observations;
  observations.reserve(frame.points.size());
  for (const DeferredPoint& seen : frame.points) {
    if (const MapPoint* const point = map.find_point(seen.point)) {
      observations.push_back(observation_of(seen, *point, offline, tracking.offline_weight));
    }
  }
  const double needed = kMinShareAgreeing * static_cast<double>(observations.size());
  PoseRefinementOptions refinement;
  refinement.rounds = 2;  // the initial pose is nearly right
  const auto refined =
      refine_pose(inverse(frame.now_from_then) * camera_from_world, frame.rig, observations, refinement);
  if (!refined || refined->inlier_count < std::max(needed, static_cast<double>(tracking.min_inliers)))
    return std::nullopt;
  return frame.now_from_then * refined->camera_from_world;
}

}  // namespace byre
