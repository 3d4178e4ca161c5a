#include "byre/odometry/stationary_detector.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kMaxStopGap = 1500ms;    // between frames of one stop: vibration may interrupt it
constexpr Timestamp kMaxPoseGap = 500ms;     // between poses around a stop
constexpr Timestamp kBetweenPlaces = 500ms;  // between recorded poses of one stop
constexpr std::size_t kMostPlaces = 2000;
constexpr double kLeastSigma = 0.005;  // radians: the bias is the same at all stops
constexpr Timestamp kKept = 5s;
constexpr double kUsualGravity = 9.81;  // m/s^2

template <typename Sample>
void keep(const Sample& sample, std::deque<Sample>& samples) {
  if (!samples.empty() && sample.time + kKept < samples.back().time) samples.clear();  // the clock was set back
  if (!samples.empty() && sample.time <= samples.back().time) return;
  samples.push_back(sample);
  while (samples.front().time + kKept < sample.time) samples.pop_front();
}

struct Mean {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double deviation = 0.0;  // root mean square from the mean, all axes together
  double change = 0.0;     // largest distance between the means of the window's thirds
};

// Over the window that ends at a time; empty if samples do not cover it.
template <typename Sample, typename Value>
std::optional<Mean> mean_until(const std::deque<Sample>& samples, Timestamp time, const Value& value) {
  constexpr std::size_t kLeastSamples = 30;
  constexpr Timestamp kLate = 100ms;  // largest age of the last sample
  const auto is_before = [](const Sample& sample, Timestamp when) { return sample.time < when; };
  const auto begin = std::lower_bound(samples.begin(), samples.end(), time - SteadyWindow::kWindow, is_before);
  const auto end = std::lower_bound(begin, samples.end(), time + Timestamp(1), is_before);
  const auto count = static_cast<std::size_t>(end - begin);
  if (begin == samples.begin() || count < kLeastSamples || std::prev(end)->time + kLate < time) return {};
  std::array<Eigen::Vector3d, 3> thirds;
  thirds.fill(Eigen::Vector3d::Zero());
  std::array<double, 3> counts{};
  double squares = 0.0;
  Mean result;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d now = value(*(begin + static_cast<std::ptrdiff_t>(i)));
    thirds[3 * i / count] += now;
    counts[3 * i / count] += 1.0;
    result.mean += now / static_cast<double>(count);
    squares += now.squaredNorm() / static_cast<double>(count);
  }
  for (std::size_t i = 0; i < thirds.size(); ++i) thirds[i] /= counts[i];
  result.deviation = std::sqrt(std::max(0.0, squares - result.mean.squaredNorm()));
  result.change =
      std::max({(thirds[0] - thirds[1]).norm(), (thirds[1] - thirds[2]).norm(), (thirds[0] - thirds[2]).norm()});
  return result;
}

}  // namespace

void SteadyWindow::add(const AngularRate& rate) {
  keep(rate, rates_);
}

void SteadyWindow::add(const Acceleration& acceleration) {
  keep(acceleration, accelerations_);
}

std::optional<SteadyWindow::Steady> SteadyWindow::until(Timestamp time) const {
  constexpr double kMostVibration = 1.0;     // m/s^2
  constexpr double kMostChange = 0.1;        // m/s^2
  constexpr double kMostUnlike = 0.5;        // m/s^2, difference from gravity by scale and bias
  constexpr double kBias = 0.05;             // m/s^2, of a consumer sensor
  constexpr double kMostRateNoise = 0.1;     // radians per second
  constexpr double kMostRateChange = 0.015;  // radians per second
  constexpr double kMostRate = 0.15;         // radians per second, with the bias
  const auto rate = mean_until(rates_, time, [](const AngularRate& sample) { return sample.rate; });
  if (!rate || rate->deviation > kMostRateNoise || rate->change > kMostRateChange || rate->mean.norm() > kMostRate) {
    return {};
  }
  const auto measured =
      mean_until(accelerations_, time, [](const Acceleration& sample) { return sample.acceleration; });
  if (!measured || measured->deviation > kMostVibration || measured->change > kMostChange ||
      std::abs(measured->mean.norm() - kUsualGravity) > kMostUnlike) {
    return {};
  }
  return Steady{measured->mean.normalized(), std::hypot(kBias, measured->change) / kUsualGravity, rate->mean};
}

void StationaryDetector::note_visual_pose(Timestamp time, const std::optional<Pose>& seen) {
  constexpr Timestamp kSpan = SteadyWindow::kWindow + kMaxFrameGap;
  if (!seen || (!seen_.empty() && time - seen_.back().time > kMaxFrameGap)) seen_.clear();
  if (seen) seen_.push_back({time, *seen});
  while (!seen_.empty() && seen_.front().time + kSpan < time) seen_.pop_front();
}

std::optional<bool> StationaryDetector::are_poses_stationary(double metres_per_unit) const {
  constexpr double kMostMetres = 0.01;    // in the window
  constexpr double kMostRadians = 0.006;  // in the window
  if (seen_.empty() || seen_.front().time > seen_.back().time - SteadyWindow::kWindow) return {};
  return std::ranges::all_of(seen_, [&](const StampedPose& pose) {
    const Pose motion = inverse(pose.world_from_body) * seen_.back().world_from_body;
    return metres_per_unit * motion.translation.norm() <= kMostMetres &&
           rotation_log(motion.rotation).norm() <= kMostRadians;
  });
}

std::optional<SteadyWindow::Steady> StationaryDetector::at(Timestamp time, const StationaryEvidence& evidence,
                                                           const std::optional<Eigen::Vector3d>& bias) const {
  constexpr double kMostTurnRate = 0.02;  // radians per second
  const bool any_stationary =
      evidence.are_wheels_stationary.value_or(false) || evidence.are_poses_stationary.value_or(false);
  const bool none_moving =
      evidence.are_wheels_stationary.value_or(true) && evidence.are_poses_stationary.value_or(true);
  if (!any_stationary || !none_moving) return {};
  const auto steady = track_.until(time);
  if (!steady || (bias && (steady->rate - *bias).norm() > kMostTurnRate)) return {};
  return steady;
}

int StationaryDetector::stop_at(Timestamp time) const {
  return last_stationary_ && time - *last_stationary_ <= kMaxStopGap ? stops_ : stops_ + 1;
}

void StationaryDetector::note(Timestamp time, const std::optional<SteadyWindow::Steady>& steady) {
  now_ = steady;
  if (!steady) return;
  const bool continues = stop_at(time) == stops_;
  seconds_ += to_seconds(continues ? time - *last_stationary_ : SteadyWindow::kWindow);
  if (!continues) ++stops_;
  last_stationary_ = time;
}

void StationaryDetector::note_place(const Eigen::Quaterniond& map_from_body) {
  if (!now_ || places_.size() >= kMostPlaces) return;
  if (!places_.empty() && *last_stationary_ - places_.back().time < kBetweenPlaces) return;
  places_.push_back({*last_stationary_, now_->up, map_from_body});
}

void StationaryDetector::reestimate(const Trajectory& seen) {
  for (Place& place : places_) {
    if (const auto pose = pose_at(seen, place.time, kMaxPoseGap)) place.map_from_body = pose->rotation;
  }
}

std::optional<UpInMap> StationaryDetector::up_in_map(const std::optional<GyroscopeCalibration>& calibration) const {
  constexpr double kKnown = 20.0;  // weight of the earlier map, in stops of half a second
  if (!calibration || places_.empty()) return prior_;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (prior_) sum = kKnown * prior_->up_in_map;
  for (const Place& place : places_)
    sum += place.map_from_body * (calibration->body_from_gyroscope * place.up_in_sensor);
  if (!(sum.norm() > 0.0)) return {};
  UpInMap up{sum.normalized(), 0.0};
  double squares = 0.0;
  for (const Place& place : places_) {
    const Eigen::Vector3d one = place.map_from_body * (calibration->body_from_gyroscope * place.up_in_sensor);
    squares += (one - up.up_in_map).squaredNorm() / static_cast<double>(places_.size());
  }
  up.sigma = std::hypot(kLeastSigma, std::sqrt(squares));
  return up;
}

UpInBody up_in_body(const SteadyWindow::Steady& steady, const GyroscopeCalibration& calibration) {
  UpInBody result{calibration.body_from_gyroscope * steady.up, 0.0};
  const Eigen::Matrix3d across = skew(result.up);
  const Eigen::Matrix3d covariance = across * calibration.covariance * across.transpose();
  const double variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff();
  result.sigma = std::hypot(steady.sigma, std::sqrt(std::max(0.0, variance)));
  return result;
}

std::optional<BodyTilt> StationaryDetector::tilt(Timestamp time, const std::optional<SteadyWindow::Steady>& steady,
                                                 const std::optional<GyroscopeCalibration>& calibration) const {
  constexpr double kMostSigma = 0.03;  // radians
  if (!steady || !calibration) return {};
  const auto in_map = up_in_map(calibration);
  if (!in_map) return {};
  const UpInBody up = up_in_body(*steady, *calibration);
  const double sigma = std::hypot(up.sigma, in_map->sigma);
  if (sigma > kMostSigma) return {};
  return BodyTilt{up.up, in_map->up_in_map, sigma, stop_at(time)};
}

}  // namespace byre
