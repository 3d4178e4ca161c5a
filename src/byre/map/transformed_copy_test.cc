#include "byre/map/scaled_copy.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/mapped_tag.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

const Similarity kTargetFromMap{1.5, {rotation_exp({0.3, -1.1, 0.4}), {5.0, -2.0, 0.7}}};

const MapPoint& point(const StoredMap& stored, std::uint32_t number) {
  return *stored.map.find_point({Origin::offline, number});
}

TEST(TransformedCopy, KeepsTheImagesOfPoints) {
  const StoredMap before = StoredMapScene().stored();
  const StoredMap after = transformed_copy(before, kTargetFromMap);
  ASSERT_EQ(after.map.keyframe_count(), before.map.keyframe_count());
  for (const KeyframeId id : before.map.keyframe_ids()) {
    for (const PointId point_id : before.map.point_ids()) {
      const Eigen::Vector3d in_camera =
          before.map.find_keyframe(id)->camera_from_world * before.map.find_point(point_id)->position_in_world;
      EXPECT_THAT(after.map.find_keyframe(id)->camera_from_world * after.map.find_point(point_id)->position_in_world,
                  PointNear(1.5 * in_camera, 1e-12));
    }
  }
}

TEST(TransformedCopy, MovesPointsWithTheirCovarianceAndDirection) {
  const StoredMap before = StoredMapScene().stored();
  const StoredMap after = transformed_copy(before, kTargetFromMap);
  const Eigen::Matrix3d rotation = kTargetFromMap.target_from_source.rotation.toRotationMatrix();
  for (std::uint32_t i = 0; i < 8; ++i) {
    const MapPoint &from = point(before, i), &to = point(after, i);
    EXPECT_THAT(to.position_in_world, PointNear(kTargetFromMap * from.position_in_world, 1e-12));
    EXPECT_TRUE(to.covariance.isApprox(2.25 * rotation * from.covariance * rotation.transpose(), 1e-12));
    EXPECT_EQ(to.covariance, Eigen::Matrix3d(to.covariance.transpose()));
    const Eigen::Vector3f direction = rotation.cast<float>() * from.mean_viewing_direction;
    EXPECT_TRUE(to.mean_viewing_direction.isApprox(direction, 1e-5f));
    EXPECT_FLOAT_EQ(to.max_distance, 1.5f * from.max_distance);
  }
}

TEST(TransformedCopy, IsAValidMap) {
  EXPECT_THAT(find_faults(transformed_copy(StoredMapScene().stored_with_plan(), kTargetFromMap)), testing::IsEmpty());
}

TEST(TransformedCopy, KeepsPositionsOnThePlanWithTheirCovariance) {
  StoredMap before = StoredMapScene().stored_with_plan();
  Matrix7 root = Matrix7::Random();
  before.plan->covariance = 1e-4 * root * root.transpose();
  const StoredMap after = transformed_copy(before, kTargetFromMap);
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Eigen::Vector3d from = point(before, i).position_in_world, to = point(after, i).position_in_world;
    EXPECT_THAT(after.plan->plan_from_map * to, PointNear(before.plan->plan_from_map * from, 1e-9));
    EXPECT_TRUE(plan_covariance_at(*after.plan, to).isApprox(plan_covariance_at(*before.plan, from), 1e-9));
  }
}

TEST(TransformedCopy, MovesTags) {
  StoredMap before = StoredMapScene().stored();
  const MappedTag tag{{TagFamily::tag36h11, 3}, 0.2, {rotation_exp({0.1, 0.2, 0.3}), {1.0, -2.0, 3.0}}, 0.01};
  write_tags(std::span(&tag, 1), before.notes);
  const auto after = stored_tags(transformed_copy(before, kTargetFromMap).notes);
  ASSERT_EQ(after.size(), 1U);
  EXPECT_DOUBLE_EQ(after[0].size, kTargetFromMap.scale * tag.size);
  EXPECT_THAT(after[0].map_from_tag * tag_corners(after[0].size)[0],
              PointNear(kTargetFromMap * (tag.map_from_tag * tag_corners(tag.size)[0]), 1e-9));
}

TEST(TransformedCopy, IsUndoneByTheInverse) {
  const StoredMap before = StoredMapScene().stored_with_plan();
  const Similarity back{1.0 / 1.5, scale_lengths(inverse(kTargetFromMap.target_from_source), 1.0 / 1.5)};
  const StoredMap after = transformed_copy(transformed_copy(before, kTargetFromMap), back);
  for (const KeyframeId id : before.map.keyframe_ids()) {
    EXPECT_THAT(after.map.find_keyframe(id)->camera_from_world,
                PoseNear(before.map.find_keyframe(id)->camera_from_world, 1e-9, 1e-9));
  }
  EXPECT_TRUE(after.plan->covariance.isApprox(before.plan->covariance, 1e-9));
  EXPECT_NEAR(after.plan->plan_from_map.scale, before.plan->plan_from_map.scale, 1e-12);
}

}  // namespace
}  // namespace byre
