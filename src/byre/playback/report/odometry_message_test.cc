#include "byre/playback/report/ros_report.h"

#include "byre/io/ros/message_matchers.h"
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;

Matrix6 matrix_of(const ros::TwistWithCovariance& message) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.covariance.data());
}

Matrix6 diagonal(double position_sigma, double rotation_sigma) {
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(position_sigma * position_sigma),
      Eigen::Vector3d::Constant(rotation_sigma * rotation_sigma);
  return variances.asDiagonal();
}

double smallest_eigenvalue(const Matrix6& covariance) {
  return Eigen::SelfAdjointEigenSolver<Matrix6>(covariance).eigenvalues().minCoeff();
}

TEST(TwistMessage, HasTheCovarianceOfTwoPoses) {
  const OdometrySample before{100ms, {}, diagonal(0.003, 0.001)};
  const OdometrySample now{200ms, {Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}}, diagonal(0.004, 0.002)};
  const ros::TwistWithCovariance message = twist_message(before, now);
  EXPECT_NEAR(message.twist.linear.x, 0.5, 1e-12);
  const Matrix6 covariance = matrix_of(message);
  EXPECT_NEAR(covariance(0, 0), 0.05 * 0.05 + 0.05 * 0.05, 1e-12) << "5 mm in 0.1 s, and half of 0.1 m/s";
  EXPECT_NEAR(covariance(3, 3), 5e-4 + 0.1 * 0.1, 1e-12) << "2.2 mrad in 0.1 s, and half of 0.2 rad/s";
  EXPECT_NEAR(covariance(1, 1), covariance(0, 0) + 0.05 * 0.05 * 1e-6 / 0.01, 1e-12) << "and the lever of 5 cm";
}

TEST(TwistMessage, IsInTheBaseFrameOfTheSecondPose) {
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));  // turns x to y
  Matrix6 covariance = diagonal(1e-3, 1e-3);
  covariance(0, 0) = 1e-2;  // along x of the first base
  const Matrix6 turned = matrix_of(twist_message(OdometrySample{0ms, {}, covariance},
                                                 {1000ms, {quarter, Eigen::Vector3d::Zero()}, diagonal(1e-3, 1e-3)}));
  EXPECT_NEAR(turned(1, 1) - turned(0, 0), 1e-2 - 1e-6, 1e-9) << "x of the first base is y of the second one";
  // The odometry frame has no effect.
  const Pose elsewhere{rotation_exp({0.3, 0.2, -1.0}), {5.0, -3.0, 1.0}};
  const Matrix6 same =
      matrix_of(twist_message(OdometrySample{0ms, elsewhere, covariance},
                              {1000ms, elsewhere * Pose{quarter, Eigen::Vector3d::Zero()}, diagonal(1e-3, 1e-3)}));
  EXPECT_LT((same - turned).cwiseAbs().maxCoeff(), 1e-12);
}

// Real covariances are correlated and span orders of magnitude.
TEST(TwistMessage, IsPositiveDefinite) {
  for (int i = 1; i <= 20; ++i) {
    Matrix6 root;
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) root(row, column) = 0.01 * std::sin(i + 7.0 * row + 3.0 * column);
    }
    const Pose pose{rotation_exp({0.1 * i, 0.2, 0.3}), {0.1 * i, 2.0, 0.0}};
    const Pose moved = pose * Pose{rotation_exp({0.0, 0.0, 0.02 * i}), {0.05 * i, 0.0, 0.0}};
    const Matrix6 covariance = matrix_of(
        twist_message(OdometrySample{0ms, pose, root * root.transpose()}, {50ms, moved, diagonal(1e-6, 1e-6)}));
    EXPECT_GT(smallest_eigenvalue(covariance), 1e-4) << i;
    EXPECT_LT((covariance - covariance.transpose()).cwiseAbs().maxCoeff(), 1e-9 * covariance.trace()) << i;
  }
}

TEST(TwistMessage, IsUnknownWithoutTwoKnownPoses) {
  const OdometrySample known{50ms, {}, diagonal(1e-3, 1e-3)}, unknown{50ms, {}};
  const OdometrySample later{100ms, {Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}}, diagonal(1e-3, 1e-3)};
  const Matrix6 large = kUnknownVariance * Matrix6::Identity();
  EXPECT_EQ(matrix_of(twist_message(std::nullopt, later)), large);
  EXPECT_EQ(matrix_of(twist_message(later, known)), large) << "the time goes back";
  EXPECT_EQ(twist_message(later, known).twist, ros::Twist());
  const ros::TwistWithCovariance from_unknown = twist_message(unknown, later);
  EXPECT_EQ(matrix_of(from_unknown), large);
  EXPECT_NEAR(from_unknown.twist.linear.x, 1.0, 1e-12);
}

// The covariance of odometry grows with the way, which consecutive frames share.
TEST(OdometrySample, ExcludesTheSharedDriftIfTheMapPoseIsBetterKnown) {
  FrameReport report;
  report.odometry_covariance = diagonal(0.5, 0.05);
  report.covariance = diagonal(0.002, 0.001);
  EXPECT_EQ(odometry_sample(report, {}).covariance, report.odometry_covariance) << "no pose in the map";
  report.map_from_body = Pose{};
  EXPECT_EQ(odometry_sample(report, {}).covariance, report.covariance);
  report.covariance = diagonal(0.6, 0.001);
  EXPECT_EQ(odometry_sample(report, {}).covariance, report.odometry_covariance) << "the map pose is worse";
  report.covariance.setZero();
  EXPECT_EQ(odometry_sample(report, {}).covariance, report.odometry_covariance) << "zero means unknown";
}

}  // namespace
}  // namespace byre
