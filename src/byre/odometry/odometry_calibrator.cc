#include "byre/odometry/odometry_calibrator.h"

#include "byre/geometry/median.h"
#include "byre/odometry/time_offset.h"
#include "byre/odometry/wheel_estimate.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kStride = 500ms;  // length of the compared motions
constexpr std::size_t kMostMotions = 240;
constexpr int kMotionsPerEstimate = 4;
constexpr int kEstimatesUntilUsed = 24;        // the first estimates determine delay and bias badly
constexpr int kConfirmed = 4;                  // motions until the calibration of an earlier drive counts as confirmed
constexpr int kEstimatesUntilStored = 8;       // estimates of a calibration until it is kept
constexpr std::size_t kMotionsPerOffset = 30;  // motions per estimate of a calibration for each estimate of the delay
constexpr double kMeasuredTilt = 0.03;         // radians, standard deviation of an up axis measured at standstill
constexpr double kLeastInitialWay = 0.3;       // metres, sum of all paths of the first estimate

// Stores the gyroscope's turns of the motions since the last estimation.
void add_gyroscope_rotations(const RateTrack& rates, std::deque<VisualMotion>& seen) {
  for (auto motion = seen.rbegin(); motion != seen.rend() && !motion->gyroscope_turn; ++motion) {
    const auto turn = rates.between(motion->earlier, motion->later, Eigen::Vector3d::Zero());
    if (turn) motion->gyroscope_turn = rotation_log(*turn);
  }
}

// The body goes on at its visual velocity.
BodyMotion predict_from_images(const Vector6& velocity, double seconds) {
  constexpr double kShare = 0.3;         // share of the path length
  constexpr double kAcceleration = 1.0;  // lengths of the map per second squared
  const Pose motion = exp_pose(velocity * seconds);
  const double sigma = kShare * motion.translation.norm() + 0.5 * kAcceleration * seconds * seconds;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal().head<3>().setConstant(sigma * sigma);
  return {motion, covariance};
}

}  // namespace

void OdometryCalibrator::begin_with(const OdometryCalibration& known) {
  prior_.calibration = known;
  if (known.wheels) prior_.calibration.wheels = as_prior(*known.wheels);
  wheel_calibration_ = known.wheels;
  stationary_.begin_with(known.up);
  if (known.wheels) set_time_offset(known.time_offset);
}

void OdometryCalibrator::begin_with_extrinsics(const WheelCalibration& measured, std::optional<double> time_offset) {
  constexpr double kTilt = 0.1;  // radians, largest standard deviation of a known up axis
  if (measured.tilt_sigma() < kTilt) up_in_body_ = measured.up_in_body();
  if (time_offset) set_time_offset(*time_offset);
  if (prior_.calibration.wheels && !is_contradicted(measured, *wheel_calibration_)) return;
  prior_.calibration.wheels = measured;
  prior_.is_measured = true;
  wheel_calibration_ = is_determined(measured, kMaxEstimateSigma) ? std::optional(measured) : std::nullopt;
}

void OdometryCalibrator::forget_scale() {
  if (!prior_.is_measured || !prior_.calibration.wheels) return;
  prior_.calibration.wheels = with_unknown_scale(*prior_.calibration.wheels);
  wheel_calibration_.reset();
}

void OdometryCalibrator::begin_metric(const VisualMotion& first) {
  metric_start_ = first;
  if (prior_.calibration.wheels || !assumed_forward_) return;
  prior_.calibration.wheels = assumed_forward_;
  prior_.is_assumed = true;
}

// Forgets old samples also while no frame arrives.
void OdometryCalibrator::add(const StampedPose& wheels) {
  const bool was_ignored = check_.are_wheels_ignored();
  const auto [is_clock_set_back, beginning, sample] = check_.check(wheels);
  if (is_clock_set_back || (!was_ignored && check_.are_wheels_ignored())) drop_wheels();
  if (beginning) wheels_.begin_segment(*beginning);
  if (!sample) return;
  wheels_.add(*sample);
  wheels_.forget_before(sample->time - kMostKept);
}

void OdometryCalibrator::add(const BaseTwist& wheels) {
  const bool was_ignored = check_.are_wheels_ignored();
  const StampCheck::Order order = check_.check(wheels);
  if (order == StampCheck::Order::restarted || (!was_ignored && check_.are_wheels_ignored())) drop_wheels();
  if (order == StampCheck::Order::dropped) return;
  wheels_.add(wheels);
  wheels_.forget_before(wheels.time - kMostKept);
}

void OdometryCalibrator::add(const Acceleration& acceleration) {
  const StampCheck::Order order = check_.check(acceleration);
  if (order != StampCheck::Order::dropped) stationary_.add(acceleration);
}

// Forgets the samples of wheels; once wheels are ignored, also the calibration found on this drive.
void OdometryCalibrator::drop_wheels() {
  wheels_ = {};
  if (check_.are_wheels_ignored()) {
    wheel_calibration_.reset();
    initial_.reset();
  }
}

void OdometryCalibrator::drop_gyroscope() {
  rates_ = {};
  gyroscope_.reset();
  given_gyroscope_.reset();
  measured_up_.reset();
  for (VisualMotion& motion : seen_) motion.gyroscope_turn.reset();
}

void OdometryCalibrator::add(const AngularRate& rate) {
  const StampCheck::Order order = check_.check(rate);
  if (order == StampCheck::Order::dropped) return;
  if (order == StampCheck::Order::restarted) rates_ = {};
  rates_.add(rate);
  stationary_.add(rate);
  rates_.forget_before(rate.time - kMostKept);
}

void OdometryCalibrator::set_gyroscope_extrinsics(const Eigen::Quaterniond& body_from_gyroscope) {
  constexpr double kSigma = 0.03;   // radians
  constexpr double kMostOff = 0.1;  // largest error of the length 1
  if (!(std::abs(body_from_gyroscope.norm() - 1.0) < kMostOff)) {
    return warn({MotionSensor::gyroscope,
                 {},
                 "the rotation of the mounting is not finite or not of length 1; it is ignored",
                 "give a unit quaternion"});
  }
  given_gyroscope_ = GyroscopeCalibration{.body_from_gyroscope = body_from_gyroscope.normalized(),
                                          .covariance = kSigma * kSigma * Eigen::Matrix3d::Identity()};
}

void OdometryCalibrator::update_standstill(Timestamp time, const std::optional<Pose>& seen) {
  constexpr double kMostSigma = 0.1;  // radians
  stationary_.note_visual_pose(time, seen);
  const auto bias = gyroscope_ ? std::optional(gyroscope_->bias) : std::nullopt;
  const double metres_per_unit = wheel_calibration_ ? wheel_calibration_->metres_per_unit : 1.0;
  const auto steady = stationary_.at(
      time, {are_wheels_stationary(odometry(), time), stationary_.are_poses_stationary(metres_per_unit)}, bias);
  stationary_.note(time, steady);
  if (!steady) return;
  if (!seen && gyroscope_) gyroscope_->bias = steady->rate;
  const auto& gyroscope = gyroscope_                     ? gyroscope_
                          : prior_.calibration.gyroscope ? prior_.calibration.gyroscope
                                                         : given_gyroscope_;
  if (!gyroscope) return;
  const UpInBody up = up_in_body(*steady, *gyroscope);
  if (up.sigma > kMostSigma) return;
  measured_up_ = up.up;
}

std::optional<BodyTilt> OdometryCalibrator::tilt(Timestamp time) const {
  return stationary_.tilt(time, standstill_by_wheels(odometry(), time), gyroscope_);
}

// Compares the gyroscope with turns in images, else with turns of wheels. Drops it if it is faulty.
void OdometryCalibrator::compare_turns(Timestamp time, const std::optional<VisualMotion>& seen) {
  MotionCheck::Turn turn{time, Eigen::Vector3d::Zero(), {}, seen.has_value()};
  const Timestamp begin = seen ? seen->earlier : turns_compared_.value_or(time);
  if (!turns_compared_ || seen) turns_compared_ = time;
  if (time - begin < kStride) return;
  turns_compared_ = time;
  if (seen) {
    turn.reference = rotation_log(seen->body.rotation);
  } else {
    const auto base = base_between(odometry(), begin, time);
    if (!base) return;
    turn.reference = rotation_log(base->rotation);
  }
  turn.measured = rates_.integral(begin, time);
  if (check_.note(turn)) drop_gyroscope();
}

void OdometryCalibrator::note(Timestamp time, const std::optional<Pose>& odometry_from_body) {
  if (is_empty() && !check_.is_gyroscope_silent()) return;
  update_standstill(time, odometry_from_body);
  gaps_.note(time, odometry_from_body.has_value());
  forget_old_samples();
  if (!odometry_from_body) {
    begin_.reset();
    last_.reset();
    compare_turns(time, {});
    return;
  }
  const StampedPose now{time, *odometry_from_body};
  predicts_before_tracking_ = false;
  if (last_ && time - last_->time <= kMaxFrameGap) {
    velocity_ = log_pose(inverse(last_->world_from_body) * now.world_from_body) / to_seconds(time - last_->time);
  } else {
    begin_.reset();
  }
  last_ = now;
  if (!begin_) begin_ = now;
  if (time - begin_->time < kStride) return;
  const VisualMotion motion{begin_->time, time, inverse(begin_->world_from_body) * now.world_from_body, focal_change_};
  begin_ = now;
  compare_turns(time, motion);
  detect_slip(motion);
  seen_.push_back(motion);
  if (seen_.size() > kMostMotions) seen_.pop_front();
  if (++motions_since_estimate_ >= kMotionsPerEstimate) estimate_calibrations();
  update_initial_calibration();
}

// Keeps the samples of untracked frames until the calibration of wheels is estimated.
void OdometryCalibrator::forget_old_samples() {
  if (!gaps_.last()) return;
  const Timestamp now = *gaps_.last();
  const Timestamp pending = wheels_.empty() ? now : gaps_.first_pending().value_or(now);
  const Timestamp oldest = std::max(std::min(now - samples_kept_, pending - 1s), now - kMostKept);
  wheels_.forget_before(oldest);
  rates_.forget_before(oldest);
}

void OdometryCalibrator::estimate_calibrations() {
  motions_since_estimate_ = 0;
  if (!rates_.empty()) {
    add_gyroscope_rotations(rates_, seen_);
    auto found = estimate_gyroscope_calibration(seen_, prior_.calibration.gyroscope);
    if (!found && prior_.calibration.gyroscope) found = estimate_gyroscope_calibration(seen_);
    if (found) gyroscope_ = found;
  }
  if (wheels_.empty()) return;
  estimate_wheels();
  if (!wheel_calibration_) return;
  // The delay costs most: its estimates become rarer with the number of motions.
  const auto period = static_cast<int>(1 + seen_.size() / kMotionsPerOffset);
  if (estimates_++ % period == 0) estimate_time_offset(seen_, wheel_calibration_->up_in_body());
  if (estimates_ >= kEstimatesUntilUsed || prior_.calibration.wheels) integrate(gaps_);
}

bool OdometryCalibrator::reestimate(const Trajectory& seen, bool may_finish_again) {
  stationary_.reestimate(seen);
  if (wheels_.empty() || seen.empty()) return false;
  const std::deque<VisualMotion> motions = gaps_.motions_between_gaps(seen, kStride);
  const bool was_known = wheel_calibration_.has_value();
  reestimate(motions);
  const auto prior = prior_.is_measured ? prior_of_map() : std::nullopt;
  const auto better = prior ? better_without_prior(pairs_of(motions, odometry()), *prior) : std::nullopt;
  const bool is_dropped = better && is_contradicted(*prior, *better);
  if (is_dropped) {
    discard_prior_wheels(seen.back().time);
    reestimate(motions);
  }
  if (!may_finish_again) return false;
  if (is_dropped && wheel_calibration_) return true;
  if (!better && (was_known || wheel_calibration_)) return false;
  const auto rough = estimate_wheel_calibration(pairs_of(motions, odometry()));
  if (!is_determined(rough, kMaxFirstEstimateSigma)) return false;
  set_wheels(*rough);
  return true;
}

std::optional<WheelCalibration> OdometryCalibrator::prior_of_map() const {
  const auto& known = prior_.calibration.wheels;
  return known && !is_metric_ ? std::optional(with_unknown_scale(*known)) : known;
}

// The delay first, because turns measured too late hide the calibration. It needs the base's up axis alone.
void OdometryCalibrator::reestimate(const std::deque<VisualMotion>& motions) {
  const auto prior = prior_of_map();
  const auto rough = wheel_calibration_ ? wheel_calibration_
                                        : estimate_wheel_calibration(pairs_of(motions, odometry()),
                                                                     prior.value_or(unknown_wheel_calibration()));
  if (!rough) return;
  estimate_time_offset(motions, rough->up_in_body());
  const std::vector<MotionPair> pairs = pairs_of(motions, odometry());
  const auto found = prior ? estimate_with_prior(pairs, *prior) : estimate_without_prior(pairs);
  if (found) set_wheels(*found);
  if (is_metric_ || !wheel_calibration_) return;
  double& variance = wheel_calibration_->covariance(6, 6);
  variance = std::max(variance, std::pow(scale_scatter(pairs, *wheel_calibration_), 2));
}

std::optional<OdometryCalibrator::TurnRatio> OdometryCalibrator::turn_ratio() const {
  constexpr double kSmall = 0.08;     // radians, turns with a poorly determined ratio
  constexpr std::size_t kLeast = 8;   // turns
  constexpr double kOfMedian = 1.25;  // sigma of a median over that of a mean, normal distribution
  std::vector<double> ratios;
  for (const VisualMotion& motion : seen_) {
    const auto base = base_between(odometry(), motion.earlier, motion.later);
    const double turn = base ? rotation_log(base->rotation).norm() : 0.0;
    if (turn > kSmall) ratios.push_back(motion.focal_change * rotation_log(motion.body.rotation).norm() / turn);
  }
  if (ratios.size() < kLeast) return {};
  const double value = median(ratios);
  std::vector<double> deviations;
  for (const double ratio : ratios) deviations.push_back(std::abs(ratio - value) / value);
  const double sigma =
      kSigmasOfMedian * median(std::move(deviations));  // for one turn, by the median absolute deviation
  return TurnRatio{value, kOfMedian * sigma / std::sqrt(static_cast<double>(ratios.size()))};
}

void OdometryCalibrator::rescale(double factor) {
  OdometryCalibration found;
  found.wheels = wheel_calibration_;
  wheel_calibration_ = scaled(std::move(found), factor).wheels;
  prior_.calibration = scaled(prior_.calibration, factor);
}

// Motions since the last large change of the focal length, which distorts all earlier ones, and the one that gave the
// map its unit.
std::deque<VisualMotion> OdometryCalibrator::undistorted_motions() const {
  constexpr double kChange = 0.02;  // natural logarithm
  std::deque<VisualMotion> motions;
  if (metric_start_) motions.push_back(*metric_start_);
  std::ranges::copy_if(seen_, std::back_inserter(motions), [this](const VisualMotion& motion) {
    return std::abs(std::log(motion.focal_change / focal_change_)) < kChange;
  });
  return motions;
}

// The noise and the drift of scale of one camera exceed the errors of wheels, so their difference is not that of
// wheels.
void OdometryCalibrator::set_wheels(WheelCalibration found) {
  constexpr double kUsualError = 0.03;  // share of the path length
  if (!is_metric_) found.translation_error = std::min(found.translation_error, kUsualError);
  wheel_calibration_ = found;
}

// Motions that determine the calibration without the prior are compared with it.
void OdometryCalibrator::estimate_wheels() {
  constexpr int kLooks = 3;  // consecutive contradictions
  const std::vector<MotionPair> all = pairs_of(undistorted_motions(), odometry());
  const auto alone = estimate_without_prior(all);
  if (prior_.calibration.wheels && alone) {
    prior_.contradicting_estimates =
        is_contradicted(*prior_.calibration.wheels, *alone) ? prior_.contradicting_estimates + 1 : 0;
    if (prior_.contradicting_estimates >= kLooks) discard_prior_wheels(seen_.back().later);
  }
  const bool uses_prior = prior_.calibration.wheels && (!prior_.is_assumed || determine_calibration(all));
  const auto found = uses_prior ? estimate_with_prior(all, *prior_.calibration.wheels) : alone;
  if (found) set_wheels(*found);
  if (!is_metric_ || !alone || seen_.empty()) return;
  if (check_.note_wheel_scale(alone->metres_per_unit, alone->scale_sigma(), seen_.back().later)) drop_wheels();
}

// Derived from the first seconds, and updated with each motion until the calibration is estimated. A prior without a
// scale is in use once motions determine it.
void OdometryCalibrator::update_initial_calibration() {
  constexpr std::size_t kLeastMotions = 2;
  constexpr double kTilt = 0.2;        // radians, of a camera that is upright
  constexpr double kLeastError = 0.1;  // share of path lengths and turns
  initial_.reset();
  if (wheel_calibration_ || seen_.size() < kLeastMotions) return;
  const std::vector<MotionPair> all = pairs_of(undistorted_motions(), odometry());
  if (way_of(all) < kLeastInitialWay) return;
  if (prior_.calibration.wheels && !prior_.is_assumed) {
    if (const auto found = estimate_with_prior(all, *prior_.calibration.wheels)) set_wheels(*found);
    return;
  }
  if (prior_.is_assumed) initial_ = estimate_wheel_calibration(all, *prior_.calibration.wheels);
  if (!initial_ && measured_up_)
    initial_ = estimate_wheel_calibration(all, upright_wheel_calibration(*measured_up_, kMeasuredTilt));
  if (!is_determined(initial_, kMaxFirstEstimateSigma) && up_in_body_) {
    initial_ = estimate_wheel_calibration(all, upright_wheel_calibration(*up_in_body_, kTilt));
  }
  if (!is_determined(initial_, kMaxFirstEstimateSigma)) return initial_.reset();
  initial_->translation_error = std::max(initial_->translation_error, kLeastError);
  initial_->rotation_error = std::max(initial_->rotation_error, kLeastError);
}

const WheelCalibration* OdometryCalibrator::active_calibration() const {
  if (wheel_calibration_) return &*wheel_calibration_;
  if (initial_) return &*initial_;
  if (!predicts_before_tracking_) return nullptr;
  if (prior_.calibration.wheels) return &*prior_.calibration.wheels;
  return assumed_forward_ ? &*assumed_forward_ : nullptr;
}

// An earlier calibration that most motions contradict from the start is wrong. Slip does not last as long.
void OdometryCalibrator::check_prior(double disagreement, const VisualMotion& motion) {
  constexpr double kMinPath = 0.1;      // metres
  constexpr double kMinRotation = 0.1;  // radians
  constexpr int kContradicting = 12;    // motions
  const double way = wheel_calibration_->metres_per_unit * motion.body.translation.norm();
  if (way < kMinPath && rotation_log(motion.body.rotation).norm() < kMinRotation) return;
  ++(disagreement > 1.0 ? prior_.contradicting : prior_.confirming);
  if (prior_.contradicting < kContradicting || prior_.contradicting <= 2 * prior_.confirming) return;
  if (!prior_.is_assumed) return discard_prior_wheels(motion.later);
  wheel_calibration_.reset();  // the first estimate; the assumption is wider
  prior_.contradicting = prior_.confirming = 0;
}

void OdometryCalibrator::discard_prior_wheels(Timestamp time) {
  if (prior_.is_measured) {
    warn({MotionSensor::wheels, time,
          "motions contradict the given extrinsics of camera and base; these are dropped, and estimated from motions",
          "compare the given pose of the camera on the base with the one that the report of the run shows"});
  }
  const bool was_assumed = prior_.is_assumed;
  prior_.is_measured = prior_.is_assumed = false;
  prior_.calibration.wheels.reset();
  wheel_calibration_.reset();
  time_offset_.reset();
  estimates_ = 0;
  slip_.is_present = false;
  has_calibration_changed_ = !was_assumed;
}

void OdometryCalibrator::estimate_time_offset(const std::deque<VisualMotion>& seen, const Eigen::Vector3d& up_in_body) {
  const auto offset = find_time_offset(seen, up_in_body, wheels_, time_offset_);
  if (offset) set_time_offset(*offset);
}

void OdometryCalibrator::set_time_offset(double seconds) {
  constexpr double kSigma = 0.005;  // seconds
  time_offset_ = seconds;
  time_offset_sigma_ = kSigma;
}

OdometryCalibration OdometryCalibrator::calibration_to_store() const {
  OdometryCalibration keep = prior_.calibration;
  if (prior_.is_assumed) keep.wheels.reset();
  const bool is_well_known = estimates_ >= kEstimatesUntilStored || keep.wheels;
  if (wheel_calibration_ && is_well_known) {
    keep.wheels = wheel_calibration_;
    keep.time_offset = time_offset();
  }
  if (gyroscope_) keep.gyroscope = gyroscope_;
  keep.up = stationary_.up_in_map(gyroscope_);
  return keep;
}

// Precondition: the calibration of wheels is estimated or assumed.
void OdometryCalibrator::integrate(GapTrajectory& gaps) const {
  gaps.integrate([measured = odometry()](Timestamp earlier, Timestamp later) {
    return base_path_between(measured, earlier, later);
  });
}

Trajectory OdometryCalibrator::fill_gaps(Trajectory seen) const {
  const WheelCalibration* const calibration = active_calibration();
  if (calibration == nullptr) return seen;
  GapTrajectory gaps = gaps_;
  integrate(gaps);
  const auto body_motion_of = [&](const Pose& base) { return body_motion(*calibration, base); };
  return gaps.fill_gaps(std::move(seen), body_motion_of, old_poses_);
}

void OdometryCalibrator::detect_slip(const VisualMotion& motion) {
  constexpr int kAgreeing = 2;  // agreeing motions that end the slip
  if (!wheel_calibration_) return;
  const auto base = base_between(odometry(), motion.earlier, motion.later);
  if (!base) return;
  const Pose measured = body_motion(*wheel_calibration_, without_turn_errors(wheel_calibration_->turn_errors, *base));
  const double difference = disagreement(measured, motion, wheel_calibration_->metres_per_unit);
  if (prior_.calibration.wheels) check_prior(difference, motion);
  if (!wheel_calibration_) return;
  if (difference > 1.0) {
    if (!slip_.is_present) ++slip_.count;
    slip_.is_present = true;
    slip_.agreeing = 0;
  } else if (++slip_.agreeing >= kAgreeing) {
    slip_.is_present = false;
  }
}

CalibratedOdometry OdometryCalibrator::odometry() const {
  return {wheels_,
          rates_,
          stationary_,
          active_calibration(),
          gyroscope_,
          time_offset(),
          time_offset_sigma_,
          slip_.is_present,
          prior_.calibration.wheels && prior_.confirming < kConfirmed};
}

std::optional<BodyMotion> OdometryCalibrator::between(Timestamp earlier, Timestamp later) const {
  constexpr Timestamp kLongest = 1s;
  const bool is_recent = velocity_ && !seen_.empty() && later - seen_.back().later <= kLongest + kStride;
  return motion_between(
      odometry(), earlier, later,
      is_recent ? std::optional(predict_from_images(*velocity_, to_seconds(later - earlier))) : std::nullopt);
}

std::optional<BodyMotion> OdometryCalibrator::path_between(Timestamp earlier, Timestamp later) const {
  return byre::path_between(odometry(), earlier, later);
}

std::optional<double> OdometryCalibrator::reach(Timestamp earlier, Timestamp later, bool is_metric) const {
  constexpr double kUsualArm = 1.0;  // metres, before it is estimated
  if (active_calibration() == nullptr && !is_metric) return {};
  const double arm = wheel_calibration_ ? wheel_calibration_->base_from_body.translation.norm() : kUsualArm;
  return reach_between(odometry(), earlier, later, arm);
}

}  // namespace byre
