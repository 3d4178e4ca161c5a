#include "byre/slam/calibration/self_calibration.h"

#include "byre/geometry/calibration_sensitivity.h"
#include "byre/geometry/median.h"
#include "byre/geometry/rectified_change.h"
#include "byre/optimise/calibration_covariance.h"
#include "byre/optimise/robust_error.h"
#include "byre/slam/calibration/determined_calibration.h"
#include "byre/slam/calibration/row_evidence.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr int kMinKeyframes = 6;  // keyframes needed
constexpr int kIterations = 12;   // iterations of bundle adjustment
constexpr int kMaxSteps = 10;     // bundle adjustments
// Image motion by a change of the calibration that is linear in the change, pixels. After larger changes, one camera is
// calibrated again around the new calibration.
constexpr double kLinearShift = 0.5;
// Common error of measurements in real images, which looks like a focal length error for any number of measurements. In
// sigmas of a good calibration.
constexpr double kFocalSigmas = 0.25;

constexpr double kHuberWidth = 2.0;  // sigmas
// Disparities of one corner in several keyframes, and those of its neighbours, are measured on the same surface, so
// their errors are correlated.
constexpr double kSharedDisparityError = 3.0;  // factor on the sigma of each disparity
constexpr double kMedianOfChiSquare2 = 1.386;
constexpr double kMedianOfChiSquare3 = 2.366;

// All keyframes of the rig, or blocks of neighbours spread over the run.
std::vector<int> choose_keyframes(const MapWindow& whole, int rig, int limit) {
  std::vector<int> all;
  for (int i = 0; i < static_cast<int>(whole.keyframes.size()); ++i) {
    const WindowKeyframe& keyframe = whole.keyframe(i);
    if (!keyframe.removed && keyframe.keyframe.rig == rig) all.push_back(i);
  }
  const auto count = static_cast<int>(all.size());
  if (count <= limit) return all;
  constexpr int kBlock = 25;
  const int blocks = std::max(1, limit / kBlock);
  std::vector<int> chosen;
  for (int i = 0; i < count; ++i) {
    const int begin = (i * blocks / count) * count / blocks;
    if (i - begin < kBlock) chosen.push_back(all[static_cast<std::size_t>(i)]);
  }
  return chosen;
}

// The points that at least two of the keyframes see, and their measurements.
struct CalibrationBundle {
  BundleProblem problem;
  std::vector<int> points;  // index into the window of each point
};
CalibrationBundle bundle_of(const MapWindow& whole, const std::vector<int>& keyframes) {
  CalibrationBundle bundle;
  BundleProblem& problem = bundle.problem;
  problem.rigs = whole.rigs;
  std::vector<int> pose_of(whole.keyframes.size(), -1);
  for (const int i : keyframes) {
    const WindowKeyframe& keyframe = whole.keyframe(i);
    pose_of[static_cast<std::size_t>(i)] = static_cast<int>(problem.poses.size());
    problem.poses.push_back({keyframe.keyframe.camera_from_world, keyframe.keyframe.rig, false});
  }
  for (int index = 0; index < static_cast<int>(whole.points.size()); ++index) {
    const WindowPoint& point = whole.point(index);
    if (point.removed) continue;
    const auto takes_part = [&](const WindowObservation& seen) {
      return pose_of[static_cast<std::size_t>(seen.keyframe)] >= 0;
    };
    if (std::ranges::count_if(point.observations, takes_part) < 2) continue;
    for (const WindowObservation& seen : point.observations) {
      if (!takes_part(seen)) continue;
      BundleObservation observation = bundle_observation(whole.keyframe(seen.keyframe), seen.feature);
      observation.pose = pose_of[static_cast<std::size_t>(seen.keyframe)];
      if (observation.is_stereo()) observation.disparity_sigma *= kSharedDisparityError;
      observation.point = static_cast<int>(problem.points.size());
      problem.observations.push_back(observation);
    }
    problem.points.push_back({point.point.position_in_world, false});
    bundle.points.push_back(index);
  }
  return bundle;
}

std::vector<RowMeasurement> measure_rows(const MapWindow& whole, const std::vector<int>& keyframes, const Rig& rig,
                                         const CalibrationSensitivity& sensitivity) {
  const auto keypoints_of = [&](int keyframe) { return whole.keyframe(keyframe).keyframe.frame.features->keypoints(); };
  std::ptrdiff_t count = 0;
  for (const int i : keyframes) count += std::ranges::count_if(keypoints_of(i), &Keypoint::has_disparity);
  std::vector<RowMeasurement> rows;
  rows.reserve(static_cast<std::size_t>(count));  // hundreds of thousands
  for (const int i : keyframes) {
    for (const Keypoint& keypoint : keypoints_of(i)) {
      if (!keypoint.has_disparity()) continue;
      const StereoPixel pixel(keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity);
      rows.push_back({keypoint.row_offset, keypoint.disparity_sigma, part_of_image(keypoint.pixel, rig),
                      sensitivity.at(pixel).row(3).cast<float>()});
    }
  }
  return rows;
}

// Squared ratio of residuals to their sigmas; at least 1.
double variance_factor(const BundleProblem& problem, const std::vector<double>& squared_errors) {
  std::vector<double> ratios;
  ratios.reserve(squared_errors.size());
  for (std::size_t i = 0; i < squared_errors.size(); ++i) {
    ratios.push_back(squared_errors[i] /
                     (problem.observations[i].is_stereo() ? kMedianOfChiSquare3 : kMedianOfChiSquare2));
  }
  return ratios.empty() ? 1.0 : std::max(1.0, median(std::move(ratios)));
}

BundleProblem with_solved_geometry(BundleProblem problem, const BundleResult& solved) {
  for (std::size_t i = 0; i < problem.poses.size(); ++i)
    problem.poses[i].camera_from_world = solved.camera_from_world[i];
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    problem.points[i].position_in_world = solved.points_in_world[i];
  }
  return problem;
}

// The problem with measurements, poses and points at the solution.
BundleProblem at_solution(const BundleProblem& problem, const BundleResult& solved) {
  BundleProblem moved = with_solved_geometry(with_change(problem, solved.calibration_change), solved);
  moved.calibration = problem.calibration;
  return moved;
}

// Equations with an error common to all measurements that looks like a calibration change along this vector, one sigma
// long (Sherman and Morrison's formula).
CalibrationEquations with_shared_error(const CalibrationEquations& learned, const CalibrationVector& error) {
  const CalibrationVector told = learned.information * error;
  const double scale = 1.0 / (1.0 + error.dot(told));
  return {learned.information - scale * told * told.transpose(),
          learned.right_side - scale * told * error.dot(learned.right_side)};
}

// Equal error of both focal lengths.
CalibrationVector focal_error(double sigmas) {
  CalibrationVector error = CalibrationVector::Zero();
  error[kLeftCamera] = error[kRightCamera] = sigmas;
  return error;
}

// Root mean square of the image motion by the change, without the part that a camera rotation explains: the mean of u
// and of v.
double image_shift(const BundleProblem& problem, const CalibrationSensitivity& sensitivity,
                   const CalibrationVector& change) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double sum_of_squares = 0.0;
  for (const BundleObservation& observation : problem.observations) {
    const Eigen::Vector3d shift = sensitivity.at(observation.measured).topRows<3>() * change;
    sum += shift;
    sum_of_squares += shift.squaredNorm();
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, problem.observations.size()));
  return std::sqrt(std::max(0.0, sum_of_squares / count - (sum.head<2>() / count).squaredNorm()));
}

// The problem at the solution, with measurements in images rectified by another calibration of the rig.
BundleProblem rectified_anew(BundleProblem problem, const BundleResult& solved, int rig,
                             const RectifiedChange& change) {
  problem = with_solved_geometry(std::move(problem), solved);
  problem.rigs[static_cast<std::size_t>(rig)] = change.rig();
  for (BundlePose& pose : problem.poses) {
    if (pose.rig == rig) pose.camera_from_world = change.after_from_before() * pose.camera_from_world;
  }
  for (BundleObservation& seen : problem.observations) {
    if (problem.poses[static_cast<std::size_t>(seen.pose)].rig == rig) seen.measured = change({seen.measured}).pixel;
  }
  return problem;
}

// Bundle of the keyframes with a free calibration of one rig.
struct CalibrationFit {
  const MapWindow& whole;
  const CalibrationState& state;
  int rig = 0;
  const std::function<bool()>& should_stop;
  const std::vector<int>& keyframes;  // indices into whole
  CalibrationBundle bundle;           // with the geometry of whole

  // A refinement, and the calibration that its measurements suggest with a prior of nominal numbers.
  struct Result {
    SelfCalibration refined;
    double nominal_shift = 0.0;  // image motion by the change to that calibration, pixels
  };
  // prior_sigmas: standard errors of the calibration before refinement. Empty if bundle adjustment fails.
  std::optional<Result> with_prior(const CalibrationVector& prior_sigmas) const;
};

CalibrationEstimate prior_of(const CalibrationVector& sigmas, const CalibrationVector& change) {
  return {sigmas.cwiseAbs2().cwiseInverse().asDiagonal(), -change};
}

std::optional<CalibrationFit::Result> CalibrationFit::with_prior(const CalibrationVector& prior_sigmas) const {
  const Rig& present = whole.rigs[static_cast<std::size_t>(rig)];
  BundleOptions bundle_options;
  bundle_options.max_iterations = kIterations;
  bundle_options.huber_width = kHuberWidth;
  bundle_options.should_stop = should_stop;

  BundleProblem problem = bundle.problem;
  CalibrationState at = state;  // where pixels are linear in the calibration
  for (int step = 1;; ++step) {
    const CalibrationSensitivity sensitivity(at.present());
    const CalibrationEstimate with_rows =
        learn_from_rows(measure_rows(whole, keyframes, present, sensitivity), prior_of(prior_sigmas, at.change));
    problem.calibration = BundleCalibration{&sensitivity, rig, with_rows.expected, with_rows.information};
    const BundleResult solved = bundle_adjust(problem, bundle_options);
    if (!solved.usable || (should_stop && should_stop())) return std::nullopt;
    CalibrationState next = at;
    next.change += solved.calibration_change;
    if (!state.given.right && step < kMaxSteps &&
        image_shift(problem, sensitivity, solved.calibration_change) > kLinearShift &&
        can_be_rectified(next.present())) {
      problem = rectified_anew(std::move(problem), solved, rig, {at.present(), next.present()});
      at = next;
      continue;
    }

    const auto information = calibration_information(at_solution(problem, solved), kHuberWidth);
    if (!information) return std::nullopt;
    CalibrationEquations of_motion = difference({*information, solved.calibration_change}, with_rows);
    of_motion /= variance_factor(problem, solved.squared_errors);
    const CalibrationEquations learned = with_shared_error(of_motion, focal_error(kFocalSigmas));
    const CalibrationEstimate posterior = joined(with_rows, learned);
    const CalibrationVector expected = at.change + posterior.expected;
    const CalibrationVector nominal = at.change + joined(prior_of(nominal_sigmas(), at.change), learned).expected;
    Result result{{determined_calibration(state.given, posterior.information, expected, prior_sigmas), {}, {}},
                  image_shift(problem, sensitivity, nominal)};
    SelfCalibration& refined = result.refined;
    refined.keyframes = static_cast<int>(keyframes.size());
    refined.observations = static_cast<int>(problem.observations.size());
    refined.shift = image_shift(problem, sensitivity, refined.change);
    reject_implausible(refined, expected, state.given, prior_sigmas);
    if (image_shift(problem, sensitivity, refined.change - next.change) > kLinearShift) return result;
    const Pose refined_from_solved = RectifiedChange(at.present(), refined.calibration).after_from_before();
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      refined.keyframes_moved.emplace_back(keyframes[i], refined_from_solved * solved.camera_from_world[i]);
    }
    for (std::size_t i = 0; i < bundle.points.size(); ++i) {
      refined.points_moved.emplace_back(bundle.points[i], solved.points_in_world[i]);
    }
    return result;
  }
}

// Least image motion by a change that makes the given calibration one of another camera, share of the image diagonal.
// Rolling shutter and lens model move the focal length of right calibrations of real recordings too: by up to 3.5 % in
// small maps, by 0.8 % in larger ones. Nominal numbers have no distortion and need less evidence.
double least_shift_of_other(const Calibration& given, std::size_t keyframes) {
  constexpr std::size_t kFewKeyframes = 20;
  constexpr double kShiftFromNominal = 0.003, kShiftByFew = 0.0125, kShift = 0.005;  // 0.005: 2 % of the focal length
  if (is_nominal(given)) return kShiftFromNominal;
  return keyframes < kFewKeyframes ? kShiftByFew : kShift;
}

// Whether the change is beyond errors of a calibration of this camera, and no noise.
bool is_of_other_camera(const SelfCalibration& refined, double least_shift) {
  constexpr double kSignificant = 4.0;  // sigmas of any parameter
  return !refined.was_refused() && refined.shift > least_shift &&
         (refined.change.cwiseAbs().array() > kSignificant * refined.sigma_after.array()).any();
}

}  // namespace

std::optional<SelfCalibration> self_calibrate(const MapWindow& whole, const CalibrationState& state, int rig,
                                              const SelfCalibrationOptions& options,
                                              const std::function<bool()>& should_stop) {
  const std::vector<int> keyframes = choose_keyframes(whole, rig, options.max_keyframes);
  if (static_cast<int>(keyframes.size()) < kMinKeyframes) return std::nullopt;
  const CalibrationFit fit{whole, state, rig, should_stop, keyframes, bundle_of(whole, keyframes)};
  const auto refined_with = [&](const CalibrationVector& prior_sigmas) -> std::optional<SelfCalibration> {
    auto result = fit.with_prior(prior_sigmas);
    return result ? std::optional(std::move(result->refined)) : std::nullopt;
  };
  const CalibrationVector usual = calibrated_sigmas(options.prior_sigmas);
  if (state.given.right) return refined_with(usual);

  const Rig& present = whole.rigs[static_cast<std::size_t>(rig)];
  const double least_shift =
      least_shift_of_other(state.given, keyframes.size()) * std::hypot(present.width, present.height);
  const bool was_other = (state.change.cwiseAbs().array() > kImplausibleSigmas * usual.array()).any();
  if (was_other) {
    auto refined = refined_with(nominal_sigmas());
    if (!refined || is_of_other_camera(*refined, least_shift)) return refined;
  }
  auto given = fit.with_prior(usual);
  if (!given) return std::nullopt;
  if (!was_other && given->nominal_shift > 0.5 * least_shift) {
    auto refined = refined_with(nominal_sigmas());
    if (refined && is_of_other_camera(*refined, least_shift)) return refined;
  }
  return std::move(given->refined);
}

}  // namespace byre
