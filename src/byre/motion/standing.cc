#include "byre/motion/standing.h"

#include <algorithm>
#include <chrono>
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

}  // namespace

void Standing::note_sight(Timestamp time, const std::optional<Pose>& seen) {
  constexpr Timestamp kSpan = SteadyTrack::kWindow + kMaxFrameGap;
  if (!seen || (!seen_.empty() && time - seen_.back().time > kMaxFrameGap)) seen_.clear();
  if (seen) seen_.push_back({time, *seen});
  while (!seen_.empty() && seen_.front().time + kSpan < time) seen_.pop_front();
}

std::optional<bool> Standing::does_sight_stand(double metres_per_unit) const {
  constexpr double kMostMetres = 0.01;    // in the window
  constexpr double kMostRadians = 0.006;  // in the window
  if (seen_.empty() || seen_.front().time > seen_.back().time - SteadyTrack::kWindow) return {};
  return std::ranges::all_of(seen_, [&](const StampedPose& pose) {
    const Pose motion = inverse(pose.world_from_body) * seen_.back().world_from_body;
    return metres_per_unit * motion.translation.norm() <= kMostMetres &&
           rotation_log(motion.rotation).norm() <= kMostRadians;
  });
}

std::optional<SteadyTrack::Steady> Standing::at(Timestamp time, const Witnesses& witnesses,
                                                const std::optional<Eigen::Vector3d>& bias) const {
  constexpr double kMostTurning = 0.02;  // radians per second
  const bool says_one_so = witnesses.do_wheels_stand.value_or(false) || witnesses.does_sight_stand.value_or(false);
  const bool says_none_otherwise =
      witnesses.do_wheels_stand.value_or(true) && witnesses.does_sight_stand.value_or(true);
  if (!says_one_so || !says_none_otherwise) return {};
  const auto steady = track_.until(time);
  if (!steady || (bias && (steady->rate - *bias).norm() > kMostTurning)) return {};
  return steady;
}

int Standing::stop_at(Timestamp time) const {
  return last_stood_ && time - *last_stood_ <= kMaxStopGap ? stops_ : stops_ + 1;
}

void Standing::note(Timestamp time, const std::optional<SteadyTrack::Steady>& steady) {
  now_ = steady;
  if (!steady) return;
  const bool goes_on = stop_at(time) == stops_;
  seconds_ += to_seconds(goes_on ? time - *last_stood_ : SteadyTrack::kWindow);
  if (!goes_on) ++stops_;
  last_stood_ = time;
}

void Standing::note_place(const Eigen::Quaterniond& map_from_body) {
  if (!now_ || places_.size() >= kMostPlaces) return;
  if (!places_.empty() && *last_stood_ - places_.back().time < kBetweenPlaces) return;
  places_.push_back({*last_stood_, now_->up, map_from_body});
}

void Standing::look_again(const Trajectory& seen) {
  for (Place& place : places_) {
    if (const auto pose = pose_at(seen, place.time, kMaxPoseGap)) place.map_from_body = pose->rotation;
  }
}

std::optional<KnownUp> Standing::up_in_map(const std::optional<GyroscopeMounting>& mounting) const {
  constexpr double kKnown = 20.0;  // weight of the earlier map, in stops of half a second
  if (!mounting || places_.empty()) return known_;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (known_) sum = kKnown * known_->up_in_map;
  for (const Place& place : places_) sum += place.map_from_body * (mounting->body_from_gyroscope * place.up_in_sensor);
  if (!(sum.norm() > 0.0)) return {};
  KnownUp up{sum.normalized(), 0.0};
  double squares = 0.0;
  for (const Place& place : places_) {
    const Eigen::Vector3d one = place.map_from_body * (mounting->body_from_gyroscope * place.up_in_sensor);
    squares += (one - up.up_in_map).squaredNorm() / static_cast<double>(places_.size());
  }
  up.sigma = std::hypot(kLeastSigma, std::sqrt(squares));
  return up;
}

UpInBody up_in_body(const SteadyTrack::Steady& steady, const GyroscopeMounting& mounting) {
  UpInBody result{mounting.body_from_gyroscope * steady.up, 0.0};
  const Eigen::Matrix3d across = skew(result.up);
  const Eigen::Matrix3d covariance = across * mounting.covariance * across.transpose();
  const double variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff();
  result.sigma = std::hypot(steady.sigma, std::sqrt(std::max(0.0, variance)));
  return result;
}

std::optional<BodyTilt> Standing::tilt(Timestamp time, const std::optional<SteadyTrack::Steady>& steady,
                                       const std::optional<GyroscopeMounting>& mounting) const {
  constexpr double kMostSigma = 0.03;  // radians
  if (!steady || !mounting) return {};
  const auto in_map = up_in_map(mounting);
  if (!in_map) return {};
  const UpInBody up = up_in_body(*steady, *mounting);
  const double sigma = std::hypot(up.sigma, in_map->sigma);
  if (sigma > kMostSigma) return {};
  return BodyTilt{up.up, in_map->up_in_map, sigma, stop_at(time)};
}

}  // namespace byre
