#include "byre/optimise/bundle_motion.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/bundle_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

Pose moved(const Pose& pose, const Vector6& turn_and_translation) {
  return {rotation_exp(turn_and_translation.head<3>()) * pose.rotation,
          pose.translation + turn_and_translation.tail<3>()};
}

TEST(MotionError, HasTheNumericJacobian) {
  constexpr double kStep = 1e-6;
  Draw draw(3);
  const Pose earlier = exp_pose(draw.motion(1.0, 1.0)), later = exp_pose(draw.motion(1.0, 1.0));
  BundleMotion measured;
  measured.later_from_earlier = later * inverse(earlier);
  const MotionJacobians jacobians = motion_jacobians(earlier, later);
  const Matrix6 by_earlier = to_rotation_translation(jacobians.by_earlier, earlier);
  const Matrix6 by_later = to_rotation_translation(jacobians.by_later, later);
  for (int i = 0; i < 6; ++i) {
    const Vector6 step = kStep * Vector6::Unit(i);
    const auto slope_of = [&](const Vector6& ahead, const Vector6& behind) { return (ahead - behind) / (2.0 * kStep); };
    const auto residual = [&](const Pose& from, const Pose& to) { return motion_error(measured, from, to).residual; };
    const Vector6 first = slope_of(residual(moved(earlier, step), later), residual(moved(earlier, -step), later));
    const Vector6 second = slope_of(residual(earlier, moved(later, step)), residual(earlier, moved(later, -step)));
    EXPECT_LT((by_earlier.col(i) - first).norm(), 1e-5) << i;
    EXPECT_LT((by_later.col(i) - second).norm(), 1e-5) << i;
  }
}

// A monocular scene with its first pose held: only the measured motions determine the scale.
BundleScene scene_of_one_camera(int moving_poses, int points) {
  BundleScene scene = make_scene(2, {.fixed_poses = 1,
                                     .moving_poses = moving_poses,
                                     .points = points,
                                     .mono_fraction = 1.0,
                                     .start_position = 0.01,
                                     .start_rotation = 0.005});
  for (int i = 1; i < static_cast<int>(scene.truth.poses.size()); ++i) {
    BundleMotion measured{.earlier = i - 1, .later = i, .later_from_earlier = {}};
    measured.later_from_earlier =
        scene.truth.poses[i].camera_from_world * inverse(scene.truth.poses[i - 1].camera_from_world);
    measured.information = 1e4 * Matrix6::Identity();
    scene.problem.motions.push_back(measured);
  }
  return scene;
}

double worst_error(const BundleScene& scene) {
  BundleOptions options;
  options.max_iterations = 100;
  const BundleResult result = bundle_adjust(scene.problem, options);
  EXPECT_TRUE(result.usable);
  double worst = 0.0;
  for (std::size_t i = 0; i < scene.truth.poses.size(); ++i) {
    const Pose error = inverse(scene.truth.poses[i].camera_from_world) * result.camera_from_world[i];
    worst = std::max(worst, log_pose(error).norm());
  }
  return worst;
}

TEST(MeasuredMotions, ConstrainTheScaleOfOneCamera) {
  EXPECT_LT(worst_error(scene_of_one_camera(4, 80)), 1e-5);
  EXPECT_LT(worst_error(scene_of_one_camera(70, 400)), 1e-3) << "with the sparse solver";
}

TEST(MeasuredMotions, AreRejectedAsOutliers) {
  BundleScene scene = scene_of_one_camera(8, 120);
  scene.problem.motions[3].later_from_earlier.translation *= 4.0;
  EXPECT_LT(worst_error(scene), 0.01);
}

TEST(MeasuredMotions, FromUnobservedPosesHaveNoEffect) {
  BundleScene scene = scene_of_one_camera(4, 80);
  Vector6 away = Vector6::Zero();
  away.x() = 0.3;
  scene.problem.poses.push_back({exp_pose(away) * scene.problem.poses[2].camera_from_world});
  scene.truth.poses.push_back(scene.problem.poses.back());
  BundleMotion measured{.earlier = 2, .later = 5, .later_from_earlier = {}};
  measured.information = 1e4 * Matrix6::Identity();
  scene.problem.motions.push_back(measured);
  EXPECT_LT(worst_error(scene), 1e-5);
}

TEST(MeasuredMotions, ReduceTheCovarianceOfAPose) {
  BundleScene scene = scene_of_one_camera(4, 80);
  BundleOptions options;
  options.covariance_of_pose = 4;
  const auto sigma = [&] { return std::sqrt(bundle_adjust(scene.problem, options).pose_covariance->trace()); };
  const double well_told = sigma();
  for (BundleMotion& measured : scene.problem.motions) measured.information *= 1e-2;
  EXPECT_GT(sigma(), 2.0 * well_told);
}

}  // namespace
}  // namespace byre
