#include "byre/slam/localisation/mission.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace byre {
namespace {

constexpr double kSearchDistance = 4.0;  // metres around the pose, within which offline keyframes are searched
// Largest offset of a place search from the tracked pose: a constant, plus a share of the path since offline points
// last constrained the pose.
constexpr double kMinDrift = 0.01;       // metres
constexpr double kDriftShare = 0.02;     // metres per metre
constexpr double kMinTurn = 0.005;       // radians
constexpr double kTurnPerMetre = 0.002;  // radians per metre
constexpr int kLookAgainEvery = 5;       // frames between searches for suspended points

}  // namespace

DriftBound Mission::drift() const {
  return {kMinDrift + kDriftShare * distance_since_offline_, kMinTurn + kTurnPerMetre * distance_since_offline_};
}

HybridLimits Mission::limits(bool is_stereo, double seconds) const {
  constexpr double kLeast = 0.3;                 // metres, and radians
  const double drift = is_stereo ? 0.05 : 0.15;  // metres per metre; the scale of one camera drifts as well
  const double reach = options_.registration.max_speed * seconds;  // prediction error, metres
  const double metres = kLeast + drift * distance_since_offline_;
  return {{metres, kLeast + kTurnPerMetre * distance_since_offline_}, metres + reach};
}

std::optional<KeyframeId> Mission::keyframe_near(const Pose& predicted_camera_from_world) const {
  if (reference_) return reference_;
  const auto near = offline_->keyframes_near(predicted_camera_from_world, kSearchDistance, 1);
  return near.empty() ? std::nullopt : std::optional(near.front());
}

void Mission::append_candidates(std::span<const PointId> around, ScratchVector<PointId>& candidates) const {
  reserve_pow2(candidates, candidates.size() + around.size());
  std::ranges::copy_if(around, std::back_inserter(candidates),
                       [this](PointId id) { return !moved_points_.is_suspended(id); });
}

void Mission::note(const HybridTrack& track, Timestamp time, double step, const OfflineEvidence& evidence) {
  view_ = view_of_offline(evidence, options_.view);
  ++frames_;
  const bool held = view_ == OfflineView::held;
  if (held) {
    moved_points_.note(track.offline_agreed,
                       moved_together(offline_->map(), track.offline_agreed, track.offline_moved));
  }
  reference_ = held ? track.offline_reference : std::nullopt;
  if (held && (track.offline_prevails || !track.maps_disagree)) {
    distance_since_offline_ = 0.0;
    last_offline_time_ = time;
  } else {
    distance_since_offline_ += step;
  }
}

ScratchVector<PointId> Mission::due_for_retest(std::span<const PointId> around) const {
  ScratchVector<PointId> due;
  if (moved_points_.count() == 0 || view_ != OfflineView::held || frames_ % kLookAgainEvery != 0) return due;
  std::ranges::copy_if(around, std::back_inserter(due), [this](PointId id) { return moved_points_.is_suspended(id); });
  return due;
}

std::optional<Pose> Mission::test_registration(const RegistrationEvidence& seen, const PlaceHypothesis& begun) {
  constexpr double kMostApart = 0.01;  // share of the median depth, and radians
  if (!registration_) registration_ = {seen.offline_from_online, begun};
  const Pose& before = registration_->offline_from_online;
  const double shift = (before * seen.camera_in_online - seen.offline_from_online * seen.camera_in_online).norm();
  const double turn = angle_between(before.rotation, seen.offline_from_online.rotation);
  if (shift > kMostApart * seen.median_depth || turn > kMostApart) {
    if (++registration_->misses > options_.registration.max_misses) registration_.reset();
    return std::nullopt;
  }
  registration_->offline_from_online = seen.offline_from_online;
  PlaceHypothesis& place = registration_->place;
  place.observe(seen.view, true);
  if (!place.is_confirmed() || (!place.is_accepted() && place.log_odds() < 0.0)) return std::nullopt;
  return std::exchange(registration_, std::nullopt)->offline_from_online;
}

}  // namespace byre
