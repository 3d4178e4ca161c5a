#include "byre/slam/calibration/row_evidence.h"

#include "byre/geometry/median.h"
#include "byre/optimise/robust_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr int kPartColumns = 8;
constexpr int kPartRows = 6;
constexpr double kRowHuberWidth = 2.0;  // sigmas

// Mean over the rows of one part of the image.
struct PartMean {
  double offset = 0.0;    // pixels
  double variance = 0.0;  // squared pixels, by the sigmas of the rows alone
  CalibrationVector by_calibration = CalibrationVector::Zero();
};

struct WeighedRows {
  CalibrationEquations equations;  // with independent errors of all rows
  std::vector<PartMean> means;     // one for each part with rows
};

// Weighs each row by its residual after the change.
WeighedRows weighed(const std::vector<RowMeasurement>& rows, const CalibrationVector& change) {
  std::vector<double> residuals, deviations;
  residuals.reserve(rows.size());
  deviations.reserve(rows.size());
  for (const RowMeasurement& row : rows) {
    residuals.push_back((row.offset - row.by_calibration.cast<double>().dot(change)) / row.sigma);
    deviations.push_back(std::abs(residuals.back()));
  }
  const double scale = robust_scale(std::move(deviations));
  std::array<PartMean, std::size_t{kPartColumns * kPartRows}> sums;
  std::array<double, sums.size()> weights{};
  WeighedRows result;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RowMeasurement& row = rows[i];
    const double residual = residuals[i] / scale;
    const double weight =
        huber_weight(residual * residual, kRowHuberWidth) / std::pow(scale * static_cast<double>(row.sigma), 2);
    const CalibrationVector by_calibration = row.by_calibration.cast<double>().transpose();
    result.equations.information.noalias() += weight * by_calibration * by_calibration.transpose();
    result.equations.right_side += weight * row.offset * by_calibration;
    weights[row.part] += weight;
    sums[row.part].offset += weight * row.offset;
    sums[row.part].by_calibration += weight * by_calibration;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (weights[i] == 0.0) continue;
    result.means.push_back({sums[i].offset / weights[i], 1.0 / weights[i], sums[i].by_calibration / weights[i]});
  }
  return result;
}

// Normal equations of the means, with an additional variance of each.
CalibrationEquations equations_of(const std::vector<PartMean>& means, double own_variance) {
  CalibrationEquations equations;
  for (const PartMean& mean : means) {
    const double weight = 1.0 / (own_variance + mean.variance);
    equations.information.noalias() += weight * mean.by_calibration * mean.by_calibration.transpose();
    equations.right_side += weight * mean.offset * mean.by_calibration;
  }
  return equations;
}

// Squared residuals of the means, in sigmas, and their degrees of freedom.
struct Misfit {
  double squares = 0.0;
  double freedom = 1.0;
};

Misfit misfit_of(const std::vector<PartMean>& means, double own_variance, const CalibrationEstimate& prior) {
  const CalibrationEquations told = equations_of(means, own_variance);
  const CalibrationEstimate known = joined(prior, told);
  const double used_up = known.information.ldlt().solve(told.information).trace();
  Misfit misfit{0.0, std::max(1.0, static_cast<double>(means.size()) - used_up)};
  for (const PartMean& mean : means) {
    const double residual = mean.offset - mean.by_calibration.dot(known.expected);
    misfit.squares += residual * residual / (own_variance + mean.variance);
  }
  return misfit;
}

// Additional variance of the means that explains their differences; 0 if noise explains them.
double own_variance_of(const std::vector<PartMean>& means, const CalibrationEstimate& prior) {
  constexpr double kLeast = 1e-6, kMost = 1.0;  // squared pixels
  constexpr int kHalvings = 12;
  constexpr double kSigmas = 2.0;
  const Misfit by_noise = misfit_of(means, 0.0, prior);
  if (by_noise.squares <= by_noise.freedom + kSigmas * std::sqrt(2.0 * by_noise.freedom)) return 0.0;
  double low = kLeast, high = kMost;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    const Misfit misfit = misfit_of(means, middle, prior);
    (misfit.squares > misfit.freedom ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace

std::size_t part_of_image(const Eigen::Vector2f& pixel, const Rig& rig) {
  const auto cell = [](float x, int size, int cells) {
    return std::clamp(static_cast<int>(static_cast<float>(cells) * x / static_cast<float>(size)), 0, cells - 1);
  };
  const int column = cell(pixel.x(), rig.width, kPartColumns), row = cell(pixel.y(), rig.height, kPartRows);
  return static_cast<std::size_t>(row * kPartColumns + column);
}

CalibrationEstimate learn_from_rows(const std::vector<RowMeasurement>& rows, const CalibrationEstimate& prior) {
  constexpr int kRounds = 5;
  CalibrationEstimate knowledge = prior;
  for (int round = 0; round < kRounds; ++round) {
    const WeighedRows now = weighed(rows, knowledge.expected);
    const double own_variance = own_variance_of(now.means, prior);
    knowledge = joined(prior, own_variance > 0.0 ? equations_of(now.means, own_variance) : now.equations);
  }
  return knowledge;
}

}  // namespace byre
