#include "byre/slam/calibration/row_evidence.h"

#include "byre/geometry/calibration_scene.h"
#include "byre/geometry/rectification.h"

#include <functional>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr float kRowSigma = 0.1f;  // pixels
constexpr double kSigmasOfPrior = 2.0;

const CalibrationEstimate kPrior{CalibrationMatrix::Identity() / (kSigmasOfPrior * kSigmasOfPrior),
                                 CalibrationVector::Zero()};

using OffsetAt = std::function<double(const Eigen::Vector2f& pixel)>;  // pixels

// Rows of corners all over the image with this calibration error, plus own_error at the corner.
std::vector<RowMeasurement> rows_of(const CalibrationVector& error, const OffsetAt& own_error, int count) {
  const Calibration calibration = scene_calibration();
  const CalibrationSensitivity sensitivity(calibration);
  const Rig rig = rectification_of(calibration).rig;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(0.05, 0.95), disparity(2.0, 40.0);
  std::normal_distribution<double> noise(0.0, kRowSigma);
  std::vector<RowMeasurement> rows;
  for (int i = 0; i < count; ++i) {
    const double u = place(random) * rig.width;
    const double v = place(random) * rig.height;
    const Eigen::Vector2d pixel(u, v);
    const Eigen::Matrix<double, 1, kCalibrationParameters> by_calibration =
        sensitivity.at({pixel.x(), pixel.y(), disparity(random)}).row(3);
    const Eigen::Vector2f seen = pixel.cast<float>();
    const double offset = by_calibration.dot(error) + own_error(seen) + noise(random);
    rows.push_back({static_cast<float>(offset), kRowSigma, part_of_image(seen, rig), by_calibration.cast<float>()});
  }
  return rows;
}

double no_error(const Eigen::Vector2f&) {
  return 0.0;
}

// The parameter that rows determine best: rotation of the right camera about its optical axis.
constexpr int kTurn = kRightRotation + 2;

TEST(RowEvidence, EstimatesTheRelativeRotationOfTheCameras) {
  CalibrationVector error = CalibrationVector::Zero();
  error[kTurn] = 3.0;
  const CalibrationEstimate known = learn_from_rows(rows_of(error, no_error, 20000), kPrior);
  const double sigma = std::sqrt(known.information.inverse()(kTurn, kTurn));
  EXPECT_LT(sigma, 0.3);
  EXPECT_NEAR(known.expected[kTurn], 3.0, 4.0 * sigma);
}

// Largest deviation of a parameter from zero, in its sigmas.
double most_sigmas(const CalibrationEstimate& known) {
  const CalibrationVector sigmas = known.information.inverse().diagonal().cwiseSqrt();
  return known.expected.cwiseQuotient(sigmas).cwiseAbs().maxCoeff();
}

CalibrationEstimate learn_one_by_one(const std::vector<RowMeasurement>& rows) {
  CalibrationEquations told;
  for (const RowMeasurement& row : rows) {
    const CalibrationVector by_calibration = row.by_calibration.cast<double>().transpose() / row.sigma;
    told.information += by_calibration * by_calibration.transpose();
    told.right_side += row.offset / row.sigma * by_calibration;
  }
  return joined(kPrior, told);
}

// Roof beams in front of a far wall stay in the upper half of the image all the way through an alley.
TEST(RowEvidence, IgnoresSharedRowErrors) {
  const OffsetAt leaning = [](const Eigen::Vector2f& pixel) {
    return pixel.y() > 240.0f ? 0.0 : 0.06 * (pixel.x() - 376.0f) / 376.0f;
  };
  const std::vector<RowMeasurement> rows = rows_of(CalibrationVector::Zero(), leaning, 200000);
  EXPECT_GT(most_sigmas(learn_one_by_one(rows)), 15.0);
  EXPECT_LT(most_sigmas(learn_from_rows(rows, kPrior)), 6.0) << "the lean is smooth, so parts are not independent";
}

TEST(RowEvidence, IsMoreCertainWithMoreRows) {
  const auto information_of = [](const OffsetAt& own_error, int count) {
    return learn_from_rows(rows_of(CalibrationVector::Zero(), own_error, count), kPrior).information(kTurn, kTurn);
  };
  const OffsetAt by_part = [](const Eigen::Vector2f& pixel) {
    return 0.05 * std::sin(37.0 * std::floor(pixel.x() / 94.0f) + 11.0 * std::floor(pixel.y() / 80.0f));
  };
  EXPECT_GT(information_of(no_error, 80000), 3.5 * information_of(no_error, 20000));
  EXPECT_LT(information_of(by_part, 80000), 1.5 * information_of(by_part, 20000));
}

TEST(RowEvidence, IsEmptyWithoutRows) {
  const CalibrationEstimate known = learn_from_rows({}, kPrior);
  EXPECT_TRUE(known.information.isApprox(kPrior.information));
  EXPECT_TRUE(known.expected.isZero());
}

}  // namespace
}  // namespace byre
