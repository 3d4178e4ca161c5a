#include "byre/slam/frame/pair_timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr double kTimingMemory = 0.9;  // factor of the weight of earlier frames, per frame

Sign sign_of_slope(const std::optional<SlopeSum::Slope>& slope) {
  constexpr double kOutOfStep = 0.5;    // frames of delay
  constexpr double kSurePresent = 5.0;  // sigmas
  constexpr double kSureAbsent = 3.0;   // sigmas
  if (!slope) return Sign::unclear;
  const double size = std::abs(slope->value);
  if (size > kOutOfStep && size > kSurePresent * slope->sigma) return Sign::present;
  return size + kSureAbsent * slope->sigma < kOutOfStep ? Sign::absent : Sign::unclear;
}

}  // namespace

void SlopeSum::begin_frame() {
  information_ *= kTimingMemory;
  right_side_ *= kTimingMemory;
  squares_ *= kTimingMemory;
  count_ *= kTimingMemory;
}

void SlopeSum::add(double motion, const Others& others, double value) {
  Eigen::Matrix<double, kSize, 1> row;
  row << motion, others;
  information_ += row * row.transpose();
  right_side_ += value * row;
  squares_ += value * value;
  count_ += 1.0;
}

std::optional<SlopeSum::Slope> SlopeSum::slope(double least_motion) const {
  constexpr double kEnough = 50.0;       // weight of all values
  constexpr double kShared = 3.0;        // factor of sigmas, as errors of neighbouring points are correlated
  constexpr double kLeastSquare = 0.01;  // pixels squared, minimum variance of a value
  if (count_ < kEnough) return std::nullopt;
  // Damping of 1e-3 keeps the equations solvable.
  const Eigen::Matrix<double, kSize, kSize> information =
      information_ + 1e-3 * Eigen::Matrix<double, kSize, kSize>::Identity();
  const Eigen::LDLT<Eigen::Matrix<double, kSize, kSize>> factored(information);
  const Eigen::Matrix<double, kSize, 1> solution = factored.solve(right_side_);
  const double variance = std::max(kLeastSquare, (squares_ - solution.dot(right_side_)) / count_);
  const double of_slope = factored.solve(Eigen::Matrix<double, kSize, 1>::Unit(0))[0];
  if (!(of_slope > 0.0) || 1.0 / of_slope < least_motion * least_motion * count_) return std::nullopt;
  return Slope{solution[0], kShared * std::sqrt(variance * of_slope)};
}

Sign PairTiming::note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map) {
  constexpr double kMostRowMotion = 1.0;  // pixels at octave 0; points with more are not matched on their row
  constexpr double kGate = 4.0;           // largest disparity error, in pixels plus frames of motion
  rows_.begin_frame();
  disparities_.begin_frame();
  now_.clear();
  for (const auto* features : {&tracked.features, &tracked.outliers}) {
    for (const TrackedFeature& seen : *features) now_.push_back({seen.point, seen.pixel, seen.feature});
  }
  std::ranges::sort(now_, {}, &Sight::point);
  auto before = last_.begin();
  for (const Sight& sight : now_) {
    while (before != last_.end() && before->point < sight.point) ++before;
    if (before == last_.end() || sight.point < before->point) continue;
    const Keypoint& keypoint = frame.features->keypoint(sight.feature);
    const MapPoint* const point = map.find_point(sight.point);
    if (!keypoint.has_disparity() || point == nullptr) continue;
    const Eigen::Vector2d motion = (sight.pixel - before->pixel).cast<double>();  // pixels per frame
    const double column = keypoint.pixel.x() / rig.width - 0.5, row = keypoint.pixel.y() / rig.height - 0.5;
    if (std::abs(motion.y()) <= kMostRowMotion * kScaleOfOctave[keypoint.octave]) {
      rows_.add(-motion.y(), {1.0, column, row, column * row}, keypoint.row_offset);
    }
    const Eigen::Vector3d in_camera = tracked.camera_from_world * point->position_in_world;
    if (in_camera.z() <= 0.0) continue;
    const double expected = rig.project(in_camera).z();
    const double error = keypoint.disparity - expected;
    if (std::abs(error) > kGate * (1.0 + std::abs(motion.x()))) continue;
    disparities_.add(motion.x(), {column, row, 0.0, 0.0}, error);
  }
  std::swap(last_, now_);
  const Sign by_row = sign_of_slope(by_rows()), by_disparity = sign_of_slope(by_disparities());
  if (by_row == Sign::present || by_disparity == Sign::present) return Sign::present;
  return by_row == Sign::absent || by_disparity == Sign::absent ? Sign::absent : Sign::unclear;
}

}  // namespace byre
