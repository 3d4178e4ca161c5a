#include "byre/slam/tracking/tracking_steps.h"

#include "byre/optimise/optimise_scene.h"

#include <numeric>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kPoints = 40;

// Points on a wall 3 m ahead, measured without error from the origin.
MeasuredPoints wall() {
  MeasuredPoints measured;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d point(0.4 * (i % 8 - 3.5), 0.4 * (i / 8 - 2), 3.0);
    measured.observations.push_back({point, Eigen::Matrix3d::Zero(), stereo_rig().project(point), 0.5});
    measured.features.push_back({i, {}, stereo_rig().project(point).head<2>().cast<float>(), 0.5F});
  }
  return measured;
}

std::vector<int> agreeing(const MeasuredPoints& measured, const Pose& camera_from_world, double sigma_to_the_right) {
  Matrix6 covariance = 1e-10 * Matrix6::Identity();
  covariance(0, 0) += sigma_to_the_right * sigma_to_the_right;
  PartedPoints parted;
  part_by_agreement(camera_from_world, covariance, stereo_rig(), measured, 1.0, parted);
  EXPECT_EQ(parted.agreeing.features.size() + parted.disagreeing.size(), measured.features.size());
  std::vector<int> features;
  for (const TrackedFeature& feature : parted.agreeing.features) features.push_back(feature.feature);
  return features;
}

TEST(PartByAgreement, AllowsForTheErrorOfThePose) {
  const Pose beside{Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0}};  // 15 pixels
  std::vector<int> all(kPoints);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(agreeing(wall(), Pose{}, 0.0), all);
  EXPECT_THAT(agreeing(wall(), beside, 0.0), ::testing::IsEmpty());
  EXPECT_EQ(agreeing(wall(), beside, 0.1), all);
}

TEST(PartByAgreement, AllowsForItInItsDirectionOnly) {
  MeasuredPoints measured = wall();
  measured.observations[5].measured.y() += 10.0;
  const std::vector<int> agreed = agreeing(measured, Pose{}, 0.1);
  EXPECT_EQ(agreed.size(), kPoints - 1U);
  EXPECT_THAT(agreed, ::testing::Not(::testing::Contains(5)));
}

}  // namespace
}  // namespace byre
