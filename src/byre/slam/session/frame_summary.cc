#include "byre/slam/session/frame_summary.h"

#include "byre/base/enum_names.h"
#include "byre/geometry/finite.h"
#include "byre/slam/places/localisation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// Inflation for the correlation between errors of points and keyframes, which their covariances neglect; measured on
// simulated missions.
constexpr double kNeglectedCorrelation = 1.1;

Matrix6 body_covariance(const Matrix6& camera_covariance, const Rig& rig) {
  return kNeglectedCorrelation * move_covariance(camera_covariance, rig.body_from_camera);
}

// Covariance of the matches plus the drift of stereo odometry.
Matrix6 odometry_covariance(const Matrix6& match_covariance, double travelled) {
  constexpr double kDriftShare = 0.005;
  constexpr double kTurnPerMetre = 0.0005;  // radians
  Matrix6 covariance = match_covariance;
  covariance.topLeftCorner<3, 3>().diagonal().array() += std::pow(kDriftShare * travelled, 2);
  covariance.bottomRightCorner<3, 3>().diagonal().array() += std::pow(kTurnPerMetre * travelled, 2);
  return covariance;
}

// In a mission the covariance of the offline map's frame is added. If offline points constrain the pose, the covariance
// of the online keyframes does not apply.
Matrix6 covariance_in_map(const TrackedFrame& tracked, const OfflineTracker* mission) {
  if (!mission) return tracked.covariance;
  const bool is_online = tracked.reference.origin == Origin::online;
  return (is_online ? tracked.covariance : tracked.match_covariance) + mission->mission().offline().frame_covariance();
}

Health measured(const HybridTrack& track, const Rig& rig) {
  Health health;
  health.offline_expected = track.offline_expected;
  health.offline_matches = track.offline_matches;
  health.offline_inliers = track.offline_inliers;
  health.online_inliers = track.online_inliers();
  health.inlier_share = static_cast<double>(track.tracked.features.size()) / std::max(1, track.tracked.matches);
  health.spread = spread_of(track.tracked.features, rig);
  if (track.from_offline && track.from_online) health.agreement = agreement_of(*track.from_offline, *track.from_online);
  return health;
}

// Without an offline map the self-calibration detects a wrong calibration, after its first run.
HealthEvidence add_calibration_evidence(const Calibrator& calibrator, HealthEvidence evidence) {
  const auto& result = calibrator.result();
  evidence.is_calibration_open = calibrator.is_open();
  evidence.is_calibration_doubtful = result && result->was_refused();
  if (result && result->is_implausible()) evidence.is_miscalibrated = true;
  return evidence;
}

// Poses of a frame without a visual pose, by measured motion since the last visual one.
FrameReport bridged(FrameReport report, const FrameSummary& summary) {
  const PoseFilter& pose_filter = summary.pose_filter;
  const BodyMotion bridge = *pose_filter.bridge();
  if (summary.is_bridged_in_map()) {
    report.map_from_body = pose_filter.odometry().map_from_body();
    report.covariance = pose_filter.covariance_of_bridge();
  }
  report.odometry_from_body = pose_filter.odometry().odometry_from_body();
  report.odometry_covariance =
      move_covariance(pose_filter.quality_before().odometry_covariance, inverse(bridge.last_from_body)) +
      bridge.covariance;
  return report;
}

}  // namespace

std::string_view to_string(InputFault fault) {
  return name_among<InputFault::after_finishing>(
      {"none", "frame after a gap", "right image is missing", "right image has another time stamp",
       "depth image is missing", "depth image has another time stamp", "no image",
       "image does not have the calibrated size", "image has the wrong format", "features are invalid",
       "time stamp repeats the previous frame", "time stamp is before the previous frame",
       "newer frames were submitted", "frame after finishing the map"},
      fault);
}

HealthEvidence evidence_of(const FrameSummary& summary) {
  const PlaceHypothesis& place = summary.pose_filter.place();
  HealthEvidence evidence{summary.pose_filter.has_pose(), summary.is_registered(),
                          place.is_confirmed() && place.is_accepted()};
  if (summary.is_bridged_in_map()) evidence.bridged_from = summary.pose_filter.quality_before().verdict;
  evidence.refused_place = summary.refused_place;
  evidence.maps_disagree = summary.track && summary.track->maps_disagree && !summary.track->offline_prevails;
  evidence.image_fault = summary.input.fault;
  evidence.input = summary.input.evidence;
  evidence.is_dirty = is_mostly_hidden(summary.dirt.hidden().share());
  evidence.is_miscalibrated = summary.mission && summary.mission->is_focal_length_off();
  const Calibrator* const calibrator = summary.mapper.calibrator();
  return calibrator ? add_calibration_evidence(*calibrator, evidence) : evidence;
}

FrameReport fill_poses(FrameReport report, const FrameSummary& summary) {
  const Odometry& odometry = summary.pose_filter.odometry();
  report.features = summary.input.frame.features->size();
  if (summary.pose_filter.has_pose()) {
    if (summary.is_registered()) report.map_from_body = odometry.map_from_body();
    report.odometry_from_body = odometry.odometry_from_body();
  }
  if (summary.pose_filter.bridge()) return bridged(std::move(report), summary);
  report.covariance = summary.pose_filter.carried_covariance() + summary.pose_filter.jump_covariance();
  if (summary.mission && (!summary.track || summary.track->depends_on_online)) {
    report.covariance += summary.pose_filter.drift_covariance(summary.mission->length_sigma());
  }
  if (!summary.track) return report;
  const TrackedFrame& tracked = summary.track->tracked;
  report.expected_points = tracked.expected;
  report.matches = tracked.matches;
  report.inliers = static_cast<int>(tracked.features.size());
  report.covariance += body_covariance(covariance_in_map(tracked, summary.mission), summary.rig);
  report.odometry_covariance =
      odometry_covariance(body_covariance(tracked.match_covariance, summary.rig), odometry.travelled()) +
      summary.pose_filter.bridged_odometry_covariance();
  return report;
}

void withhold_non_finite(FrameReport& report) {
  Health& health = report.health;
  if ((report.map_from_body && !is_finite(*report.map_from_body)) || !report.covariance.allFinite()) {
    report.map_from_body.reset();
    report.covariance.setZero();
    health.verdict = Verdict::untrusted;
    health.doubt = DistrustReason::no_pose;
  }
  if ((report.odometry_from_body && !is_finite(*report.odometry_from_body)) ||
      !report.odometry_covariance.allFinite()) {
    report.odometry_from_body.reset();
    report.odometry_covariance.setZero();
  }
  if (report.correction && !is_finite(*report.correction)) report.correction.reset();
  if (health.agreement && !std::isfinite(health.agreement->translation + health.agreement->rotation)) {
    health.agreement.reset();
  }
  for (double* const number : {&health.inlier_share, &health.spread, &health.position_sigma, &health.rotation_sigma,
                               &health.distance_since_offline, &health.seconds_since_offline, &health.focal_error,
                               &health.hidden_share, &health.hidden_share_right}) {
    if (!std::isfinite(*number)) *number = 0.0;
  }
}

Health health_of(const FrameSummary& summary, const Matrix6& covariance, const HealthEvidence& evidence,
                 const HealthOptions& options) {
  const Frame& frame = summary.input.frame;
  Health health = summary.track ? measured(*summary.track, summary.rig) : Health{};
  if (summary.mission) health = summary.mission->with_map_health(health, frame.time, summary.first_frame);
  health.hidden_share = summary.dirt.hidden().share();
  health.hidden_share_right = summary.dirt.hidden_right().share();
  health.image = frame.condition;
  health.position_sigma = std::sqrt(position_variance(covariance));
  health.rotation_sigma = std::sqrt(rotation_variance(covariance));
  return assess(health, evidence, options);
}

}  // namespace byre
