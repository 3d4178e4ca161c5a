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

Agreement Mission::drift() const {
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

std::optional<Pose> Mission::test_registrations(
    std::span<const RegistrationEvidence> places,
    const std::function<PlaceHypothesis(const Pose& offline_from_online)>& begin) {
  constexpr double kMostApart = 0.01;  // share of the median depth, and radians
  for (Registration& registration : registrations_) ++registration.misses;
  for (const RegistrationEvidence& seen : places) {
    const auto agrees = [&](const Registration& before) {
      const Eigen::Vector3d& camera = seen.camera_in_online;
      return (before.offline_from_online * camera - seen.offline_from_online * camera).norm() <=
                 kMostApart * seen.median_depth &&
             angle_between(before.offline_from_online.rotation, seen.offline_from_online.rotation) <= kMostApart;
    };
    auto registration = std::ranges::find_if(registrations_, agrees);
    if (registration == registrations_.end()) {
      registrations_.push_back({seen.offline_from_online, begin(seen.offline_from_online)});
      registration = std::prev(registrations_.end());
    }
    registration->misses = 0;
    registration->offline_from_online = seen.offline_from_online;
    registration->place.observe(seen.view, true);
  }
  std::erase_if(registrations_, [this](const Registration& registration) {
    return registration.misses > options_.registration.max_misses;
  });
  const Registration* likeliest = nullptr;
  for (const Registration& registration : registrations_) {
    const PlaceHypothesis& place = registration.place;
    if (!place.is_confirmed() || (!place.is_accepted() && place.log_odds() < 0.0)) continue;
    if (likeliest == nullptr || place.log_odds() > likeliest->place.log_odds()) likeliest = &registration;
  }
  if (likeliest == nullptr) return std::nullopt;
  const Pose registered = likeliest->offline_from_online;
  forget_registrations();
  return registered;
}

}  // namespace byre
