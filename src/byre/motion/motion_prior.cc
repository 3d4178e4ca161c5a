#include "byre/motion/motion_prior.h"

#include "byre/motion/motion_covariance.h"
#include "byre/motion/time_offset.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kStride = 500ms;  // length of the compared motions
constexpr std::size_t kMostMotions = 240;
constexpr int kMotionsPerLook = 4;
constexpr int kLooksUntilTold = 24;      // the first estimates determine delay and bias badly
constexpr int kBorneOut = 4;             // motions until the mounting of an earlier drive counts as confirmed
constexpr double kUnprovenFactor = 9.0;  // factor of the covariance until kBorneOut
constexpr int kLooksUntilKept = 8;       // estimates of a mounting until it is kept
constexpr int kLooksPerOffset = 8;  // estimates of a mounting per estimate of the delay: costly, and it changes least

// Whether wheels and gyroscope disagree about a turn, such as when a wheel spins or is lifted.
bool is_slip(const Eigen::Quaterniond& by_wheels, const Eigen::Quaterniond& by_gyroscope, double seconds) {
  constexpr double kRate = 0.1;   // radians per second
  constexpr double kShare = 0.2;  // share of the turn
  return angle_between(by_wheels, by_gyroscope) > kRate * seconds + kShare * rotation_log(by_gyroscope).norm();
}

}  // namespace

void MotionPrior::begin_with(const KnownMounting& known) {
  known_ = known;
  mounting_ = known.wheels;
  standing_.begin_with(known.up);
  if (known.wheels) time_offset_ = known.time_offset;
}

// Forgets old samples also while no frame arrives.
void MotionPrior::add(const StampedPose& wheels) {
  const bool was_ignored = check_.are_wheels_ignored();
  const auto [is_clock_set_back, beginning, sample] = check_.check(wheels);
  if (is_clock_set_back || (!was_ignored && check_.are_wheels_ignored())) drop_wheels();
  if (beginning) wheels_.begin_segment(*beginning);
  if (!sample) return;
  wheels_.add(*sample);
  wheels_.forget_before(sample->time - kMostKept);
}

void MotionPrior::add(const BaseVelocity& wheels) {
  const bool was_ignored = check_.are_wheels_ignored();
  const StampCheck::Order order = check_.check(wheels);
  if (order == StampCheck::Order::restarted || (!was_ignored && check_.are_wheels_ignored())) drop_wheels();
  if (order == StampCheck::Order::dropped) return;
  wheels_.add(wheels);
  wheels_.forget_before(wheels.time - kMostKept);
}

void MotionPrior::add(const Acceleration& acceleration) {
  const StampCheck::Order order = check_.check(acceleration);
  if (order != StampCheck::Order::dropped) standing_.add(acceleration);
}

// Forgets the samples of wheels; once wheels are ignored, also the mounting found on this drive.
void MotionPrior::drop_wheels() {
  wheels_ = {};
  if (check_.are_wheels_ignored()) {
    mounting_.reset();
    presumed_.reset();
  }
}

void MotionPrior::drop_gyroscope() {
  rates_ = {};
  gyroscope_.reset();
  presumed_gyroscope_.reset();
  measured_up_.reset();
  for (SeenMotion& motion : seen_) motion.gyroscope_turn.reset();
}

void MotionPrior::add(const AngularRate& rate) {
  const StampCheck::Order order = check_.check(rate);
  if (order == StampCheck::Order::dropped) return;
  if (order == StampCheck::Order::restarted) rates_ = {};
  rates_.add(rate);
  standing_.add(rate);
  rates_.forget_before(rate.time - kMostKept);
}

void MotionPrior::presume_gyroscope(const Eigen::Quaterniond& body_from_gyroscope) {
  constexpr double kSigma = 0.03;   // radians
  constexpr double kMostOff = 0.1;  // largest error of the length 1
  if (!(std::abs(body_from_gyroscope.norm() - 1.0) < kMostOff)) {
    return warn({MotionSensor::gyroscope,
                 {},
                 "the rotation of the mounting is not finite or not of length 1; it is ignored",
                 "give a unit quaternion"});
  }
  presumed_gyroscope_ = GyroscopeMounting{.body_from_gyroscope = body_from_gyroscope.normalized(),
                                          .covariance = kSigma * kSigma * Eigen::Matrix3d::Identity()};
}

std::optional<bool> MotionPrior::do_wheels_stand(Timestamp time) const {
  constexpr double kMostMetres = 0.0025;  // in the window: ticks of encoders
  constexpr double kMostRadians = 0.004;  // in the window
  if (is_slipping_) return {};
  const Timestamp end = wheel_time(time);
  const auto distance = wheels_.distance(end - SteadyTrack::kWindow, end);
  if (!distance) return {};
  return distance->metres <= kMostMetres && distance->radians <= kMostRadians;
}

void MotionPrior::watch_standing(Timestamp time, const std::optional<Pose>& seen) {
  constexpr double kMostSigma = 0.1;  // radians
  standing_.note_sight(time, seen);
  const auto bias = gyroscope_ ? std::optional(gyroscope_->bias) : std::nullopt;
  const double metres_per_unit = mounting_ ? mounting_->metres_per_unit : 1.0;
  const auto steady = standing_.at(time, {do_wheels_stand(time), standing_.does_sight_stand(metres_per_unit)}, bias);
  standing_.note(time, steady);
  if (!steady) return;
  if (!seen && gyroscope_) gyroscope_->bias = steady->rate;
  const auto& gyroscope = gyroscope_ ? gyroscope_ : known_.gyroscope ? known_.gyroscope : presumed_gyroscope_;
  if (!gyroscope) return;
  const UpInBody up = up_in_body(*steady, *gyroscope);
  if (up.sigma > kMostSigma) return;
  measured_up_ = up.up;
}

std::optional<SteadyTrack::Steady> MotionPrior::standing_by_wheels(Timestamp time) const {
  if (!gyroscope_) return {};
  return standing_.at(time, {do_wheels_stand(time), std::nullopt}, gyroscope_->bias);
}

std::optional<BodyTilt> MotionPrior::tilt(Timestamp time) const {
  return standing_.tilt(time, standing_by_wheels(time), gyroscope_);
}

// Compares the gyroscope with turns in images, else with turns of wheels. Drops it if it is faulty.
void MotionPrior::compare_turns(Timestamp time, const std::optional<SeenMotion>& seen) {
  MotionCheck::Turn turn{time, Eigen::Vector3d::Zero(), {}, seen.has_value()};
  const Timestamp begin = seen ? seen->earlier : turns_compared_.value_or(time);
  if (!turns_compared_ || seen) turns_compared_ = time;
  if (time - begin < kStride) return;
  turns_compared_ = time;
  if (seen) {
    turn.reference = rotation_log(seen->body.rotation);
  } else {
    const auto base = base_between(begin, time);
    if (!base) return;
    turn.reference = rotation_log(base->rotation);
  }
  turn.measured = rates_.integral(begin, time);
  if (check_.note(turn)) drop_gyroscope();
}

void MotionPrior::note(Timestamp time, const std::optional<Pose>& odometry_from_body) {
  if (is_empty() && !check_.is_gyroscope_silent()) return;
  watch_standing(time, odometry_from_body);
  unseen_.note(time, odometry_from_body.has_value());
  forget_old_samples();
  if (!odometry_from_body) {
    begin_.reset();
    last_.reset();
    compare_turns(time, {});
    return;
  }
  const StampedPose now{time, *odometry_from_body};
  tells_before_sight_ = false;
  if (last_ && time - last_->time <= kMaxFrameGap) {
    velocity_ = log_pose(inverse(last_->world_from_body) * now.world_from_body) / to_seconds(time - last_->time);
  } else {
    begin_.reset();
  }
  last_ = now;
  if (!begin_) begin_ = now;
  if (time - begin_->time < kStride) return;
  const SeenMotion motion{begin_->time, time, inverse(begin_->world_from_body) * now.world_from_body};
  begin_ = now;
  compare_turns(time, motion);
  watch_for_slip(motion);
  seen_.push_back(motion);
  if (seen_.size() > kMostMotions) seen_.pop_front();
  if (++unlooked_ >= kMotionsPerLook) look_for_mountings();
  presume_mounting();
}

// Keeps the samples of untracked frames until the mounting of wheels is estimated.
void MotionPrior::forget_old_samples() {
  if (!unseen_.last()) return;
  const Timestamp now = *unseen_.last();
  const Timestamp untold = wheels_.empty() ? now : unseen_.first_untold().value_or(now);
  const Timestamp oldest = std::max(std::min(now - samples_kept_, untold - 1s), now - kMostKept);
  wheels_.forget_before(oldest);
  rates_.forget_before(oldest);
}

std::optional<Pose> MotionPrior::base_between(Timestamp earlier, Timestamp later) const {
  return wheels_.between(wheel_time(earlier), wheel_time(later));
}

std::vector<MotionPair> MotionPrior::pairs() const {
  std::vector<MotionPair> pairs;
  for (const SeenMotion& motion : seen_) {
    if (const auto base = base_between(motion.earlier, motion.later)) pairs.push_back({*base, motion.body});
  }
  return pairs;
}

// Stores the gyroscope's turns of the motions since the last estimation.
void MotionPrior::ask_gyroscope() {
  for (auto motion = seen_.rbegin(); motion != seen_.rend() && !motion->gyroscope_turn; ++motion) {
    const auto turn = rates_.between(motion->earlier, motion->later, Eigen::Vector3d::Zero());
    if (turn) motion->gyroscope_turn = rotation_log(*turn);
  }
}

void MotionPrior::look_for_mountings() {
  unlooked_ = 0;
  if (!rates_.empty()) {
    ask_gyroscope();
    auto found = find_gyroscope_mounting(seen_, known_.gyroscope);
    if (!found && known_.gyroscope) found = find_gyroscope_mounting(seen_);
    if (found) gyroscope_ = found;
  }
  if (wheels_.empty()) return;
  look_for_wheel_mounting();
  if (!mounting_) return;
  if (looks_++ % kLooksPerOffset == 0) {
    const Eigen::Vector3d up = mounting_->base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    if (const auto offset = find_time_offset(seen_, up, wheels_, time_offset_)) time_offset_ = *offset;
  }
  if (looks_ >= kLooksUntilTold || known_.wheels) unseen_.take_down(tell_base());
}

void MotionPrior::look_again(const Trajectory& seen) {
  standing_.look_again(seen);
  if (!mounting_ || seen.empty()) return;
  std::vector<MotionPair> pairs;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const bool is_gap = seen[i].time - seen[i - 1].time > kMaxFrameGap;
    if (is_gap || !unseen_.is_seen(seen[i - 1].time, seen[i].time)) begin = i;
    if (seen[i].time - seen[begin].time < kStride) continue;
    if (const auto base = base_between(seen[begin].time, seen[i].time)) {
      pairs.push_back({*base, inverse(seen[begin].world_from_body) * seen[i].world_from_body});
    }
    begin = i;
  }
  if (const auto found = find_wheel_mounting(pairs, known_.wheels)) mounting_ = found;
}

void MotionPrior::stretch(double factor) {
  KnownMounting found;
  found.wheels = mounting_;
  mounting_ = scaled(std::move(found), factor).wheels;
  known_ = scaled(known_, factor);
}

// Motions that determine the mounting without the prior are compared with it.
void MotionPrior::look_for_wheel_mounting() {
  constexpr int kLooks = 3;  // consecutive contradictions
  const std::vector<MotionPair> all = pairs();
  const auto alone = find_wheel_mounting(all);
  if (known_.wheels && alone) {
    contradicting_looks_ = is_contradicted(*known_.wheels, *alone) ? contradicting_looks_ + 1 : 0;
    if (contradicting_looks_ >= kLooks) drop_known_wheels();
  }
  const auto found = known_.wheels ? find_wheel_mounting(all, known_.wheels) : alone;
  if (found) mounting_ = found;
  if (!knows_metres_ || !alone || seen_.empty()) return;
  if (check_.note_wheel_scale(alone->metres_per_unit, alone->scale_sigma, seen_.back().later)) drop_wheels();
}

// Derived from the first seconds, and updated with each motion until the mounting is estimated.
void MotionPrior::presume_mounting() {
  constexpr std::size_t kLeastMotions = 2;
  presumed_.reset();
  if (mounting_ || seen_.size() < kLeastMotions) return;
  const std::vector<MotionPair> all = pairs();
  if (measured_up_) presumed_ = presume_wheel_mounting(all, *measured_up_, UpSource::measured);
  if (!presumed_ && up_in_body_) presumed_ = presume_wheel_mounting(all, *up_in_body_);
}

const WheelMounting* MotionPrior::used_mounting() const {
  if (mounting_) return &*mounting_;
  if (presumed_) return &*presumed_;
  return tells_before_sight_ && before_sight_ ? &*before_sight_ : nullptr;
}

// An earlier mounting that most motions contradict from the start is wrong. Slip does not last as long.
void MotionPrior::check_known(double disagreement, const SeenMotion& motion) {
  constexpr double kTellingWay = 0.1;   // metres
  constexpr double kTellingTurn = 0.1;  // radians
  constexpr int kContradicting = 12;    // motions
  const double way = mounting_->metres_per_unit * motion.body.translation.norm();
  if (way < kTellingWay && rotation_log(motion.body.rotation).norm() < kTellingTurn) return;
  ++(disagreement > 1.0 ? contradicting_ : bearing_out_);
  if (contradicting_ >= kContradicting && contradicting_ > 2 * bearing_out_) drop_known_wheels();
}

void MotionPrior::drop_known_wheels() {
  known_.wheels.reset();
  mounting_.reset();
  time_offset_.reset();
  looks_ = 0;
  is_slipping_ = false;
  is_mounted_otherwise_ = true;
}

KnownMounting MotionPrior::to_keep() const {
  KnownMounting keep = known_;
  const bool is_well_known = looks_ >= kLooksUntilKept || known_.wheels;
  if (mounting_ && is_well_known) {
    keep.wheels = mounting_;
    keep.time_offset = time_offset();
  }
  if (gyroscope_) keep.gyroscope = gyroscope_;
  keep.up = standing_.up_in_map(gyroscope_);
  return keep;
}

// Precondition: the mounting of wheels is estimated or presumed.
UnseenWay::Tell MotionPrior::tell_base() const {
  return [this](Timestamp earlier, Timestamp later) {
    const auto told = told_base(earlier, later, turn_by_gyroscope(earlier, later));
    return told ? std::optional(told->motion) : std::nullopt;
  };
}

Trajectory MotionPrior::completed(Trajectory seen) const {
  const WheelMounting* const mounting = used_mounting();
  if (mounting == nullptr) return seen;
  UnseenWay unseen = unseen_;
  unseen.take_down(tell_base());
  const auto body_motion_of = [&](const Pose& base) { return body_motion(*mounting, base); };
  return unseen.completed(std::move(seen), body_motion_of, old_poses_);
}

void MotionPrior::watch_for_slip(const SeenMotion& motion) {
  constexpr int kAgreeing = 2;  // agreeing motions that end the slip
  if (!mounting_) return;
  const auto base = base_between(motion.earlier, motion.later);
  if (!base) return;
  const Pose told = body_motion(*mounting_, without_turn_errors(mounting_->turn_errors, *base));
  const double difference = disagreement(told, motion, mounting_->metres_per_unit);
  if (known_.wheels) check_known(difference, motion);
  if (!mounting_) return;
  if (difference > 1.0) {
    if (!is_slipping_) ++slips_;
    is_slipping_ = true;
    agreeing_ = 0;
  } else if (++agreeing_ >= kAgreeing) {
    is_slipping_ = false;
  }
}

std::optional<Eigen::Quaterniond> MotionPrior::turn_by_gyroscope(Timestamp earlier, Timestamp later) const {
  if (!gyroscope_) return {};
  const auto told = rates_.between(earlier, later, gyroscope_->bias);
  if (!told) return {};
  return gyroscope_->body_from_gyroscope * *told * gyroscope_->body_from_gyroscope.conjugate();
}

// turn: rotation of the body from the gyroscope; replaces that of the wheels. Precondition: the mounting of wheels is
// estimated or presumed.
std::optional<MotionPrior::ToldBase> MotionPrior::told_base(Timestamp earlier, Timestamp later,
                                                            const std::optional<Eigen::Quaterniond>& turn) const {
  const auto told = base_between(earlier, later);
  if (!told) return {};
  ToldBase base{without_turn_errors(used_mounting()->turn_errors, *told)};
  if (turn) {
    const Eigen::Quaterniond& base_from_body = used_mounting()->base_from_body.rotation;
    const Eigen::Quaterniond base_turn = base_from_body * *turn * base_from_body.conjugate();
    base.is_way_known = !is_slip(base.motion.rotation, base_turn, to_seconds(later - earlier));
    base.motion.rotation = base_turn;
  }
  if (is_jerk(earlier, later, *told)) {
    base.is_way_known = false;
    base.is_turn_known = turn.has_value();
  }
  return base;
}

std::optional<BodyMotion> MotionPrior::by_wheels(Timestamp earlier, Timestamp later,
                                                 const std::optional<Eigen::Quaterniond>& turn) const {
  const WheelMounting* const mounting = used_mounting();
  if (mounting == nullptr) return {};
  const auto base = told_base(earlier, later, turn);
  if (!base) return {};
  const Pose body = body_motion(*mounting, base->motion);
  BodyMotion motion{body, wheel_covariance(body, base->motion, *mounting)};
  if (known_.wheels && bearing_out_ < kBorneOut) motion.covariance *= kUnprovenFactor;
  if (!base->is_way_known) forget_way(motion);
  if (!base->is_turn_known) forget_turn(motion);
  return motion;
}

// Whether the motion of the base changes from the previous span by more than a body can: wheels spin, or are faulty.
bool MotionPrior::is_jerk(Timestamp earlier, Timestamp later, const Pose& base) const {
  constexpr double kMostAcceleration = 15.0;  // m/s^2
  constexpr double kLeast = 0.02;             // metres, for encoder ticks
  constexpr double kMostTurning = 30.0;       // radians per second squared
  constexpr double kLeastTurn = 0.05;         // radians
  const Timestamp span = later - earlier;
  if (span > kMaxFrameGap) return false;
  if (wheels_.has_jump(wheel_time(earlier) - span, wheel_time(earlier))) return true;
  const auto before = base_between(earlier - span, earlier);
  if (!before) return false;
  const double squared = to_seconds(span) * to_seconds(span);
  return (base.translation - before->translation).norm() > kLeast + kMostAcceleration * squared ||
         angle_between(base.rotation, before->rotation) > kLeastTurn + kMostTurning * squared;
}

// Whether the turns by gyroscope and wheels differ by more than a spinning wheel explains. Then one of both is faulty.
bool MotionPrior::contradicts_wheels(Timestamp earlier, Timestamp later, const Eigen::Quaterniond& turn) const {
  constexpr double kMostRate = 3.0;   // radians per second
  constexpr double kLeastTurn = 0.1;  // radians
  const auto base = base_between(earlier, later);
  if (!base) return false;
  const double apart = std::abs(rotation_log(turn).norm() - rotation_log(base->rotation).norm());
  return apart > kLeastTurn + kMostRate * to_seconds(later - earlier);
}

// Motion across a jump of the wheel pose: that of the previous span, with a standard deviation as large as itself.
std::optional<BodyMotion> MotionPrior::across_jump(Timestamp earlier, Timestamp later,
                                                   const std::optional<Eigen::Quaterniond>& turn) const {
  const Timestamp span = later - earlier;
  if (span > kMaxFrameGap || !wheels_.has_jump(wheel_time(earlier), wheel_time(later))) return {};
  auto motion = by_wheels(earlier - span, earlier, {});
  if (!motion) motion = by_wheels(earlier - 2 * span, earlier - span, {});  // if the jump is right after the frame
  if (!motion) return {};
  forget_way(*motion);
  forget_turn(*motion);
  if (turn) motion->last_from_body.rotation = *turn;
  return motion;
}

std::optional<BodyMotion> MotionPrior::by_sight(Timestamp earlier, Timestamp later) const {
  constexpr Timestamp kLongest = 1s;
  constexpr double kShare = 0.3;         // share of the path length
  constexpr double kAcceleration = 1.0;  // lengths of the map per second squared
  if (!velocity_ || seen_.empty() || later - seen_.back().later > kLongest + kStride) return {};
  const double seconds = to_seconds(later - earlier);
  const Pose motion = exp_pose(*velocity_ * seconds);
  const double sigma = kShare * motion.translation.norm() + 0.5 * kAcceleration * seconds * seconds;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal().head<3>().setConstant(sigma * sigma);
  return BodyMotion{motion, covariance};
}

std::optional<BodyMotion> MotionPrior::between(Timestamp earlier, Timestamp later) const {
  auto turn = turn_by_gyroscope(earlier, later);
  const bool is_contradicted = turn && !is_slipping_ && contradicts_wheels(earlier, later, *turn);
  if (is_contradicted) turn.reset();
  auto motion = is_slipping_ ? std::nullopt : by_wheels(earlier, later, turn);
  if (motion && is_contradicted) {
    forget_way(*motion);
    forget_turn(*motion);
  }
  if (!motion && !is_slipping_) motion = across_jump(earlier, later, turn);
  if (!turn) return motion;
  if (motion && standing_by_wheels(later)) return at_rest(*motion, to_seconds(later - earlier));
  if (!motion && (motion = by_sight(earlier, later))) motion->last_from_body.rotation = *turn;
  if (!motion) return {};
  set_turn_covariance(*motion, *gyroscope_, to_seconds(later - earlier));
  return motion;
}

std::optional<double> MotionPrior::reach(Timestamp earlier, Timestamp later, bool is_metric) const {
  constexpr double kShare = 1.2;      // factor of the measured distance: wheels may slide
  constexpr double kLeast = 0.5;      // metres
  constexpr double kUntold = 1.5;     // metres in the first second: failed encoders must not reject a tracked frame
  constexpr double kUsualArm = 1.0;   // metres, before it is estimated
  constexpr double kHalfTurns = 2.0;  // radii that turns on the spot can displace the body
  const WheelMounting* const mounting = used_mounting();
  if (mounting == nullptr && !is_metric) return {};
  const auto distance = wheels_.distance(wheel_time(earlier), wheel_time(later));
  if (!distance) return {};
  const double arm = mounting_ ? mounting_->base_from_body.translation.norm() : kUsualArm;
  const double metres = kShare * distance->metres + std::min(distance->radians, kHalfTurns) * arm + kLeast +
                        kUntold * std::clamp(to_seconds(later - earlier), 0.0, 1.0);
  return metres / (mounting != nullptr ? mounting->metres_per_unit : 1.0);
}

std::optional<BodyMotion> MotionPrior::way_between(Timestamp earlier, Timestamp later) const {
  const auto turn = turn_by_gyroscope(earlier, later);
  auto motion = by_wheels(earlier, later, turn);
  if (motion && turn) set_turn_covariance(*motion, *gyroscope_, to_seconds(later - earlier));
  return motion;
}

}  // namespace byre
