#include "byre/geometry/tag_pose.h"

#include "byre/geometry/geometry_matchers.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kSize = 0.2;  // metres

Rig rig() {
  Rig rig;
  rig.width = 752;
  rig.height = 480;
  rig.focal = 458.0;
  rig.cx = 370.0;
  rig.cy = 245.0;
  return rig;
}

TagView view_of(const Pose& camera_from_world, const Pose& world_from_tag, double sigma = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  TagView view{camera_from_world, rig(), {}};
  const auto in_tag = tag_corners(kSize);
  for (std::size_t i = 0; i < in_tag.size(); ++i) {
    const double x = sigma * noise(random), y = sigma * noise(random);
    view.corners[i] =
        view.rig.project(camera_from_world * world_from_tag * in_tag[i]).head<2>() + Eigen::Vector2d(x, y);
  }
  return view;
}

Pose oblique() {
  return {rotation_exp({0.1, 0.6, -0.2}), {0.4, -0.2, 1.5}};
}

// The camera moves sideways past the tag.
std::vector<TagView> passing_views(const Pose& world_from_tag, double sigma) {
  std::vector<TagView> views;
  for (unsigned i = 0; i < 10; ++i) {
    const Pose camera_from_world{rotation_exp({0.0, 0.02 * i, 0.0}), {0.1 * i - 0.5, 0.0, 0.5}};
    views.push_back(view_of(camera_from_world, world_from_tag, sigma, i));
  }
  return views;
}

TEST(EstimateTagPose, IsExactOnCleanCorners) {
  const TagView view = view_of({}, oblique());
  const auto estimates = estimate_tag_pose(std::span(&view, 1), kSize);
  ASSERT_THAT(estimates, SizeIs(testing::Ge(1)));
  EXPECT_THAT(estimates[0].world_from_tag, PoseNear(oblique(), 1e-6, 1e-6));
  EXPECT_LT(estimates[0].error, 1e-6);
}

TEST(EstimateTagPose, ReturnsBothPosesOfADistantTag) {
  const Pose far{rotation_exp({0.0, 0.3, 0.0}), {0.0, 0.0, 6.0}};
  const TagView view = view_of({}, far, 0.2);
  const auto estimates = estimate_tag_pose(std::span(&view, 1), kSize);
  ASSERT_THAT(estimates, SizeIs(2));
  const auto turn = [&](const TagEstimate& each) { return angle_between(each.world_from_tag.rotation, far.rotation); };
  EXPECT_LT(std::min(turn(estimates[0]), turn(estimates[1])), 0.2);
}

TEST(EstimateTagPose, ResolvesTheAmbiguityBySeveralViews) {
  const Pose world_from_tag{rotation_exp({0.0, 0.3, 0.0}), {0.2, -0.3, 3.0}};
  const auto estimates = estimate_tag_pose(passing_views(world_from_tag, 0.3), kSize);
  ASSERT_THAT(estimates, SizeIs(1));
  EXPECT_THAT(estimates[0].world_from_tag, PoseNear(world_from_tag, 0.02, 0.06));
  const Vector6 error = log_pose(inverse(estimates[0].world_from_tag) * world_from_tag);
  EXPECT_LT(error.dot(estimates[0].covariance.ldlt().solve(error)), 22.5);  // 99.9 %, six degrees of freedom
}

TEST(EstimateTagPose, LeavesOutAViewOfAnotherPose) {
  const Pose world_from_tag{rotation_exp({0.0, 0.3, 0.0}), {0.2, -0.3, 3.0}};
  std::vector<TagView> views = passing_views(world_from_tag, 0.1);
  views[4] =
      view_of(views[4].camera_from_world, world_from_tag * Pose{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}});
  const auto estimates = estimate_tag_pose(views, kSize);
  ASSERT_THAT(estimates, SizeIs(1));
  EXPECT_EQ(estimates[0].views, 9);
  EXPECT_THAT(estimates[0].world_from_tag, PoseNear(world_from_tag, 0.02, 0.05));
}

TEST(EstimateUnit, IsWithinItsSigmasOfTheUnit) {
  const Pose world_from_tag{rotation_exp({0.0, 0.3, 0.0}), {0.2, -0.3, 3.0}};
  for (const double unit : {0.4, 1.0, 7.0}) {
    std::vector<TagView> views = passing_views(world_from_tag, 0.3);
    for (TagView& view : views) view.camera_from_world.translation *= unit;
    const auto estimate = estimate_unit(views, kSize);
    ASSERT_TRUE(estimate) << unit;
    EXPECT_LT(estimate->sigma, 0.05);
    EXPECT_LT(std::abs(std::log(estimate->lengths_per_metre / unit)), 3.0 * estimate->sigma) << unit;
  }
}

TEST(EstimateUnit, IsEmptyIfViewsDisagreeOrDoNotDetermineIt) {
  const Pose world_from_tag{rotation_exp({0.0, 0.3, 0.0}), {0.2, -0.3, 3.0}};
  std::vector<TagView> views = passing_views(world_from_tag, 0.1);
  EXPECT_FALSE(estimate_unit(std::span(views).first(1), kSize));
  EXPECT_FALSE(estimate_unit(std::vector(5, views[0]), kSize)) << "without motion";
  views[4] =
      view_of(views[4].camera_from_world, world_from_tag * Pose{Eigen::Quaterniond::Identity(), {2.0, 0.0, 0.0}});
  EXPECT_FALSE(estimate_unit(views, kSize)) << "of another place";
}

TEST(EstimateTagPose, IsEmptyForCornersOnALine) {
  TagView view = view_of({}, oblique());
  for (std::size_t i = 0; i < view.corners.size(); ++i) view.corners[i] = {100.0 + 10.0 * static_cast<double>(i), 50.0};
  EXPECT_THAT(estimate_tag_pose(std::span(&view, 1), kSize), IsEmpty());
  EXPECT_THAT(estimate_tag_pose({}, kSize), IsEmpty());
}

}  // namespace
}  // namespace byre
