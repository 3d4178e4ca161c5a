#include "byre/slam/frame/health.h"

#include "byre/base/enum_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr std::string_view kImpossible =
    "set the initial pose, move the robot to a distinctive place, or check the floor plan";

// Name and advice of each reason, in their order.
constexpr auto kReasons = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"none", ""},
    {"no pose", "move the robot into the mapped area"},
    {"blinded", "check for covered lenses, darkness and glare"},
    {"not registered in the map", "drive on through mapped places"},
    {"not confirmed yet", "drive on: other parts of the map in view confirm the place"},
    {"far outside the mapped area", "return to the mapped area, or extend the map (byre map --extend)"},
    {"too few points", "check light and lenses, and turn to things with texture"},
    {"too few offline points", "extend the map, as much has changed here"},
    {"points are clustered", "turn to things with texture in more of the image"},
    {"pose is uncertain", "approach mapped things, or drive on"},
    {"offline and online points disagree", "drive on; if things were moved for good, extend the map"},
    {"camera repeats its image", "restart the camera's driver"},
    {"right camera is blinded", "check lens and exposure of the right camera"},
    {"left and right images do not fit",
     "check whether the cameras are synchronised, swapped or displaced; calibrate them"},
    {"calibration does not fit the map", "calibrate the cameras"},
    {"bridged by wheels or a gyroscope",
     "check for covered lenses and darkness; dead reckoning by wheels is usable for some metres only"},
    {"dirt hides most of the image", "clean the lens"},
    {"map file is damaged", "replace the map file by a copy and load it again"},
    {"place found is off the driving plane", kImpossible},
    {"place found is inside a wall", kImpossible},
    {"place found is outside of the building", kImpossible},
    {"place found is behind a wall", kImpossible},
});
static_assert(kReasons.size() == static_cast<std::size_t>(DistrustReason::behind_wall) + 1);

constexpr int kManyOfflinePoints = 80;     // expected offline points, from which some must be found
constexpr double kMostHidden = 2.0 / 3.0;  // share of the image; one moved object may fill the rest
constexpr double kFar = 1.0;               // metres of path without offline points
constexpr double kMinOfflineShare = 0.02;  // share of expected points; fewer agree by chance in repetitive buildings

// Fault of the input that may explain a lost pose; none without one.
DistrustReason fault_of_input(const HealthEvidence& evidence) {
  if (evidence.image_fault != ImageFault::none) return DistrustReason::blinded;
  if (evidence.input.is_repeated || evidence.input.is_frozen) return DistrustReason::frozen;
  if (evidence.is_miscalibrated) return DistrustReason::calibration;
  if (evidence.input.right_fault != ImageFault::none) return DistrustReason::right_camera;
  return evidence.input.cameras_disagree ? DistrustReason::cameras_disagree : DistrustReason::none;
}

// Reason against a dead-reckoned pose; none while its error is bounded.
DistrustReason distrust_of_bridge(const Health& health, const HealthEvidence& evidence, const HealthOptions& options) {
  const bool is_open = options.sigmas * health.position_sigma > options.trusted_error ||
                       options.sigmas * health.rotation_sigma > options.max_bridged_rotation;
  return is_open || *evidence.bridged_from == Verdict::untrusted ? DistrustReason::bridged : DistrustReason::none;
}

// Reason why the pose is untrusted; none otherwise.
DistrustReason distrust_reason(const Health& health, const HealthEvidence& evidence, const HealthOptions& options) {
  if (evidence.bridged_from) return distrust_of_bridge(health, evidence, options);
  if (!evidence.pose_found || !evidence.registered) {
    const DistrustReason cause = fault_of_input(evidence);
    if (cause != DistrustReason::none && !(evidence.pose_found && cause == DistrustReason::blinded)) return cause;
    if (evidence.pose_found) return DistrustReason::not_registered;
    return evidence.refused_place != DistrustReason::none ? evidence.refused_place : DistrustReason::no_pose;
  }
  if (evidence.input.frozen_seconds > options.max_frozen) return DistrustReason::frozen;
  if (evidence.is_miscalibrated) return DistrustReason::calibration;
  if (!evidence.confirmed) return DistrustReason::unconfirmed;
  if (position_error(health, options) > options.trusted_error) {
    return health.distance_since_offline > kFar ? DistrustReason::off_the_map : DistrustReason::uncertain;
  }
  return DistrustReason::none;
}

bool misses_offline_points(const Health& health, const HealthOptions& options) {
  if (health.offline_expected < kManyOfflinePoints) return false;
  const bool held_by_chance = health.offline_inliers >= options.min_offline_points &&
                              health.offline_inliers < kMinOfflineShare * health.offline_expected;
  const bool not_held =
      health.offline_inliers < options.min_offline_points && health.distance_since_offline > options.max_changed_path;
  return held_by_chance || not_held;
}

// Reason why the pose is degraded; none otherwise.
DistrustReason caution_reason(const Health& health, const HealthEvidence& evidence, const HealthOptions& options) {
  if (evidence.bridged_from) return DistrustReason::bridged;
  const DistrustReason input = fault_of_input(evidence);
  if (input != DistrustReason::none && input != DistrustReason::blinded) return input;
  if (evidence.is_calibration_doubtful) return DistrustReason::calibration;
  if (evidence.is_calibration_open) return DistrustReason::unconfirmed;
  if (evidence.maps_disagree && health.agreement && health.agreement->translation > options.max_disagreement) {
    return DistrustReason::maps_disagree;
  }
  if (health.offline_inliers + health.online_inliers < options.min_points) {
    return evidence.image_fault == ImageFault::none ? DistrustReason::few_points : DistrustReason::blinded;
  }
  if (evidence.is_dirty || is_mostly_hidden(health.hidden_share)) return DistrustReason::dirty;
  if (health.spread < options.min_spread) return DistrustReason::clustered;
  if (health.rotation_sigma > options.max_rotation_sigma) return DistrustReason::uncertain;
  return misses_offline_points(health, options) ? DistrustReason::few_offline_points : DistrustReason::none;
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  return name_among<Verdict::untrusted>({"trusted", "degraded", "untrusted"}, verdict);
}

std::string_view to_string(DistrustReason doubt) {
  return kReasons.at(static_cast<std::size_t>(doubt)).first;
}

std::string_view advice_for(DistrustReason doubt) {
  return kReasons.at(static_cast<std::size_t>(doubt)).second;
}

std::string note_on_dirt(const Health& health) {
  const auto hidden = [](double share, const char* image) {
    return std::to_string(std::max(1L, std::lround(100.0 * share))) + " % of the " + image + " image";
  };
  const bool is_left = health.hidden_share > 0.0, is_right = health.hidden_share_right > 0.0;
  if (!is_left && !is_right) return "";
  std::string text = "dirt hides ";
  if (is_left) text += hidden(health.hidden_share, "left");
  if (is_left && is_right) text += " and ";
  if (is_right) text += hidden(health.hidden_share_right, "right");
  return text + (is_left && is_right ? ": clean the lenses" : ": clean the lens");
}

bool is_mostly_hidden(double hidden_share) {
  return hidden_share > kMostHidden;
}

HealthEvidence FaultLatches::latch(Timestamp time, const HealthEvidence& evidence) {
  const auto note = [time](FaultLatch& doubt, Sign sign) {
    doubt.note(time, sign);
    return doubt.is_raised();
  };
  const auto where_seen = [&](bool is_present) {
    return is_present || evidence.pose_found ? sign_of(is_present) : Sign::unclear;
  };
  const InputEvidence& input = evidence.input;
  const bool is_seen = evidence.image_fault == ImageFault::none;
  const Sign still_or_frozen = input.is_frozen ? Sign::present : input.is_still ? Sign::unclear : Sign::absent;
  const bool is_right_faulty = input.right_fault != ImageFault::none;
  if (is_right_faulty) right_fault_ = input.right_fault;
  const bool is_at_odds = input.cameras_disagree || input.out_of_sync == Sign::present;
  if (is_at_odds) may_be_timing_ = !input.is_still || (may_be_timing_ && cameras_disagree_.is_raised());
  const Sign in_agreement = may_be_timing_ || !is_seen ? input.out_of_sync : Sign::absent;
  HealthEvidence result = evidence;
  result.input.is_repeated = note(repeated_, sign_of(input.is_repeated));
  result.input.is_frozen = note(frozen_, is_seen ? still_or_frozen : Sign::unclear);
  if (note(right_camera_, is_seen ? sign_of(is_right_faulty) : Sign::unclear)) result.input.right_fault = right_fault_;
  result.input.cameras_disagree = note(cameras_disagree_, is_at_odds ? Sign::present : in_agreement);
  result.is_miscalibrated = note(miscalibrated_, where_seen(evidence.is_miscalibrated));
  result.is_dirty = note(dirty_, where_seen(evidence.is_dirty));
  return result;
}

double position_error(const Health& measured, const HealthOptions& options) {
  return std::hypot(options.sigmas * measured.position_sigma, options.drift_share * measured.distance_since_offline);
}

Health assess(const Health& measured, const HealthEvidence& evidence, const HealthOptions& options) {
  Health health = measured;
  health.doubt = distrust_reason(measured, evidence, options);
  health.verdict = Verdict::untrusted;
  if (health.doubt != DistrustReason::none) return health;
  health.doubt = caution_reason(measured, evidence, options);
  health.verdict = health.doubt == DistrustReason::none ? Verdict::trusted : Verdict::degraded;
  return health;
}

}  // namespace byre
