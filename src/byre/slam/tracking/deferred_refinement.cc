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

PoseObservation observation_of(const DeferredPoint& seen, const MapPoint& point, double offline_weight) {
  PoseObservation observation =
      pose_observation(point, seen.measured.cast<double>(), seen.pixel_sigma, seen.disparity_sigma);
  if (seen.point.origin == Origin::offline) observation.weight = offline_weight;
  return observation;
}

}  // namespace

void DeferredRefinement::note(std::size_t number, const Rig& rig, const Features& features,
                              const TrackedFrame& tracked) {
  const auto offline = std::ranges::count(tracked.features, Origin::offline,
                                          [](const TrackedFeature& seen) { return seen.point.origin; });
  if (2 * static_cast<std::size_t>(offline) > tracked.features.size()) return;
  DeferredFrame frame;
  frame.number = number;
  frame.rig = rig;
  frame.points.reserve(tracked.features.size());
  for (const TrackedFeature& seen : tracked.features) {
    frame.points.push_back(remember(seen, features.keypoint(seen.feature)));
  }
  frames_.push_back(std::move(frame));
}

void DeferredRefinement::rotate_rig(const Pose& after_from_before) {
  for (DeferredFrame& frame : frames_) frame.now_from_then = after_from_before * frame.now_from_then;
}

void DeferredRefinement::forget_from(std::size_t number) {
  while (!frames_.empty() && frames_.back().number >= number) frames_.pop_back();
}

std::optional<std::size_t> DeferredRefinement::first() const {
  return frames_.empty() ? std::nullopt : std::optional(frames_.front().number);
}

std::optional<DeferredFrame> DeferredRefinement::take_overdue() {
  return frames_.size() > options_.frames ? take_oldest() : std::nullopt;
}

std::optional<DeferredFrame> DeferredRefinement::take_oldest() {
  if (frames_.empty()) return std::nullopt;
  DeferredFrame oldest = std::move(frames_.front());
  frames_.pop_front();
  return oldest;
}

std::optional<Pose> refine_deferred_pose(const DeferredFrame& frame, const Pose& camera_from_world, const MapView& map,
                                         const TrackOptions& tracking) {
  std::vector<PoseObservation> observations;
  observations.reserve(frame.points.size());
  for (const DeferredPoint& seen : frame.points) {
    if (const MapPoint* const point = map.find_point(seen.point)) {
      observations.push_back(observation_of(seen, *point, tracking.offline_weight));
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
