// How a session finds the pose of a frame: by prediction, or from nothing.

#include "byre/session/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {
namespace {

std::size_t inlier_count(const std::optional<HybridTrack>& track) {
  return track ? track->tracked.features.size() : 0;
}

// A frame found in one map alone.
HybridTrack found_in(Origin origin, const TrackedFrame& tracked) {
  HybridTrack track;
  track.tracked = tracked;
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

}  // namespace

Pose Session::camera_from_world(KeyframeId id) const {
  return id.origin == Origin::offline ? mission_->offline().map().camera_from_world(id) : online_.camera_from_world(id);
}

Pose Session::last_camera_from_world() const {
  const AnchoredPose& last = anchored_.back();
  return last.camera_from_keyframe * camera_from_world(last.keyframe);
}

Pose Session::predict(Timestamp time) const {
  if (told_motion_) return camera_pose(body_pose(last_camera_from_world()) * *told_motion_);
  const double elapsed = to_seconds(time - anchored_.back().time);
  return exp_pose(velocity_ * elapsed) * last_camera_from_world();
}

Vector6 Session::velocity_to(Timestamp time, const Pose& camera_from_world) const {
  const double elapsed = to_seconds(time - anchored_.back().time);
  if (elapsed <= 0.0) return Vector6::Zero();
  return log_pose(camera_from_world * inverse(last_camera_from_world())) / elapsed;
}

// Lost a moment ago, and told since how the body has moved.
bool Session::may_be_led_back(Timestamp time) const {
  constexpr double kMostSeconds = 5.0;
  return !has_pose_ && told_motion_ && !anchored_.empty() && to_seconds(time - anchored_.back().time) <= kMostSeconds;
}

Session::Located Session::locate(const Frame& frame) {
  Located located;
  is_focal_asked_ = mission_ && focal_check_.is_due();
  const bool can_search = mission_ || places_;
  const bool is_led_back = can_search && may_be_led_back(frame.time);
  if (!anchored_.empty() && (has_pose_ || !can_search || is_led_back)) located.track = find_pose(frame);
  if (located.track && located.track->focal) focal_check_.note(*located.track->focal);
  if (located.track && !is_still_confirming(*located.track)) located.track.reset();
  located.without_prediction = located.track && is_led_back;
  if (!located.track && can_search) {
    located.track = relocalise(frame);
    located.without_prediction = located.track.has_value();
  }
  if (!located.track && may_begin_segment(frame)) {
    rig_.is_stereo() ? begin_stereo(frame, located) : begin_monocular(frame, located);
  }
  return located;
}

std::optional<HybridTrack> Session::track_from(const Frame& frame, const Pose& predicted,
                                               const std::vector<PointId>& online) {
  if (!mission_) {
    const auto tracked = track(frame, predicted, rig_, map(), online, options_.track);
    return tracked ? std::optional(found_in(Origin::online, *tracked)) : std::nullopt;
  }
  std::vector<PointId> candidates;
  if (is_registered()) candidates = mission_->candidates(predicted);
  candidates.insert(candidates.end(), online.begin(), online.end());
  return track_hybrid(frame, predicted, rig_, map(), candidates, options_.track, is_focal_asked_);
}

// Kept until the map or the reference changes: frames come more often than that.
const std::vector<PointId>& Session::local_online_points() {
  if (local_points_of_ && local_points_of_ == online_reference_) return local_points_;
  local_points_.clear();
  if (online_reference_) local_points_ = local_points(map(), *online_reference_, options_.local_keyframes);
  std::erase_if(local_points_, [](PointId id) { return id.origin == Origin::offline; });
  local_points_of_ = online_reference_;
  return local_points_;
}

std::optional<HybridTrack> Session::find_pose(const Frame& frame) {
  // Mapping may have removed the last frame's keyframe since, but never the newest. What lies in another frame, left
  // when the pose was lost, is not where the pose says.
  const auto newest = last_keyframe_ && is_in_present_frame(*last_keyframe_) ? last_keyframe_ : std::nullopt;
  if (!online_reference_ || online_.find_keyframe(*online_reference_) == nullptr ||
      !is_in_present_frame(*online_reference_)) {
    online_reference_ = newest;
  }
  const std::vector<PointId>& online = local_online_points();
  const Pose predicted = has_pose_ || told_motion_ ? predict(frame.time) : last_camera_from_world();
  auto best = track_from(frame, predicted, online);
  // A sudden loss of matches may mean that the prediction led astray: look again without it.
  if (static_cast<double>(inlier_count(best)) >= options_.min_kept_share * last_inliers_) return best;
  for (const std::optional<KeyframeId>& keyframe : {std::optional(anchored_.back().keyframe), newest}) {
    const auto pose = keyframe ? pose_from_keyframe(frame, rig_, map(), *keyframe) : std::nullopt;
    if (!pose) continue;
    auto tracked = track_from(frame, *pose, online);
    if (inlier_count(tracked) > inlier_count(best)) best = std::move(tracked);
  }
  return best;
}

std::optional<HybridTrack> Session::relocalise(const Frame& frame) {
  auto found = mission_ ? relocalise_offline(frame) : std::nullopt;
  if (!found && places_ && online_.keyframe_count() > 0) found = relocalise_online(frame);
  return found;
}

std::optional<HybridTrack> Session::relocalise_offline(const Frame& frame) {
  const Localisation found = localise_in(mission_->offline(), frame, rig_, options_.relocalise);
  if (!found.tracked) return std::nullopt;
  segments_.begin_in_map_frame(next_keyframe_number());
  return found_in(Origin::offline, *found.tracked);
}

std::optional<HybridTrack> Session::relocalise_online(const Frame& frame) {
  const Localisation found = localise(frame, rig_, map(), *places_, options_.relocalise);
  if (!found.tracked) return std::nullopt;
  segments_.begin_beside(found.tracked->reference, next_keyframe_number());
  return found_in(Origin::online, *found.tracked);
}

bool Session::may_begin_segment(const Frame& frame) const {
  if (!options_.map_online) return false;
  // One camera knows no scale: it begins one map, and beside another it would not know how large what it sees is.
  if (!rig_.is_stereo()) return initialiser_.has_value();
  if (anchored_.empty()) return online_.keyframe_count() == 0 || mission_;
  if (!mission_ || image_fault(frame) != ImageFault::none) return false;
  return to_seconds(frame.time - anchored_.back().time) >= options_.mission.restart_after;
}

// In a mission its place in the offline map is not known yet.
void Session::begin_stereo(const Frame& frame, Located& located) {
  auto first = initialise_stereo(frame, rig_, options_.min_initial_points);
  if (!first) return;
  mission_ ? segments_.begin_in_own_frame(next_keyframe_number())
           : segments_.begin_in_map_frame(next_keyframe_number());
  if (online_.keyframe_count() == 0) {
    online_ = std::move(*first);
    last_keyframe_ = online_.keyframe_ids().front();
  } else {
    TrackedFrame tracked;
    tracked.camera_from_world = last_camera_from_world();
    Keyframe keyframe = make_keyframe(frame, tracked, online_.add_rig(rig_));
    keyframe.parent.reset();
    last_keyframe_ = online_.add_keyframe(std::move(keyframe));
    add_stereo_points(online_, *last_keyframe_);
  }
  index_place(*last_keyframe_);
  begin_segment(frame);
  located.is_new_segment = true;
}

void Session::begin_monocular(const Frame& frame, Located& located) {
  MonocularAttempt attempt = initialiser_->try_start(frame);
  located.start_failure = attempt.failure;
  if (!attempt.start) return;
  initialiser_.reset();
  online_ = std::move(attempt.start->map);
  segments_.begin_in_map_frame(0);
  last_keyframe_ = attempt.start->second;
  const KeyframeId reference = attempt.start->first;
  index_place(reference);
  index_place(*last_keyframe_);
  begin_segment(frame);
  anchored_.insert(anchored_.begin(),
                   {online_.find_keyframe(reference)->frame.time, reference, Pose{}, segments_.present()});
  confirmed_end_ = anchored_.size();
  pending_.push_back(*last_keyframe_);
  located.is_new_segment = true;
}

// The newest keyframe is that of the frame.
void Session::begin_segment(const Frame& frame) {
  online_reference_ = last_keyframe_;
  local_points_of_.reset();
  const Pose body = body_pose(online_.camera_from_world(*last_keyframe_));
  if (anchored_.empty()) {
    odometry_.start(body);
  } else {
    odometry_.absorb(last_body_, body);
  }
  anchored_.push_back({frame.time, *last_keyframe_, Pose{}, segments_.present()});
  last_body_ = body;
  offset_from_online_.reset();
  velocity_ = Vector6::Zero();
  frames_since_keyframe_ = 0;
  reference_.reset();
  has_pose_ = true;
  confirmations_left_ = 0;
  proofs_left_ = 0;
  confirmed_end_ = anchored_.size();
  if (mission_) mission_->forget_reference();
}

}  // namespace byre
