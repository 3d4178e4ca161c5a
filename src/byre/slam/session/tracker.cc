#include "byre/slam/session/tracker.h"

#include "byre/slam/localisation/place_search.h"
#include "byre/slam/tracking/planar_prior.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

std::size_t inlier_count(const std::optional<HybridTrack>& track) {
  return track ? track->tracked.features.size() : 0;
}

}  // namespace

HybridTrack found_in(Origin origin, TrackedFrame found) {
  HybridTrack track;
  track.tracked = std::move(found);
  const TrackedFrame& tracked = track.tracked;
  if (origin == Origin::online) {
    track.online_reference = tracked.reference;
    return track;
  }
  track.offline_reference = tracked.reference;
  track.offline_expected = tracked.expected;
  track.offline_matches = tracked.matches;
  track.offline_inliers = static_cast<int>(tracked.features.size());
  track.from_offline = tracked.camera_from_world;
  for (const TrackedFeature& feature : tracked.features) track.offline_agreed.push_back(feature.point);
  return track;
}

bool is_like_another_place(const TrackedFrame& found) {
  constexpr double kLeastShare = 0.1;
  return static_cast<double>(found.features.size()) < kLeastShare * found.expected;
}

// Mapping may have removed the keyframe, but never the newest. A keyframe in the frame of an earlier submap, left after
// a loss, is not usable either.
bool Tracker::is_usable(const std::optional<KeyframeId>& reference, const Mapper& mapper) const {
  return reference && mapper.online().find_keyframe(*reference) != nullptr &&
         mapper.submaps().is_in_present_frame(*reference);
}

const ScratchVector<PointId>& Tracker::points_around_reference(const Mapper& mapper) {
  if (online_.keyframe && online_.keyframe == reference_ && online_.revision == mapper.revision()) {
    return online_.points;
  }
  online_ = {reference_, mapper.revision(), {}};
  if (reference_) online_.points = local_points(mapper.map(), *reference_, options_.local_keyframes);
  std::erase_if(online_.points, [](PointId id) { return id.origin == Origin::offline; });
  return online_.points;
}

const ScratchVector<PointId>& Tracker::offline_points_around(const Pose& predicted, const Mission& mission) {
  const std::optional<KeyframeId> around = mission.keyframe_near(predicted);
  if (around == offline_.keyframe) return offline_.points;
  offline_ = {around, 0, {}};
  if (around) offline_.points = local_points(mission.offline().map(), *around, options_.local_keyframes);
  return offline_.points;
}

// Few online points if time is short; none if offline points constrain the pose.
const ScratchVector<PointId>& Tracker::online_points(const Scene& scene) {
  if (!scene.is_pressed) return points_around_reference(scene.mapper);
  few_.clear();
  const bool is_held = scene.mission && scene.is_place_accepted && scene.mapper.submaps().is_registered() &&
                       scene.mission->view() == OfflineView::held;
  if (is_held || !reference_) return few_;
  constexpr int kFewKeyframes = 4;
  few_ = local_points(scene.mapper.map(), *reference_, std::min(kFewKeyframes, options_.local_keyframes));
  std::erase_if(few_, [](PointId id) { return id.origin == Origin::offline; });
  return few_;
}

std::optional<HybridTrack> Tracker::track_from(const Frame& frame, const Scene& scene, const Pose& predicted,
                                               const HybridLimits& limits) {
  const ScratchVector<PointId>& online = online_points(scene);
  const MapView map = scene.mapper.map();
  TrackOptions options = options_.track;
  options.hidden = scene.hidden;
  if (!scene.mission) {
    auto tracked = byre::track(frame, predicted, scene.rig, map, online, options);
    return tracked ? std::optional(found_in(Origin::online, *std::move(tracked))) : std::nullopt;
  }
  candidates_.clear();
  if (scene.mapper.submaps().is_registered()) {
    scene.mission->append_candidates(offline_points_around(predicted, *scene.mission), candidates_);
  }
  candidates_.insert(candidates_.end(), online.begin(), online.end());
  return track_hybrid(frame, predicted, scene.rig, map, candidates_, options, limits, scene.compare_focal_lengths);
}

std::optional<HybridTrack> Tracker::track(const Frame& frame, const Scene& scene, const AnchoredPose& last,
                                          const MotionModel& motion) {
  const auto newest = scene.mapper.newest_in_present_frame();
  if (!is_usable(reference_, scene.mapper)) reference_ = newest;
  const double seconds = to_seconds(frame.time - last.time);
  const Pose last_camera = camera_from_world(scene.mapper.map(), last);
  const Pose predicted = motion.predict(last_camera, scene.rig, seconds);
  const bool is_limited = scene.mission && scene.is_place_accepted;
  HybridLimits limits = is_limited ? scene.mission->limits(scene.rig.is_stereo(), seconds) : HybridLimits{};
  limits.online_sigma = scene.online_sigma;
  const auto track_around = [&](const Pose& pose) {
    HybridLimits held = limits;
    if (scene.ground != nullptr) held.prior = planar_prior(*scene.ground, scene.rig, pose);
    return track_from(frame, scene, pose, held);
  };
  auto best = track_around(predicted);
  if (best && scene.is_pressed) return best;
  // A sudden loss of matches may be due to a wrong prediction: try others.
  if (static_cast<double>(inlier_count(best)) >= options_.min_kept_share * last_inliers_) return best;
  // Faulty wheels must not lose a pose: the camera's own velocity is tried, then the last pose.
  const auto by_velocity = motion.measured() ? motion.predict_by_velocity(last_camera, seconds) : std::nullopt;
  for (const std::optional<Pose>& pose : {by_velocity, by_velocity ? std::optional(last_camera) : by_velocity}) {
    if (!pose || static_cast<double>(inlier_count(best)) >= options_.min_kept_share * last_inliers_) break;
    auto tracked = track_around(*pose);
    if (inlier_count(tracked) > inlier_count(best)) best = std::move(tracked);
  }
  if (scene.ground != nullptr) limits.prior = planar_prior(*scene.ground, scene.rig, predicted);
  if (static_cast<double>(inlier_count(best)) >= options_.min_kept_share * last_inliers_) return best;
  for (const std::optional<KeyframeId>& keyframe : {std::optional(last.keyframe), newest}) {
    const auto pose = keyframe ? pose_from_keyframe(frame, scene.rig, scene.mapper.map(), *keyframe) : std::nullopt;
    if (!pose) continue;
    auto tracked = track_from(frame, scene, *pose, limits);
    if (inlier_count(tracked) > inlier_count(best)) best = std::move(tracked);
  }
  return best;
}

Tracker::Find Tracker::find(const Frame& frame, const Scene& scene, bool is_in_map) const {
  Find result;
  if (scene.mission) {
    const auto [found, refused] =
        localise_in(scene.mission->offline(), {frame, scene.rig, scene.hint, scene.reach, scene.hidden},
                    {options_.relocalise, options_.mission.bounds});
    for (const TrackedFrame& place : found.places_found) result.places.push_back(found_in(Origin::offline, place));
    if (!result.places.empty()) return result;
    result.refused = refused;
    result.focal = found.focal;
  }
  const PlaceIndex* const places = scene.mapper.places();
  if (!places || scene.mapper.online().keyframe_count() == 0) return result;
  LocaliseOptions options = options_.relocalise;
  options.hidden = scene.hidden;
  const Submaps& submaps = scene.mapper.submaps();
  const PlaceFilter in_map{[&](KeyframeId id) { return submaps.frame(id) != Submaps::kMapFrame; }, {}};
  const bool has_separate = !scene.mission && submaps.has_separate();
  Localisation found =
      localise(frame, scene.rig, scene.mapper.map(), *places, options, has_separate ? in_map : PlaceFilter{});
  if (!found.tracked && has_separate && !is_in_map) {
    found = localise(frame, scene.rig, scene.mapper.map(), *places, options);
  }
  if (found.tracked && !is_like_another_place(*found.tracked)) {
    result.places.push_back(found_in(Origin::online, *found.tracked));
  }
  return result;
}

bool Tracker::is_doubtful(const HybridTrack& track, const Scene& scene) const {
  return rejection_reason(track.tracked, scene.rig, scene.mapper.map(), options_.relocalise) !=
         LocalisationFailure::none;
}

void Tracker::note(const HybridTrack& track) {
  last_inliers_ = static_cast<int>(track.tracked.features.size());
  if (track.online_reference) reference_ = track.online_reference;
}

}  // namespace byre
