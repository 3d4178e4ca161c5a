#include "byre/geometry/two_view_models.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/essential.h"
#include "byre/geometry/homography.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace byre {
namespace {

using Matches = std::span<const TwoViewMatch>;

// 95 % of chi-square, two degrees of freedom: bound of transferred points, and the largest score of an inlier.
constexpr double kMaxTransferError = 5.99;

// Score of a match under a model; eq. 2 of Mur-Artal et al. 2015 for both views.
struct Agreement {
  double score = 0.0;
  bool inlier = false;
};

Agreement agreement(double error_in_first, double error_in_second, double max_error) {
  Agreement agreed;
  agreed.inlier = error_in_first < max_error && error_in_second < max_error;
  if (error_in_first < max_error) agreed.score += kMaxTransferError - error_in_first;
  if (error_in_second < max_error) agreed.score += kMaxTransferError - error_in_second;
  return agreed;
}

// Squared sigmas between a ray and the transferred ray of the other view; both have noise.
double transfer_error(const Eigen::Vector3d& transferred, const Eigen::Vector3d& ray, double sigma) {
  const Eigen::Vector2d error = transferred.head<2>() / transferred.z() - ray.head<2>();
  return error.squaredNorm() / (2.0 * sigma * sigma);
}

// Score of a match under a homography, from point to point.
class Transfer {
 public:
  explicit Transfer(const Eigen::Matrix3d& homography)
      : second_from_first_(homography), first_from_second_(homography.inverse()) {}

  Agreement operator()(const TwoViewMatch& match) const {
    return agreement(transfer_error(first_from_second_ * match.ray_in_second, match.ray_in_first, match.sigma),
                     transfer_error(second_from_first_ * match.ray_in_first, match.ray_in_second, match.sigma),
                     kMaxTransferError);
  }

 private:
  Eigen::Matrix3d second_from_first_;
  Eigen::Matrix3d first_from_second_;
};

// Score of a match under a motion, from point to epipolar line.
class LineTransfer {
 public:
  explicit LineTransfer(const Pose& motion) : essential_(essential_of(motion)) {}

  Agreement operator()(const TwoViewMatch& match) const {
    const Eigen::Vector3d line_in_second = essential_ * match.ray_in_first;
    const Eigen::Vector3d line_in_first = essential_.transpose() * match.ray_in_second;
    const double product = match.ray_in_second.dot(line_in_second);
    const double squared = product * product / (2.0 * match.sigma * match.sigma);
    return agreement(squared / line_in_first.head<2>().squaredNorm(), squared / line_in_second.head<2>().squaredNorm(),
                     kMaxEpipolarError);
  }

 private:
  Eigen::Matrix3d essential_;
};

template <typename Test>
std::vector<TwoViewMatch> inliers_of(const Test& test, Matches matches) {
  std::vector<TwoViewMatch> inliers;
  std::ranges::copy_if(matches, std::back_inserter(inliers),
                       [&](const TwoViewMatch& match) { return test(match).inlier; });
  return inliers;
}

// The rotation that aligns the first rays with the second ones (Umeyama 1991, without scale and translation).
Eigen::Quaterniond fit_rotation(Matches matches) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const TwoViewMatch& match : matches) {
    products.noalias() += match.ray_in_second.normalized() * match.ray_in_first.normalized().transpose();
  }
  return nearest_rotation(products);
}

// Traits of the three models: sample size, minimal solver, test of a match, and refinement.
struct RotationKind {
  using Model = Eigen::Quaterniond;
  static constexpr std::size_t kSample = 2;
  static Model none() { return Model::Identity(); }
  static std::vector<Model> solve(const std::array<TwoViewMatch, kSample>& sample) { return {fit_rotation(sample)}; }
  static Transfer test(const Model& model) { return Transfer(model.toRotationMatrix()); }
  static Model refine(const Model& model, Matches matches) {
    const std::vector<TwoViewMatch> inliers = inliers_of(test(model), matches);
    return inliers.size() < kSample ? model : fit_rotation(inliers);
  }
};

struct HomographyKind {
  using Model = Eigen::Matrix3d;
  static constexpr std::size_t kSample = 4;
  static Model none() { return Model::Identity(); }
  static std::vector<Model> solve(const std::array<TwoViewMatch, kSample>& sample) {
    const auto homography = fit_homography(sample);
    return homography ? std::vector<Model>{*homography} : std::vector<Model>{};
  }
  static Transfer test(const Model& model) { return Transfer(model); }
  static Model refine(const Model& model, Matches matches) {
    return fit_homography(inliers_of(test(model), matches)).value_or(model);
  }
};

struct EssentialKind {
  using Model = Pose;
  static constexpr std::size_t kSample = 5;
  static Model none() { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d::UnitX()}; }
  static std::vector<Model> solve(const std::array<TwoViewMatch, kSample>& sample) {
    std::vector<Model> motions;
    for (const Eigen::Matrix3d& essential : five_point_essentials(sample)) {
      motions.push_back(motions_from_essential(essential).front());
    }
    return motions;
  }
  static LineTransfer test(const Model& model) { return LineTransfer(model); }
  static Model refine(const Model& model, Matches matches) { return refine_motion(model, matches); }
};

// Stops with a score of zero once score_to_beat cannot be reached.
template <typename Kind>
TwoViewModel<typename Kind::Model> score(const typename Kind::Model& model, Matches matches, double score_to_beat) {
  const auto test = Kind::test(model);
  TwoViewModel<typename Kind::Model> scored{model};
  double within_reach = 2.0 * kMaxTransferError * static_cast<double>(matches.size());
  for (const TwoViewMatch& match : matches) {
    const Agreement agreed = test(match);
    scored.score += agreed.score;
    scored.inliers += agreed.inlier;
    within_reach -= 2.0 * kMaxTransferError - agreed.score;
    if (within_reach <= score_to_beat) return {model};
  }
  return scored;
}

template <std::size_t kSample>
std::array<TwoViewMatch, kSample> draw_sample(Matches matches, std::mt19937_64& random) {
  std::array<std::size_t, kSample> drawn{};
  std::array<TwoViewMatch, kSample> sample;
  for (std::size_t i = 0; i < kSample; ++i) {
    const auto before = drawn.begin() + static_cast<std::ptrdiff_t>(i);
    do {
      drawn[i] = static_cast<std::size_t>(random() % matches.size());  // draws equal on all platforms
    } while (std::find(drawn.begin(), before, drawn[i]) != before);
    sample[i] = matches[drawn[i]];
  }
  return sample;
}

// Number of draws until a sample without outliers has occurred with the wanted confidence (Fischler and Bolles 1981).
int draws_needed(double inlier_ratio, std::size_t sample_size, const TwoViewSearch& search) {
  const double all_inliers = std::pow(inlier_ratio, static_cast<double>(sample_size));
  if (all_inliers >= 1.0) return 1;
  if (!(all_inliers > 0.0)) return search.max_iterations;
  const double draws = std::log(1.0 - search.confidence) / std::log1p(-all_inliers);
  return static_cast<int>(std::min(std::ceil(draws), static_cast<double>(search.max_iterations)));
}

// Refits to the inliers while the score rises (Chum, Matas and Kittler 2003).
template <typename Kind>
TwoViewModel<typename Kind::Model> locally_best(TwoViewModel<typename Kind::Model> best, Matches matches) {
  constexpr int kMaxRounds = 10;
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto refined = score<Kind>(Kind::refine(best.second_from_first, matches), matches, best.score);
    if (!(refined.score > best.score)) break;
    best = refined;
  }
  return best;
}

template <typename Kind>
TwoViewModel<typename Kind::Model> best_model(Matches matches, const TwoViewSearch& search) {
  TwoViewModel<typename Kind::Model> best{Kind::none()};
  if (matches.size() < Kind::kSample) return best;
  std::mt19937_64 random(search.seed);
  int draws = search.max_iterations;
  for (int i = 0; i < draws; ++i) {
    for (const auto& model : Kind::solve(draw_sample<Kind::kSample>(matches, random))) {
      const auto candidate = score<Kind>(model, matches, best.score);
      if (!(candidate.score > best.score)) continue;
      best = locally_best<Kind>(candidate, matches);
      const double inlier_ratio = best.inliers / static_cast<double>(matches.size());
      draws = draws_needed(inlier_ratio, Kind::kSample, search);
    }
  }
  return best;
}

// Parameters of a motion: rotation about the second camera, and tangential shift of the translation's direction.
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

Eigen::Matrix<double, 3, 2> tangents_of(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d first = direction.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> tangents;
  tangents << first, direction.cross(first);
  return tangents;
}

Pose moved(const Pose& motion, const Vector5& step) {
  const Eigen::Vector3d direction = motion.translation + tangents_of(motion.translation) * step.tail<2>();
  return {(rotation_exp(step.head<3>()) * motion.rotation).normalized(), direction.normalized()};
}

double cost_of(const Pose& motion, Matches matches) {
  const Eigen::Matrix3d essential = essential_of(motion);
  double cost = 0.0;
  for (const TwoViewMatch& match : matches) cost += std::min(epipolar_error(essential, match), kMaxEpipolarError);
  return cost;
}

struct TwoViewEquations {
  Matrix5 information = Matrix5::Zero();
  Vector5 gradient = Vector5::Zero();
};

// Gauss-Newton with the lengths of the epipolar lines held constant.
TwoViewEquations linearise(const Pose& motion, Matches matches) {
  const Eigen::Matrix3d rotation = motion.rotation.toRotationMatrix();
  const Eigen::Matrix3d essential = skew(motion.translation) * rotation;
  const Eigen::Matrix<double, 3, 2> tangents = tangents_of(motion.translation);
  TwoViewEquations equations;
  for (const TwoViewMatch& match : matches) {
    const double squared_error = epipolar_error(essential, match);
    if (!(squared_error < kMaxEpipolarError)) continue;
    const Eigen::Vector3d turned = rotation * match.ray_in_first;
    // Derivative of second . (translation x turned).
    const Eigen::Vector3d by_translation = turned.cross(match.ray_in_second);
    const double product = motion.translation.dot(by_translation);
    const Eigen::Vector3d by_turn = turned.cross(match.ray_in_second.cross(motion.translation));
    const double error_per_product = product == 0.0 ? 1.0 / match.sigma : std::sqrt(squared_error) / std::abs(product);
    Vector5 jacobian;
    jacobian.head<3>() = by_turn;
    jacobian.tail<2>() = tangents.transpose() * by_translation;
    jacobian *= error_per_product;
    equations.information.noalias() += jacobian * jacobian.transpose();
    equations.gradient.noalias() += jacobian * (error_per_product * product);
  }
  return equations;
}

}  // namespace

double epipolar_error(const Eigen::Matrix3d& essential, const TwoViewMatch& match) {
  const Eigen::Vector3d line_in_second = essential * match.ray_in_first;
  const Eigen::Vector3d line_in_first = essential.transpose() * match.ray_in_second;
  const double product = match.ray_in_second.dot(line_in_second);
  const double gradient = line_in_second.head<2>().squaredNorm() + line_in_first.head<2>().squaredNorm();
  return product * product / (gradient * match.sigma * match.sigma);
}

Pose refine_motion(const Pose& second_from_first, std::span<const TwoViewMatch> matches) {
  constexpr int kMaxSteps = 15;
  constexpr double kConverged = 1e-6;  // relative decrease of the cost
  Pose best{second_from_first.rotation, second_from_first.translation.normalized()};
  double cost = cost_of(best, matches);
  double damping = 1e-4;
  TwoViewEquations equations = linearise(best, matches);
  for (int step = 0; step < kMaxSteps; ++step) {
    Matrix5 damped = equations.information;
    damped.diagonal() *= 1.0 + damping;
    const Pose trial = moved(best, -damped.ldlt().solve(equations.gradient));
    const double trial_cost = cost_of(trial, matches);
    if (!(trial_cost < cost)) {
      damping *= 10.0;
      continue;
    }
    const bool converged = cost - trial_cost < kConverged * cost;
    best = trial;
    cost = trial_cost;
    if (converged) break;
    damping *= 0.1;
    equations = linearise(best, matches);
  }
  return best;
}

double direction_sigma(const Pose& second_from_first, std::span<const TwoViewMatch> matches) {
  constexpr std::size_t kUnknowns = 5;  // each match is one equation
  if (matches.size() < kUnknowns) return std::numeric_limits<double>::infinity();
  const Pose motion{second_from_first.rotation, second_from_first.translation.normalized()};
  const Eigen::LDLT<Matrix5> information(linearise(motion, matches).information);
  if (!information.isPositive() || !(information.rcond() > 1e-12)) return std::numeric_limits<double>::infinity();
  const Matrix5 covariance = information.solve(Matrix5::Identity());
  const Eigen::Matrix2d of_direction = covariance.bottomRightCorner<2, 2>();
  return std::sqrt(std::max(0.0, symmetric_eigenvalues(of_direction)[1]));
}

TwoViewModel<Eigen::Quaterniond> search_rotation(std::span<const TwoViewMatch> matches, const TwoViewSearch& search) {
  return best_model<RotationKind>(matches, search);
}

TwoViewModel<Eigen::Matrix3d> search_homography(std::span<const TwoViewMatch> matches, const TwoViewSearch& search) {
  return best_model<HomographyKind>(matches, search);
}

TwoViewModel<Pose> search_essential(std::span<const TwoViewMatch> matches, const TwoViewSearch& search) {
  return best_model<EssentialKind>(matches, search);
}

}  // namespace byre
