#include "byre/node/camera_info.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

const CameraInfoTopics kTopics{"/left/camera_info", "/right/camera_info"};

ros::CameraInfo info_of(double p3) {
  ros::CameraInfo info;
  info.width = 752;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {-0.28, 0.07, 0.0002, 0.00002, 0.0};
  info.k = {458, 0, 367, 0, 457, 248, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {435, 0, 360, p3, 0, 435, 250, 0, 0, 0, 1, 0};
  return info;
}

TEST(CameraInfo, GivesLensesAndBaseline) {
  const Calibration calibration = calibration_of(info_of(0), info_of(-43.5), false, kTopics);
  EXPECT_EQ(calibration.left.model, CameraModel::radial_tangential);
  EXPECT_EQ(calibration.left.fx, 458);
  EXPECT_EQ(calibration.left.cy, 248);
  EXPECT_EQ(calibration.left.distortion[1], 0.07);
  ASSERT_TRUE(calibration.right.has_value());
  EXPECT_NEAR(calibration.right->right_from_left.translation.x(), -0.1, 1e-12);
}

TEST(CameraInfo, TurnsCamerasBackFromTheirRectifiedFrames) {
  const Eigen::Matrix3d left_turn = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Matrix3d right_turn = Eigen::AngleAxisd(-0.2, Eigen::Vector3d(3, 1, 0).normalized()).toRotationMatrix();
  ros::CameraInfo left = info_of(0), right = info_of(-43.5);
  for (std::size_t i = 0; i < 9; ++i) {
    left.r[i] = left_turn(static_cast<int>(i) / 3, static_cast<int>(i) % 3);
    right.r[i] = right_turn(static_cast<int>(i) / 3, static_cast<int>(i) % 3);
  }
  const Pose right_from_left = calibration_of(left, right, false, kTopics).right->right_from_left;
  const Eigen::Vector3d point(0.3, -0.2, 4.0);  // in the left camera
  const Eigen::Vector3d rectified = left_turn * point - Eigen::Vector3d(0.1, 0, 0);
  EXPECT_LT((right_turn * (right_from_left * point) - rectified).norm(), 1e-9);
}

TEST(CameraInfo, HoldsForRectifiedImagesByItsP) {
  const Calibration calibration = calibration_of(info_of(0), info_of(-43.5), true, kTopics);
  EXPECT_EQ(calibration.left.model, CameraModel::pinhole);
  EXPECT_EQ(calibration.left.fx, 435);
  EXPECT_EQ(calibration.left.cx, 360);
  EXPECT_EQ(calibration.right->right_from_left.rotation.w(), 1.0);
}

TEST(CameraInfo, KnowsTheOtherModels) {
  ros::CameraInfo info = info_of(0);
  info.distortion_model = "equidistant";
  info.d = {0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(calibration_of(info, {}, false, kTopics).left.model, CameraModel::equidistant);
  info.distortion_model = "rational_polynomial";
  info.d = {0.1, 0.2, 0.3, 0.4, 0.5, 0.0, 0.0, 0.0};
  EXPECT_EQ(calibration_of(info, {}, false, kTopics).left.distortion[4], 0.5);
  info.d = {};
  EXPECT_EQ(calibration_of(info, {}, false, kTopics).left.model, CameraModel::pinhole);
}

TEST(CameraInfo, IsRefusedWhereItCannotBeUsed) {
  const auto is_refused = [](const std::function<void(ros::CameraInfo&)>& change) {
    ros::CameraInfo info = info_of(-43.5);
    change(info);
    EXPECT_THROW(calibration_of(info_of(0), info, false, kTopics), InputError);
  };
  is_refused([](auto& info) { info.k[0] = 0; });
  is_refused([](auto& info) { info.k[4] = std::numeric_limits<double>::quiet_NaN(); });
  is_refused([](auto& info) { info.p[3] = 0; });
  is_refused([](auto& info) { info.p[3] = 43.5; });
  is_refused([](auto& info) { info.r = {}; });
  is_refused([](auto& info) { info.distortion_model = "kannala"; });
  is_refused([](auto& info) { info.d = {1, 2, 3}; });
  is_refused([](auto& info) { info.distortion_model = "rational_polynomial", info.d = {1, 2, 3, 4, 5, 6, 7, 8}; });
  is_refused([](auto& info) { info.binning_x = 2; });
  is_refused([](auto& info) { info.roi.x_offset = 8; });
  is_refused([](auto& info) { info.width = 0; });
}

}  // namespace
}  // namespace byre
