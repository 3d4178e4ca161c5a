#include "byre/slam/localisation/pose_filter.h"

#include "byre/odometry/visual_motion.h"
#include "byre/slam/localisation/mission.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/tracking/planar_prior.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace byre {
namespace {

std::optional<Odometry::Offset> offset_from_online(const HybridTrack& track, const Rig& rig) {
  if (!track.from_online) return std::nullopt;
  const Pose online_from_body =
      inverse(body_pose(rig, *track.from_online)) * body_pose(rig, track.tracked.camera_from_world);
  const Matrix6 covariance = move_covariance(track.from_online_covariance, rig.body_from_camera);
  return Odometry::Offset{online_from_body, std::sqrt(position_variance(covariance))};
}

}  // namespace

KeyframeId anchor_of(const HybridTrack& track) {
  return track.is_online_displaced() && track.offline_reference ? *track.offline_reference : track.tracked.reference;
}

void PoseFilter::add_odometry(const std::optional<BodyMotion>& motion) {
  motion_.add_odometry(motion);
  last_odometry_ = motion;
  since_confirmed_ = since_confirmed_ && motion ? std::optional(*since_confirmed_ * *motion) : std::nullopt;
}

// Measured motion is precise enough to distinguish a place from its neighbours.
bool PoseFilter::is_accurate(const BodyMotion& measured) const {
  constexpr double kMostShare = 0.15;  // share of the scene depth
  constexpr double kMostTurn = 0.1;    // radians
  return std::sqrt(position_variance(measured.covariance)) <= kMostShare * scene_depth_ &&
         std::sqrt(rotation_variance(measured.covariance)) <= kMostTurn;
}

bool PoseFilter::is_odometry_accurate() const {
  if (!motion_.measured() || trajectory_.empty()) return false;
  return is_accurate(bridge_ ? *bridge_ * *motion_.measured() : *motion_.measured());
}

// Whether the pose continues the camera's motion from the last one, within the acceleration of a body.
bool PoseFilter::is_continued(Timestamp time, const Pose& now, const Rig& rig, const MapView& map) const {
  constexpr double kShare = 0.05;   // share of the median depth of the scene
  constexpr double kTurn = 0.1;     // radians
  constexpr double kLongest = 0.3;  // longest frame interval over which the velocity predicts the motion, seconds
  if (!has_pose_ || trajectory_.empty() || !place_.is_confirmed()) return false;
  const double seconds = to_seconds(time - trajectory_.back().time);
  if (seconds > kLongest) return false;
  const auto predicted = motion_.predict_by_velocity(byre::camera_from_world(map, trajectory_.back()), seconds);
  if (!predicted) return false;
  const Pose apart = inverse(body_pose(rig, *predicted)) * now;
  return apart.translation.norm() <= kShare * scene_depth_ + kMostAcceleration * seconds * seconds &&
         rotation_log(apart.rotation).norm() <= kTurn + kMostTurning * seconds * seconds;
}

std::optional<PoseFilter::UncertainPose> PoseFilter::measured_pose(const Rig& rig, const MapView& map) const {
  if (!since_confirmed_ || trajectory_.confirmed_count() == 0) return std::nullopt;
  const AnchoredPose& confirmed = trajectory_[trajectory_.confirmed_count() - 1];
  const BodyMotion since_seen = bridge_ ? *bridge_ * *since_confirmed_ : *since_confirmed_;
  return UncertainPose{body_pose(rig, byre::camera_from_world(map, confirmed)) * since_confirmed_->last_from_body,
                       since_seen.covariance};
}

bool PoseFilter::is_unreachable(const Frame& frame, const HybridTrack& track, const Rig& rig,
                                const MapView& map) const {
  constexpr Timestamp kLongest = std::chrono::seconds(30);
  constexpr double kSigmas = 5.0;
  if (trajectory_.confirmed_count() == 0) return false;
  const Pose now = body_pose(rig, track.tracked.camera_from_world);
  if (is_continued(frame.time, now, rig, map)) return false;
  if (on_offline_map_) return log_odds_of_relocalisation(frame.time, now, rig, map) <= kLogOddsOfKidnapping;
  if (!reach_) return false;
  const AnchoredPose& confirmed = trajectory_[trajectory_.confirmed_count() - 1];
  const AnchoredPose& last_seen = bridge_ ? trajectory_[bridge_begin_] : confirmed;
  if (frame.time - last_seen.time > kLongest) return false;
  const std::optional<UncertainPose> measured = measured_pose(rig, map);
  const bool is_elsewhere = measured && is_beyond(measured->covariance, inverse(measured->map_from_body) * now);
  const auto reach = reach_(last_seen.time, frame.time);
  if (!reach) return false;
  const double carried = std::sqrt(position_variance(carried_covariance()));
  const Pose before = body_pose(rig, byre::camera_from_world(map, last_seen));
  return (now.translation - before.translation).norm() > *reach + kSigmas * carried || is_elsewhere;
}

bool PoseFilter::is_jump(const Frame& frame, const HybridTrack& track, const Rig& rig, const MapView& map) const {
  constexpr double kSlack = 0.2;  // metres, that covariances neglect
  constexpr double kSigmas = 3.0;
  if (!on_offline_map_ || !last_accepted_ || !place_.is_confirmed()) return false;
  const Pose now = body_pose(rig, track.tracked.camera_from_world);
  if (is_continued(frame.time, now, rig, map)) return false;
  const StampedPose known = last_known(rig, map);
  const double reach = kSlack + kSigmas * std::sqrt(position_variance(quality_.covariance)) +
                       registration_.max_speed * to_seconds(frame.time - known.time);
  return (now.translation - known.world_from_body.translation).norm() > reach;
}

// Whether a pose differs from the predicted one by more than the error of measured motion in that direction: the tilt
// may be unknown where the heading is known.
bool PoseFilter::is_beyond(const Matrix6& covariance, const Pose& predicted_from_body) const {
  constexpr double kLeastShare = 0.2;  // share of the scene depth
  constexpr double kLeastTurn = 0.5;   // radians
  constexpr double kSigmas = 3.0;
  const auto exceeds = [](const Eigen::Vector3d& apart, const Eigen::Matrix3d& error, double least) {
    const Eigen::Vector3d along = apart.normalized();
    return apart.norm() > least + kSigmas * std::sqrt(std::max(0.0, along.dot(error * along)));
  };
  return exceeds(predicted_from_body.translation, covariance.topLeftCorner<3, 3>(), kLeastShare * scene_depth_) ||
         exceeds(rotation_log(predicted_from_body.rotation), covariance.bottomRightCorner<3, 3>(), kLeastTurn);
}

// All poses so far are confirmed, and the last one is visual.
void PoseFilter::confirm_poses() {
  trajectory_.confirm_all();
  since_confirmed_ = no_motion();
  is_path_measured_ = true;
  bridge_.reset();
  bridge_end_.reset();
}

// Precondition: the found frame is not in the trajectory yet.
void PoseFilter::record_bridge_end(const Rig& rig, const MapView& map) {
  bridge_end_.reset();
  if (!bridge_ || !motion_.measured()) return;
  const Pose predicted = motion_.predict(byre::camera_from_world(map, trajectory_.back()), rig, 0.0);
  const Pose first = byre::camera_from_world(map, trajectory_[bridge_begin_]);
  bridge_end_ = {bridge_begin_, trajectory_.size(), first * inverse(predicted)};
}

// Log-odds of a find by its Mahalanobis distance from the pose by measured motion. 0 without such a pose, or if the
// distance is usual.
double PoseFilter::log_odds_of_odometry(const Pose& body, const Rig& rig, const MapView& map) const {
  constexpr double kSlack = 0.05;  // share of the scene depth, and radians
  constexpr double kUsual = 6.0;   // squared distance, the mean for six dimensions
  const std::optional<UncertainPose> measured = measured_pose(rig, map);
  if (!reach_ || !measured || quality_.verdict == Verdict::untrusted) return 0.0;
  Matrix6 covariance = measured->covariance;
  covariance.diagonal().head<3>().array() += std::pow(kSlack * scene_depth_, 2);
  covariance.diagonal().tail<3>().array() += kSlack * kSlack;
  const Vector6 apart = log_pose(inverse(measured->map_from_body) * body);
  const double distance = apart.dot(covariance.ldlt().solve(apart));
  return std::isfinite(distance) ? std::max(kLogOddsOfKidnapping, -0.5 * std::max(0.0, distance - kUsual)) : 0.0;
}

// Reference of a find: the last accepted pose, or the pose by measured motion since then.
StampedPose PoseFilter::last_known(const Rig& rig, const MapView& map) const {
  const bool is_bridged = bridge_ && is_odometry_accurate() && quality_.verdict != Verdict::untrusted;
  if (!is_bridged) return *last_accepted_;
  const AnchoredPose& bridged = trajectory_[trajectory_.confirmed_count() - 1];
  return {bridged.time, body_pose(rig, camera_from_world(map, bridged))};
}

double PoseFilter::log_odds_of_relocalisation(Timestamp time, const Pose& body, const Rig& rig,
                                              const MapView& map) const {
  constexpr double kSlack = 0.5;  // metres, error of poses
  if (!last_accepted_ || trajectory_.confirmed_count() == 0) return 0.0;
  const StampedPose known = last_known(rig, map);
  const double reach = kSlack + registration_.max_speed * to_seconds(time - known.time);
  if ((body.translation - known.world_from_body.translation).norm() > reach) return kLogOddsOfKidnapping;
  return log_odds_of_odometry(body, rig, map);
}

// Within a second of an accepted pose, and within reach, the test of its place continues.
PlaceHypothesis PoseFilter::hypothesis_of_relocalisation(Timestamp time, const Pose& body, const PlaceHypothesis* known,
                                                         const Rig& rig, const MapView& map) const {
  constexpr double kShortly = 1.0;  // seconds
  const int frames = registration_.confirmations;
  const double prior = log_odds_of_relocalisation(time, body, rig, map);
  const bool is_kidnapped = prior <= kLogOddsOfKidnapping;
  if (!is_kidnapped && last_accepted_ && to_seconds(time - last_known(rig, map).time) <= kShortly) {
    PlaceHypothesis found_again = has_pose_ && place_.is_accepted() ? place_ : place_before_;
    found_again.require_confirmations(frames);
    return found_again;
  }
  if (known != nullptr) return *known;
  return PlaceHypothesis(prior, is_kidnapped ? kConfirmationsOfJump : frames, registration_.accept_log_odds);
}

// Returns the length of the motion, metres.
double PoseFilter::move_to(const TrackedPose& seen, const Pose& body, const Rig& rig, const MapView& map) {
  const std::optional<Odometry::Offset> offset = offset_from_online(seen.track, rig);
  if (seen.is_relocalised) {
    odometry_.move_by_odometry(last_odometry_ && !trajectory_.empty() ? last_odometry_->last_from_body : Pose{}, body);
    odometry_.set_offset(offset);
    motion_.set_velocity(Vector6::Zero());
    return 0.0;
  }
  const Odometry::Step step = odometry_.advance_to(body, offset);
  motion_.set_velocity(trajectory_.velocity_to(seen.frame.time, camera_pose(rig, step.smooth), map));
  return step.metres;
}

double PoseFilter::log_odds_of_registration(const Pose& offline_from_online) const {
  if (!bridged_beginning_) return 0.0;
  const auto& [body, covariance] = *bridged_beginning_;
  return is_beyond(covariance, inverse(body) * offline_from_online * body) ? kLogOddsOfKidnapping : 0.0;
}

void PoseFilter::note_registration(const Pose& offline_from_online, bool is_by_hint) {
  const double prior = is_by_hint ? 0.0 : log_odds_of_registration(offline_from_online);
  place_ = PlaceHypothesis(prior, 0, registration_.accept_log_odds);
  is_by_hint_ = is_by_hint;
  bridged_beginning_.reset();
}

PoseFilter::Progress PoseFilter::note(const TrackedPose& seen, const Rig& rig, const MapView& map) {
  const HybridTrack& track = seen.track;
  const Pose body = body_pose(rig, track.tracked.camera_from_world);
  Progress progress{0.0, place_.is_accepted(), last_confirmed_.has_value()};
  if (seen.is_relocalised && on_offline_map_) {
    place_ = seen.is_jump ? PlaceHypothesis(kLogOddsOfKidnapping, kConfirmationsOfJump, registration_.accept_log_odds)
                          : hypothesis_of_relocalisation(seen.frame.time, body, seen.known_place, rig, map);
    is_by_hint_ = seen.is_by_hint;
    bridged_beginning_.reset();
  }
  if (on_offline_map_) {
    place_.observe(seen.view != nullptr ? *seen.view : PlaceView{}, !seen.is_relocalised, seen.log_odds_of_rivals);
  }
  is_by_hint_ = is_by_hint_ && !place_.is_accepted();
  if (seen.is_relocalised && seen.is_registered) record_bridge_end(rig, map);
  std::optional<BodyMotion> odometry_motion;
  if (seen.is_relocalised && !trajectory_.empty() && last_odometry_)
    odometry_motion = bridge_ ? *bridge_ * *last_odometry_ : *last_odometry_;
  note_jump(seen, body, rig, map);
  note_disagreement(track);
  progress.step = move_to(seen, body, rig, map);
  add_odometry_covariance(odometry_motion);
  if (const double depth = median_depth(track.tracked, map); depth > 0.0) scene_depth_ = depth;
  const KeyframeId anchor = anchor_of(track);
  trajectory_.add({seen.frame.time, anchor, track.tracked.camera_from_world * inverse(camera_from_world(map, anchor)),
                   seen.submap});
  if (on_offline_map_) trajectory_.keep_sightings(rig, *seen.frame.features, track.tracked);
  has_pose_ = true;
  last_seen_ = seen.frame.time;
  if (!place_.is_confirmed()) return progress;
  if (bridge_end_) trajectory_.distribute_drift(bridge_end_->first, bridge_end_->second, bridge_end_->measured, map);
  confirm_poses();
  if (!seen.is_registered) return progress;
  last_confirmed_ = seen.frame.time;
  if (place_.is_accepted()) last_accepted_ = {seen.frame.time, body};
  return progress;
}

void PoseFilter::begin(const std::vector<KeyframeId>& keyframes, std::size_t submap, const Rig& rig,
                       const MapGraph& online) {
  const Pose body = body_pose(rig, online.camera_from_world(keyframes.back()));
  const bool is_bridged = bridge_ && !trajectory_.empty();
  if (is_bridged && !on_offline_map_) carried_ = {body, covariance_of_bridge()};
  bridged_beginning_.reset();
  if (is_bridged && on_offline_map_ && quality_.verdict != Verdict::untrusted) {
    bridged_beginning_ = {body, covariance_of_bridge()};
  }
  const std::optional<BodyMotion> odometry_motion = bridge_;
  bridge_ ? void(odometry_.advance_to(body, {})) : odometry_.correct(body);
  add_odometry_covariance(odometry_motion);
  odometry_.set_offset({});
  for (const KeyframeId id : keyframes) {
    const Timestamp time = online.find_keyframe(id)->frame.time;
    if (trajectory_.empty() || trajectory_.back().time < time) trajectory_.add({time, id, Pose{}, submap});
  }
  confirm_poses();
  motion_.set_velocity(Vector6::Zero());
  place_ = {};
  is_by_hint_ = false;
  has_pose_ = true;
  last_seen_ = trajectory_.back().time;
}

void PoseFilter::mark_lost() {
  if (has_pose_ && place_.is_confirmed() && place_.is_accepted()) place_before_ = place_;
  if (has_pose_) place_ = {};
  has_pose_ = false;
  is_by_hint_ = false;
  motion_.mark_lost();
  disagreement_variance_ = 0.0;
  if (trajectory_.has_unconfirmed()) motion_.restore_measured(since_confirmed_);
  trajectory_.drop_unconfirmed();
  bridge_end_.reset();
  odometry_.set_offset({});
}

void PoseFilter::reset() {
  mark_lost();
  place_before_ = {};
  last_accepted_.reset();
  is_path_measured_ = false;
  bridge_.reset();
}

// The bridge ends at the pose on the ground.
Pose PoseFilter::constrained_by(const DrivenGround& ground, const Rig& rig, const Pose& camera_from_map) {
  const auto prior = planar_prior(ground, rig, camera_from_map);
  if (!prior) return camera_from_map;
  const Matrix6 measured = move_covariance(covariance_of_bridge(), inverse(rig.body_from_camera));
  const PosePrior held = combined({camera_from_map, measured}, *prior);
  const Pose before = body_pose(rig, camera_from_map), after = body_pose(rig, held.camera_from_world);
  bridge_->last_from_body = bridge_->last_from_body * (inverse(before) * after);
  bridge_covariance_ = move_covariance(held.covariance, rig.body_from_camera);
  return held.camera_from_world;
}

std::optional<Pose> PoseFilter::start_by_odometry() const {
  if (on_offline_map_ || !trajectory_.empty() || !is_path_measured_ || !last_odometry_) return std::nullopt;
  return bridge_ ? bridge_->last_from_body * last_odometry_->last_from_body : last_odometry_->last_from_body;
}

// A gap in the measured motion makes the pose relative to the beginning unknown.
void PoseFilter::propagate_before_map() {
  if (bridge_ && !last_odometry_) is_path_measured_ = false;
  if (!is_path_measured_ || !last_odometry_) return bridge_.reset();
  bridge_ = bridge_ ? *bridge_ * *last_odometry_ : *last_odometry_;
  bridge_covariance_.reset();
  odometry_.move_by_odometry(last_odometry_->last_from_body, bridge_->last_from_body);
}

// Constrains the bridge by the tilt measured at a stop. A pose that agrees with the tilt is not changed: a gyroscope
// drifts less in seconds than the bias of an accelerometer, whatever its covariance. All measurements of one stop are
// one: the first frame of the stop moves the pose, later ones keep it.
Pose PoseFilter::constrained_by(const BodyTilt& tilt, const Rig& rig, const Pose& camera_from_map) {
  constexpr double kSigmas = 4.0;
  constexpr double kAgreeing = 2.0;  // sigmas of the measured tilt
  const PosePrior prior = tilt_prior(tilt, rig, camera_from_map);
  const PosePrior measured{camera_from_map, move_covariance(covariance_of_bridge(), inverse(rig.body_from_camera))};
  const double apart = angle_between(measured.camera_from_world.rotation, prior.camera_from_world.rotation);
  const double turn_variance = rotation_variance(measured.covariance);
  if (apart > kSigmas * std::sqrt(turn_variance + tilt.sigma * tilt.sigma)) return camera_from_map;
  const PosePrior held = combined(measured, prior);
  bridge_covariance_ = move_covariance(held.covariance, rig.body_from_camera);
  ++tilts_applied_;
  if (stop_ == tilt.stop || apart < kAgreeing * tilt.sigma) return camera_from_map;
  stop_ = tilt.stop;
  const Pose before = body_pose(rig, camera_from_map), after = body_pose(rig, held.camera_from_world);
  bridge_->last_from_body = bridge_->last_from_body * (inverse(before) * after);
  return held.camera_from_world;
}

bool PoseFilter::propagate(Timestamp time, const Rig& rig, const MapView& map, const DrivenGround* ground) {
  if (trajectory_.empty() && !on_offline_map_ && map.online().keyframe_count() == 0) propagate_before_map();
  if (has_pose_ || !is_path_measured_ || !motion_.measured() || trajectory_.empty()) {
    if (!has_pose_ && !trajectory_.empty()) bridge_.reset();
    return bridge_.has_value();
  }
  if (!bridge_) {
    bridge_begin_ = trajectory_.size() - 1;
    stop_.reset();
  }
  const AnchoredPose last = trajectory_.back();
  Pose camera_from_map = motion_.predict(byre::camera_from_world(map, last), rig, 0.0);
  bridge_ = bridge_ ? *bridge_ * *motion_.measured() : *motion_.measured();
  bridge_covariance_.reset();
  if (ground != nullptr) camera_from_map = constrained_by(*ground, rig, camera_from_map);
  if (tilt_) camera_from_map = constrained_by(*tilt_, rig, camera_from_map);
  const Pose camera_from_keyframe = camera_from_map * inverse(byre::camera_from_world(map, last.keyframe));
  trajectory_.add({time, last.keyframe, camera_from_keyframe, last.submap});
  trajectory_.confirm_all();
  since_confirmed_ = no_motion();
  motion_.reset_measured();
  odometry_.move_by_odometry(last_odometry_->last_from_body, body_pose(rig, camera_from_map));
  return true;
}

void PoseFilter::apply_length_changes(const LengthChanges& changes) {
  trajectory_.apply_length_changes(changes);
  if (trajectory_.empty()) return;
  const auto change = changes.find(trajectory_.back().keyframe);
  if (change == changes.end()) return;
  motion_.scale_lengths(change->second);
}

void PoseFilter::rotate_rig(const RigRotation& turn, const MapGraph& online) {
  trajectory_.rotate_rig(turn, online);
  motion_.rotate_camera(turn.after_from_before);
}

void PoseFilter::rotate_camera(const Pose& after_from_before) {
  trajectory_.rotate_camera(after_from_before);
  motion_.rotate_camera(after_from_before);
}

void PoseFilter::refine_overdue(const MapView& map, const TrackOptions& tracking) {
  trajectory_.refine_overdue(map, tracking);
  const bool has_bridge = bridge_ || bridge_end_;
  const std::size_t removed = trajectory_.thin_out(has_bridge ? bridge_begin_ : trajectory_.size());
  if (has_bridge) bridge_begin_ -= removed;
  if (!bridge_end_) return;
  bridge_end_->first -= removed;
  bridge_end_->second -= removed;
}

std::optional<Pose> PoseFilter::apply_map_correction(const Rig& rig, const MapView& map) {
  if (trajectory_.empty() || (!has_pose_ && !bridge_)) return std::nullopt;
  const Pose before = odometry_.map_from_body();
  const Pose body = body_pose(rig, camera_from_world(map, trajectory_.back()));
  odometry_.correct(body);
  return body * inverse(before);
}

}  // namespace byre
