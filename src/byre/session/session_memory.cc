// What a session remembers of a frame, and tells of it.

#include "byre/session/session.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

// Points and keyframes share errors that their single covariances know nothing of; found on simulated missions.
constexpr double kNeglectedCorrelation = 1.1;

// What the matches leave open, and the drift that stereo odometry may have gathered on its way.
Matrix6 odometry_covariance(const Matrix6& match_covariance, double travelled) {
  constexpr double kDriftShare = 0.005;
  constexpr double kTurnPerMetre = 0.0005;  // radians
  Matrix6 covariance = match_covariance;
  covariance.topLeftCorner<3, 3>().diagonal().array() += std::pow(kDriftShare * travelled, 2);
  covariance.bottomRightCorner<3, 3>().diagonal().array() += std::pow(kTurnPerMetre * travelled, 2);
  return covariance;
}

}  // namespace

ImageFault Session::image_fault(const Frame& frame) const {
  return frame.condition ? fault_of(*frame.condition, options_.image) : ImageFault::none;
}

std::optional<Pose> Session::offset_from_online(const HybridTrack& track) const {
  if (!mission_ || !track.from_online) return std::nullopt;
  return inverse(body_pose(*track.from_online)) * body_pose(track.tracked.camera_from_world);
}

// What offline points do to a pose that online points hold as well is no motion: where that changes at once, the body
// is where it would be had it not.
Pose Session::without_change_of(const std::optional<Pose>& offset, const Pose& body) const {
  constexpr double kMaxChange = 0.01;  // metres: less is noise
  if (!offset || !offset_from_online_) return body;
  const double change = (offset->translation - offset_from_online_->translation).norm();
  return change > kMaxChange ? body * inverse(*offset) * *offset_from_online_ : body;
}

void Session::remember(const Frame& frame, const HybridTrack& track, bool without_prediction, FrameReport& report) {
  const Pose body = body_pose(track.tracked.camera_from_world);
  const std::optional<Pose> offset = offset_from_online(track);
  const bool is_first = anchored_.empty();
  const Pose smooth = without_prediction || is_first ? body : without_change_of(offset, body);
  double step = 0.0;
  if (is_first) {
    odometry_.start(body);
  } else if (without_prediction) {
    odometry_.absorb(last_body_, body);
  } else {
    step = (last_body_.translation - smooth.translation).norm();
    odometry_.absorb(smooth, body);
    odometry_.travel(step);
  }
  velocity_ = without_prediction || is_first ? Vector6::Zero() : velocity_to(frame.time, camera_pose(smooth));
  offset_from_online_ = offset;
  if (const double depth = median_depth(track.tracked, map()); depth > 0.0) scene_depth_ = depth;
  if (is_pose_proven() && !without_prediction) shutter_.note(frame, rig_, track.tracked, map(), velocity_);
  if (without_prediction) begin_confirmation(frame, track.tracked);
  last_inliers_ = static_cast<int>(track.tracked.features.size());
  const KeyframeId reference =
      track.is_online_off() && track.offline_reference ? *track.offline_reference : track.tracked.reference;
  if (reference_ != reference) fresh_inliers_ = last_inliers_;
  reference_ = reference;
  if (track.online_reference) online_reference_ = track.online_reference;
  anchored_.push_back({frame.time, reference, track.tracked.camera_from_world * inverse(camera_from_world(reference)),
                       segments_.present()});
  if (mission_) hindsight_.note(anchored_.size() - 1, rig_, *frame.features, track.tracked);
  last_body_ = body;
  has_pose_ = true;
  if (mission_ && is_registered()) remember_mission(frame, track, step, report);
  if (!without_prediction) look_for_proof(track);
  if (!is_pose_confirmed()) return;
  confirmed_end_ = anchored_.size();
  if (!is_registered()) return;
  if (mission_ && !last_confirmed_) {
    report.events.push_back(SessionEvent::localised);
  } else if (has_lost_its_way(state_)) {
    report.events.push_back(SessionEvent::relocalised);
  }
  last_confirmed_ = frame.time;
  if (is_pose_proven()) last_proven_ = frame.time;
  if (mission_calibrator_ && is_pose_proven() && !track.maps_disagree) {
    mission_calibrator_->note(frame, rig_, track.tracked, map());
  }
}

void Session::remember_mission(const Frame& frame, const HybridTrack& track, double step, FrameReport& report) {
  const OfflineView before = mission_->view();
  mission_->note(
      track, frame.time, step,
      {track.offline_expected, track.offline_inliers, image_fault(frame) != ImageFault::none, frame.features->size()});
  const OfflineView now = mission_->view();
  const auto tell = [&](OfflineView view, SessionEvent event) {
    if (now == view && before != view) report.events.push_back(event);
  };
  tell(OfflineView::off_the_map, SessionEvent::left_mapped_area);
  tell(OfflineView::blinded, SessionEvent::blinded);
  tell(OfflineView::held, SessionEvent::entered_mapped_area);
  const bool is_held =
      now == OfflineView::held && !track.maps_disagree && track.offline_inliers >= kOfflineThatHolds && last_keyframe_;
  if (is_held) last_held_keyframe_ = last_keyframe_->number;
  const std::vector<PointId> due = mission_->due_again();
  if (!due.empty()) {
    mission_->note_again(look_for_points(frame, track.tracked.camera_from_world, rig_, map(), due, options_.track));
  }
  if (!track.is_online_off() || waiting_correction_ || !is_pose_confirmed()) return;
  const Pose offline_from_online = inverse(*track.from_offline) * *track.from_online;
  const auto correction = mission_->consider(offline_from_online, inverse(*track.from_online).translation,
                                             median_depth(track.tracked, map()));
  if (correction) waiting_correction_ = {segments_.frame(), last_held_keyframe_, *correction, CorrectionShape::spread};
}

// A pose found from nothing is believed once the frames that follow have been tracked on it; the more of them, the less
// the robot can have come there by itself. It is trusted once some frames see much of what should be there.
void Session::begin_confirmation(const Frame& frame, const TrackedFrame& tracked) {
  if (!mission_) return;
  const RegistrationOptions& options = options_.mission.registration;
  confirmations_left_ = options.confirmations;
  proofs_left_ = options.confirmations;
  if (!last_confirmed_ || anchored_.empty()) return;
  constexpr double kSlack = 0.5;  // metres
  const double reach = kSlack + options.max_speed * to_seconds(frame.time - *last_confirmed_);
  const double shift = (body_pose(tracked.camera_from_world).translation - last_body_.translation).norm();
  if (shift > reach) {
    confirmations_left_ = kConfirmationsOfJump;
  } else if (last_proven_ && to_seconds(frame.time - *last_proven_) <= kWithoutProof) {
    proofs_left_ = 0;
  }
}

bool Session::is_still_confirming(const HybridTrack& track) {
  if (is_pose_confirmed()) return true;
  if (reason_to_doubt(track.tracked, rig_, map(), options_.relocalise) != LocalisationFailure::none) return false;
  --confirmations_left_;
  return true;
}

void Session::look_for_proof(const HybridTrack& track) {
  const double share = options_.mission.registration.proving_share;
  if (!is_pose_proven() && track.offline_inliers >= share * track.offline_expected) --proofs_left_;
}

void Session::lose_pose(ImageFault fault, FrameReport& report) {
  if (has_pose_ && state_ == State::tracking) {
    report.events.push_back(SessionEvent::pose_lost);
    if (fault != ImageFault::none) report.events.push_back(SessionEvent::blinded);
  }
  has_pose_ = false;
  confirmations_left_ = 0;
  if (anchored_.size() > confirmed_end_) told_motion_.reset();
  anchored_.resize(confirmed_end_);  // what was found and never confirmed
  hindsight_.forget_from(confirmed_end_);
  offset_from_online_.reset();
  if (!mission_) return;
  mission_->forget_reference();
  mission_->forget_hypothesis();
}

// Mapping has settled by now where the points lie that the frame was tracked on.
void Session::settle(const RememberedFrame& seen) {
  AnchoredPose& anchored = anchored_[seen.number];
  const Pose keyframe_from_world = camera_from_world(anchored.keyframe);
  const auto pose = pose_in_hindsight(seen, anchored.camera_from_keyframe * keyframe_from_world, map(), options_.track);
  if (pose) anchored.camera_from_keyframe = *pose * inverse(keyframe_from_world);
}

bool Session::may_map(const Frame& frame, const HybridTrack& track) const {
  if (!options_.map_online || !is_pose_confirmed()) return false;
  if (image_fault(frame) != ImageFault::none) return false;
  return needs_keyframe(track.tracked, keyframe_evidence(track), options_.keyframes);
}

// Places are looked for in the offline map while its points do not hold the pose, or may do so by chance.
void Session::search_beside(const Frame& frame) {
  if (!mission_ || !search_->idle() || waiting_correction_ || !is_pose_confirmed()) return;
  const bool is_needed =
      !is_registered() || !is_pose_proven() || mission_->distance_since_offline() > options_.mission.search_after;
  if (is_needed) search_->look_for(frame, rig_, anchored_.size() - 1);
}

void Session::consider_place(const FoundPlace& found, FrameReport& report) {
  if (!has_pose_ || !is_pose_confirmed() || waiting_correction_ || found.frame >= anchored_.size()) return;
  const AnchoredPose& then = anchored_[found.frame];
  if (segments_.frame(then.segment) != segments_.frame()) return;
  const Pose camera_from_online = then.camera_from_keyframe * camera_from_world(then.keyframe);
  const Agreement agreement = agreement_of(found.camera_from_offline, camera_from_online);
  if (then.segment == segments_.present() && is_refuted_by(found, agreement)) {
    segments_.leave_map_frame();
    lose_pose(ImageFault::none, report);
    return;
  }
  // The robot was not carried, for it was tracked all the while: farther off than drift is a place that looks the same.
  if (is_registered() && !is_within(agreement, mission_->drift())) return;
  const Pose offline_from_online = inverse(found.camera_from_offline) * camera_from_online;
  const Eigen::Vector3d camera_in_online = inverse(camera_from_online).translation;
  const auto correction = mission_->consider(offline_from_online, camera_in_online, found.median_depth);
  if (!correction) return;
  waiting_correction_ =
      is_registered() ? WaitingCorrection{segments_.frame(), last_held_keyframe_, *correction, CorrectionShape::spread}
                      : WaitingCorrection{segments_.frame(), 0, *correction, CorrectionShape::rigid};
}

// A pose that was found from nothing and never proven gives way to a place elsewhere that shows what would prove it.
bool Session::is_refuted_by(const FoundPlace& found, const Agreement& agreement) const {
  constexpr double kElsewhere = 0.5;  // metres
  return is_registered() && !is_pose_proven() && agreement.translation > kElsewhere &&
         found.seen_share >= options_.mission.registration.proving_share;
}

void Session::conclude(const Frame& frame, const Located& located, FrameReport& report) {
  const double seconds_without = to_seconds(frame.time - last_confirmed_.value_or(*first_frame_));
  state_ = next_state(state_, {has_pose_, is_pose_confirmed(), seconds_without}, options_.state);
  tell_navigation_error(seconds_without, report);
  report.state = state_;
  report.features = frame.features->size();
  if (has_pose_) {
    if (is_registered()) report.map_from_body = last_body_;
    report.odometry_from_body = odometry_.pose(last_body_);
  }
  if (located.track) {
    const TrackedFrame& tracked = located.track->tracked;
    report.expected_points = tracked.expected;
    report.matches = tracked.matches;
    report.inliers = static_cast<int>(tracked.features.size());
    report.covariance = kNeglectedCorrelation * move_covariance(covariance_of(tracked), rig_.body_from_camera);
    report.odometry_covariance =
        odometry_covariance(kNeglectedCorrelation * move_covariance(tracked.match_covariance, rig_.body_from_camera),
                            odometry_.travelled());
  }
  report.health = health_of(frame, located, report.covariance);
}

// In a mission the map's frame itself is only as exact as the offline map. Where offline points hold the pose, that and
// the matches are all.
Matrix6 Session::covariance_of(const TrackedFrame& tracked) const {
  if (!mission_) return tracked.covariance;
  const bool is_online = tracked.reference.origin == Origin::online;
  return (is_online ? tracked.covariance : tracked.match_covariance) + mission_->offline().frame_covariance();
}

// Without an offline map it is the map made that tells a calibration that lies, once it was asked for the first time.
void Session::judge_calibration(HealthEvidence& evidence) const {
  constexpr double kFarOff = 3.0;  // pixels; the real calibrations that were refused are off by 0.6 to 2.4
  evidence.is_miscalibrated = focal_check_.is_off();
  if (!calibrator_) return;
  const auto& result = calibrator_->result();
  evidence.is_calibration_open = !result;
  evidence.is_calibration_doubtful = result && result->was_refused();
  if (evidence.is_calibration_doubtful && result->shift >= kFarOff) evidence.is_miscalibrated = true;
}

Health Session::health_of(const Frame& frame, const Located& located, const Matrix6& covariance) const {
  Health health;
  health.image = frame.condition;
  HealthEvidence evidence{has_pose_, is_registered(), is_pose_confirmed() && is_pose_proven()};
  evidence.maps_disagree = located.track && located.track->maps_disagree && !located.track->offline_stands;
  evidence.image_fault = image_fault(frame);
  evidence.input = input_;
  judge_calibration(evidence);
  health.focal_error = focal_check_.error();
  health.position_sigma = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  health.rotation_sigma = std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
  if (mission_) {
    health.suspended = mission_->suspension().count();
    health.distance_since_offline = mission_->distance_since_offline();
    health.seconds_since_offline = to_seconds(frame.time - mission_->last_offline_time().value_or(*first_frame_));
  }
  if (located.track) {
    const HybridTrack& track = *located.track;
    health.offline_expected = track.offline_expected;
    health.offline_matches = track.offline_matches;
    health.offline_inliers = track.offline_inliers;
    health.online_inliers = track.online_inliers();
    health.inlier_share = static_cast<double>(track.tracked.features.size()) / std::max(1, track.tracked.matches);
    health.spread = spread_of(track.tracked.features, rig_);
    if (track.from_offline && track.from_online) {
      health.agreement = agreement_of(*track.from_offline, *track.from_online);
    }
  }
  return judged(health, evidence, options_.health);
}

void Session::tell_navigation_error(double seconds_without_pose, FrameReport& report) {
  const bool is_lost = mission_ ? seconds_without_pose >= options_.state.lost_after : state_ == State::lost;
  if (is_lost && !navigation_error_told_) report.events.push_back(SessionEvent::navigation_error);
  navigation_error_told_ = is_lost;
}

}  // namespace byre
