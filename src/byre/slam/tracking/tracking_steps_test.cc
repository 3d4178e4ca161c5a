#include "byre/slam/tracking/tracking_steps.h"

#include "byre/optimise/optimise_scene.h"
#include "byre/slam/tracking/keyframes.h"

#include <cmath>
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
  const PartedPoints parted = part_by_agreement(camera_from_world, covariance, stereo_rig(), measured, 1.0);
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

Patch patch_with(double phase) {
  Patch patch;
  patch.centre = {8.0F, 8.0F};
  for (int row = 0; row < Patch::kSize; ++row) {
    for (int column = 0; column < Patch::kSize; ++column) {
      const double grey = 128.0 + 60.0 * std::sin(0.9 * column + phase) * std::cos(0.7 * row + 2.0 * phase);
      patch.pixels[static_cast<std::size_t>(row * Patch::kSize + column)] = static_cast<std::uint8_t>(grey);
    }
  }
  return patch;
}

// Number of measured matches of a point ahead, mapped from the origin, in a frame there.
std::size_t count_measured(Origin origin, const std::vector<Patch>& patches_of_frame,
                           const std::vector<Patch>& patches_of_map = {patch_with(0.0)}) {
  const Eigen::Vector3d ahead(0.0, 0.0, 3.0);
  const Rig rig = stereo_rig();
  Keypoint keypoint;
  keypoint.pixel = rig.project(ahead).head<2>().cast<float>();
  const auto features = [&](const std::vector<Patch>& patches) {
    return std::make_shared<const Features>(rig.width, rig.height, std::vector{keypoint}, std::vector{Descriptor{}},
                                            patches);
  };
  MapGraph map(origin);
  Keyframe keyframe;
  keyframe.frame.features = features(patches_of_map);
  keyframe.rig = map.add_rig(rig);
  keyframe.sightings.resize(1);
  keyframe.sightings[0].pixel = keypoint.pixel;
  const KeyframeId id = map.add_keyframe(keyframe);
  const PointId point =
      map.add_point(make_point(ahead, Eigen::Matrix3d::Zero(), {id, 0}, *keyframe.frame.features, Pose{}));
  const std::array<PointMatch, 1> matches{{{0, point}}};
  const MeasuredPoints measured = measure_matches({.features = features(patches_of_frame)}, Pose{}, rig, map, matches);
  EXPECT_EQ(measured.features.size(), measured.observations.size());
  return measured.features.size();
}

TEST(MeasureMatches, LeavesOutOfflinePointsWhosePatchDoesNotFit) {
  EXPECT_EQ(count_measured(Origin::offline, {patch_with(0.0)}), 1U);
  EXPECT_EQ(count_measured(Origin::offline, {patch_with(1.3)}), 0U);
}

TEST(MeasureMatches, MeasuresOnlinePointsWhosePatchDoesNotFitByTheirCorners) {
  EXPECT_EQ(count_measured(Origin::online, {patch_with(1.3)}), 1U);
}

TEST(MeasureMatches, MeasuresOfflinePointsByTheirCornersIfTheFrameOrTheMapHasNoPatch) {
  EXPECT_EQ(count_measured(Origin::offline, {}), 1U);
  EXPECT_EQ(count_measured(Origin::offline, {patch_with(1.3)}, {}), 1U);
}

}  // namespace
}  // namespace byre
