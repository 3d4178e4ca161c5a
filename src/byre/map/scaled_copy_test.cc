#include "byre/map/scaled_copy.h"

#include "byre/alignment.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/stored_calibration.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr double kFactor = 1.0 / 1.016;

// The scene with the baselines of its rigs and of its given calibrations made equal.
StoredMap consistent_map() {
  StoredMap stored = StoredMapScene().stored_with_plan();
  Eigen::Vector3d& given = stored.recordings[0].calibration.right->right_from_left.translation;
  given *= stored.map.rigs()[0].baseline / given.norm();
  return stored;
}

TEST(ScaledCopy, KeepsAllProjections) {
  const StoredMap before = consistent_map();
  const StoredMap now = scaled_copy(before, kFactor);
  int compared = 0;
  for (const PointId id : before.map.point_ids()) {
    for (const Observation& seen : before.map.observations(id)) {
      const auto rig = static_cast<std::size_t>(before.map.find_keyframe(seen.keyframe)->rig);
      const auto in_camera = [&](const MapGraph& map) {
        return map.camera_from_world(seen.keyframe) * map.find_point(id)->position_in_world;
      };
      if (std::abs(in_camera(before.map).z()) < 0.1) continue;
      const StereoPixel pixel_before = before.map.rigs()[rig].project(in_camera(before.map));
      const StereoPixel pixel_now = now.map.rigs()[rig].project(in_camera(now.map));
      EXPECT_THAT(pixel_now, PointNear(pixel_before, 1e-9 * (1.0 + pixel_before.norm())));
      ++compared;
    }
  }
  EXPECT_GT(compared, 30);
}

TEST(ScaledCopy, ScalesLengthsOnly) {
  const StoredMap before = consistent_map();
  const StoredMap now = scaled_copy(before, kFactor);
  EXPECT_DOUBLE_EQ(now.map.rigs()[0].baseline, kFactor * before.map.rigs()[0].baseline);
  EXPECT_EQ(now.map.rigs()[1].baseline, 0.0);
  EXPECT_EQ(now.map.rigs()[0].body_from_camera.translation, before.map.rigs()[0].body_from_camera.translation);
  const Keyframe& keyframe_before = *before.map.find_keyframe({Origin::offline, 2});
  const Keyframe& keyframe_now = *now.map.find_keyframe({Origin::offline, 2});
  const Matrix6 change = keyframe_now.covariance.cwiseQuotient(keyframe_before.covariance);
  EXPECT_NEAR(change(0, 0), kFactor * kFactor, 1e-12);
  EXPECT_NEAR(change(0, 5), kFactor, 1e-12);
  EXPECT_NEAR(change(5, 5), 1.0, 1e-12);
  const MapPoint& point_before = *before.map.find_point({Origin::offline, 3});
  const MapPoint& point_now = *now.map.find_point({Origin::offline, 3});
  EXPECT_TRUE(point_now.covariance.isApprox(kFactor * kFactor * point_before.covariance, 1e-12));
  EXPECT_FLOAT_EQ(point_now.min_distance, static_cast<float>(kFactor) * point_before.min_distance);
  EXPECT_FLOAT_EQ(point_now.max_distance, static_cast<float>(kFactor) * point_before.max_distance);
  EXPECT_EQ(point_now.reference, point_before.reference);
  EXPECT_EQ(now.map.observations({Origin::offline, 3}), before.map.observations({Origin::offline, 3}));
  EXPECT_EQ(now.map.covisible_keyframes({Origin::offline, 0}, 9).size(),
            before.map.covisible_keyframes({Origin::offline, 0}, 9).size());
  EXPECT_THAT(find_faults(now), IsEmpty());
}

TEST(ScaledCopy, KeepsTheMapInPlaceOnItsPlan) {
  const StoredMap before = consistent_map();
  const StoredMap now = scaled_copy(before, kFactor);
  const PointId id{Origin::offline, 3};
  EXPECT_THAT(now.plan.value().plan_from_map * now.map.find_point(id)->position_in_world,
              PointNear(before.plan.value().plan_from_map * before.map.find_point(id)->position_in_world, 1e-9));
}

TEST(ScaledCopy, ComposesFactors) {
  const StoredMap stored = consistent_map();
  const StoredMap back = scaled_copy(scaled_copy(stored, kFactor), 1.0 / kFactor);
  EXPECT_NEAR(baseline_factor(back, 0), 1.0, 1e-12);
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    EXPECT_THAT(back.map.camera_from_world(id), PoseNear(stored.map.camera_from_world(id), 1e-12, 1e-12));
  }
}

TEST(MovePart, ScalesAndMovesItsKeyframesAndPointsAlone) {
  MapGraph map(Origin::online);
  std::vector<PointId> points;
  for (int i = 0; i < 3; ++i) {
    Keyframe keyframe;
    keyframe.camera_from_world.translation.x() = i;
    if (i > 0) keyframe.parent = KeyframeId{Origin::online, 0};
    MapPoint point;
    point.position_in_world = {1.0, 2.0, 3.0 + i};
    point.reference.keyframe = map.add_keyframe(keyframe);
    points.push_back(map.add_point(point));
  }
  const MapGraph before = map;
  const Similarity motion{2.0, {rotation_exp({0.1, 0.2, 0.3}), {4.0, 5.0, 6.0}}};
  move_part(map, motion, [](KeyframeId id) { return id.number > 0; });
  for (std::uint32_t i = 0; i < 3; ++i) {
    const KeyframeId id{Origin::online, i};
    const Similarity expected = i > 0 ? motion : Similarity{};
    EXPECT_THAT(map.camera_from_world(id), PoseNear(move_camera(expected, before.camera_from_world(id)), 1e-12, 1e-12));
    EXPECT_THAT(map.find_point(points[i])->position_in_world,
                PointNear(expected * before.find_point(points[i])->position_in_world, 1e-12));
  }
}

TEST(ScaledCalibration, ScalesTheBaselineOnly) {
  const Calibration given = consistent_map().recordings[0].calibration;
  const Calibration longer = scaled(given, 1.02);
  EXPECT_TRUE(longer.right->right_from_left.translation.isApprox(1.02 * given.right->right_from_left.translation));
  EXPECT_EQ(longer.right->right_from_left.rotation.coeffs(), given.right->right_from_left.rotation.coeffs());
  EXPECT_EQ(longer.body_from_left.translation, given.body_from_left.translation);
  EXPECT_EQ(longer.left.fx, given.left.fx);
  const Calibration one_camera{given.left, std::nullopt, given.body_from_left};
  EXPECT_EQ(scaled(one_camera, 1.02).body_from_left.translation, given.body_from_left.translation);
}

TEST(KnownCalibration, IsEmptyWhileTheBaselineIsUnchanged) {
  const StoredMap stored = consistent_map();
  EXPECT_EQ(baseline_factor(stored, 0), 1.0);
  EXPECT_FALSE(stored_calibration(stored.recordings, stored.recordings[0].calibration));
}

TEST(KnownCalibration, HasTheBaselineOfARescaledMap) {
  const StoredMap stored = scaled_copy(consistent_map(), kFactor);
  const Calibration given = consistent_map().recordings[0].calibration;
  EXPECT_NEAR(baseline_factor(stored, 0), kFactor, 1e-12);
  EXPECT_EQ(baseline_factor(stored, 1), 1.0) << "one camera";
  const auto known = stored_calibration(stored.recordings, given);
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->calibration.right->right_from_left.translation.norm(), stored.map.rigs()[0].baseline, 1e-12);
}

TEST(KnownCalibration, IsEmptyForOtherCameras) {
  const StoredMap stored = scaled_copy(consistent_map(), kFactor);
  Calibration other = consistent_map().recordings[0].calibration;
  other.right->right_from_left.translation.x() += 1e-6;
  EXPECT_FALSE(stored_calibration(stored.recordings, other));
  other = consistent_map().recordings[0].calibration;
  other.left.fx += 1.0;
  EXPECT_FALSE(stored_calibration(stored.recordings, other));
}

TEST(KnownCalibration, OfAPairAppliesToItsLeftCamera) {
  const StoredMap stored = scaled_copy(consistent_map(), kFactor);
  Calibration left = consistent_map().recordings[0].calibration;
  left.right.reset();
  const auto known = stored_calibration(stored.recordings, left);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->calibration.left, left.left);
  EXPECT_FALSE(known->calibration.right);
}

TEST(KnownCalibration, AppliesToTheSameCameraOnAnotherBody) {
  StoredMap stored = scaled_copy(consistent_map(), kFactor);
  Calibration given = consistent_map().recordings[0].calibration;
  const Pose map_body_from_body{rotation_exp({0.1, 0.2, 0.3}), {0.3, 0.2, 0.1}};
  EXPECT_TRUE(has_same_cameras(stored.recordings, given));
  given.body_from_left = inverse(map_body_from_body) * given.body_from_left;
  EXPECT_FALSE(has_same_cameras(stored.recordings, given));
  const auto change = stored_body_from_body(stored.recordings, given);
  ASSERT_TRUE(change);
  EXPECT_THAT(*change, PoseNear(map_body_from_body, 1e-9, 1e-9));
  const auto known = stored_calibration(stored.recordings, given);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->calibration.body_from_left, given.body_from_left);
  given.left.fx += 1.0;
  EXPECT_FALSE(stored_body_from_body(stored.recordings, given));
}

TEST(UpOfBase, IsThatOfTheStoredMounting) {
  StoredMap stored = consistent_map();
  stored.recordings.resize(1);
  EXPECT_FALSE(up_of_base(stored)) << "no wheels";
  OdometryCalibration calibration;
  calibration.wheels = upright_wheel_calibration(Eigen::Vector3d(0.0, -1.0, 0.2).normalized(), 0.02);
  write_odometry_calibration(calibration, stored.notes);
  const auto up = up_of_base(stored);
  ASSERT_TRUE(up);
  EXPECT_LT((up->up - Eigen::Vector3d(0.0, -1.0, 0.2).normalized()).norm(), 1e-6);
  EXPECT_NEAR(up->sigma, 0.02, 1e-6);
  stored.recordings.push_back(stored.recordings.front());
  EXPECT_TRUE(up_of_base(stored)) << "the same cameras again";
  stored.recordings.back().calibration.body_from_left.translation.x() += 0.1;
  EXPECT_FALSE(up_of_base(stored)) << "another body";
  stored.recordings.pop_back();
  calibration.wheels = upright_wheel_calibration(-Eigen::Vector3d::UnitY(), 0.3);
  write_odometry_calibration(calibration, stored.notes);
  EXPECT_FALSE(up_of_base(stored)) << "hardly known";
}

TEST(Stretch, ScalesDistancesToRemovedKeyframesToo) {
  MapGraph map = consistent_map().map;
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  map.remove_keyframe(ids.back());
  ASSERT_EQ(map.keyframe_count(), static_cast<int>(ids.size()) - 1);
  const MapGraph before = map;
  rescale(map, 2.0);
  for (const KeyframeId id : ids) {
    EXPECT_THAT(map.camera_from_world(id), PoseNear(scale_lengths(before.camera_from_world(id), 2.0), 1e-9, 1e-9));
  }
  for (const PointId id : before.point_ids()) {
    const MapPoint &point = *before.find_point(id), &now = *map.find_point(id);
    EXPECT_TRUE(now.position_in_world.isApprox(2.0 * point.position_in_world, 1e-12));
    EXPECT_TRUE(now.covariance.isApprox(4.0 * point.covariance, 1e-12));
  }
}

}  // namespace
}  // namespace byre
