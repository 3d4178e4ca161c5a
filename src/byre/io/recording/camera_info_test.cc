#include "byre/io/recording/camera_info.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/io/recording/folder_scene.h"
#include "byre/io/ros/message_matchers.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;

const Pose kRightFromLeft{rotation_exp({0.01, -0.02, 0.005}), {-0.11, 0.002, 0.001}};

CameraInfoWithSource placed_info(const std::string& frame) {
  CameraInfoWithSource placed{{.height = 480, .width = 752}, "walk.bag: /" + frame + "/camera_info"};
  placed.info.header.frame_id = frame;
  placed.info.k = {458.0, 0.0, 367.0, 0.0, 457.0, 248.0, 0.0, 0.0, 1.0};
  placed.info.distortion_model = "plumb_bob";
  placed.info.d = {-0.28, 0.07, 0.0002, 0.00002, 0.001};
  placed.info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  return placed;
}

ros::TransformStamped transform(const std::string& parent, const std::string& child, const Pose& parent_from_child) {
  const Eigen::Vector3d& t = parent_from_child.translation;
  const Eigen::Quaterniond& q = parent_from_child.rotation;
  return {{.frame_id = parent}, child, {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}}};
}

TEST(CameraInfo, SelectsTheModelByName) {
  const Camera camera = camera_of(placed_info("left"));
  EXPECT_EQ(camera.model, CameraModel::radial_tangential);
  EXPECT_EQ(camera, (Camera{CameraModel::radial_tangential,
                            752,
                            480,
                            458.0,
                            457.0,
                            367.0,
                            248.0,
                            {-0.28, 0.07, 0.0002, 0.00002, 0.001}}));
  CameraInfoWithSource fisheye = placed_info("left");
  fisheye.info.distortion_model = "equidistant";
  fisheye.info.d = {0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(camera_of(fisheye).model, CameraModel::equidistant);
  EXPECT_EQ(camera_of(fisheye).distortion[3], 0.4);
  CameraInfoWithSource rational = placed_info("left");
  rational.info.distortion_model = "rational_polynomial";
  rational.info.d.resize(8, 0.0);
  EXPECT_EQ(camera_of(rational), camera);
}

TEST(CameraInfo, UsesTheProjectionOfRectifiedImages) {
  CameraInfoWithSource placed = placed_info("left");
  placed.is_rectified = true;
  placed.info.p = {430.0, 0.0, 360.0, 0.0, 0.0, 431.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  EXPECT_EQ(camera_of(placed), (Camera{CameraModel::pinhole, 752, 480, 430.0, 431.0, 360.0, 240.0, {}}));
}

TEST(CameraInfo, PlacesADepthCameraByNameFrameAndSize) {
  CameraInfoWithSource own = placed_info("depth");
  const Camera left = camera_of(placed_info("left"));
  StaticFrames frames;
  EXPECT_FALSE(depth_camera_of(own, false, left, "left", frames)) << "no transform";
  EXPECT_EQ(depth_camera_of(own, true, left, "left", frames), DepthCamera{}) << "registered by name";
  EXPECT_EQ(depth_camera_of(placed_info("left"), false, left, "/left", frames), DepthCamera{}) << "by frame";
  const Pose left_from_depth{rotation_exp({0.01, 0.0, 0.02}), {-0.015, 0.001, 0.0}};
  frames.take({{transform("left", "depth", left_from_depth)}});
  const auto placed = depth_camera_of(own, false, left, "left", frames);
  ASSERT_TRUE(placed && placed->camera);
  EXPECT_EQ(*placed->camera, camera_of(own));
  EXPECT_THAT(placed->left_from_depth, PoseNear(left_from_depth, 1e-12, 1e-12));
  CameraInfoWithSource half = placed_info("left");
  half.info.width /= 2;
  half.info.height /= 2;
  const auto smaller = depth_camera_of(half, true, left, "left", frames);
  ASSERT_TRUE(smaller && smaller->camera) << "its own lens, in the place of the left camera";
  EXPECT_EQ(smaller->camera->width, 376);
  EXPECT_THAT(smaller->left_from_depth, PoseNear(Pose{}, 1e-12, 1e-12));
}

TEST(CameraInfo, RejectsUnsupportedLensModels) {
  CameraInfoWithSource rational = placed_info("left");
  rational.info.distortion_model = "rational_polynomial";
  rational.info.d = {0.1, 0.1, 0.0, 0.0, 0.1, 0.2, 0.2, 0.1};
  EXPECT_EQ(camera_of(rational).model, CameraModel::rational);
  EXPECT_EQ(camera_of(rational).distortion[7], 0.1);
  rational.info.d.resize(15, 0.1);
  EXPECT_THAT(error_of([&] { camera_of(rational); }),
              HasSubstr("walk.bag: /left/camera_info: has the unsupported lens model \"rational_polynomial\" with 15"));
  CameraInfoWithSource none = placed_info("left");
  none.info.k = {};
  EXPECT_THAT(error_of([&] { camera_of(none); }),
              HasSubstr("uncalibrated camera: its focal lengths are not positive (give a calibration"));
  CameraInfoWithSource binned = placed_info("left");
  binned.info.binning_x = 2;
  EXPECT_THAT(error_of([&] { camera_of(binned); }), HasSubstr("binned"));
  CameraInfoWithSource cut = placed_info("left");
  cut.info.roi = {10, 10, 100, 100, false};
  EXPECT_THAT(error_of([&] { camera_of(cut); }), HasSubstr("region of interest"));
}

TEST(CameraInfo, ReadsTheBaselineOfRectifiedProjections) {
  CameraInfoWithSource left = placed_info("left"), right = placed_info("left");
  left.is_rectified = right.is_rectified = true;
  left.info.p = right.info.p = {430.0, 0.0, 360.0, 0.0, 0.0, 430.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  right.info.p[3] = -43.0;
  const Pose right_from_left = partner_of(left, right, {}).right_from_left;
  EXPECT_THAT(right_from_left.translation.x(), DoubleNear(-0.1, 1e-12));
  EXPECT_THAT(right_from_left, PoseNear(Pose{Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.0}}, 1e-12, 1e-12));
}

TEST(CameraInfo, ReadsABaselineOfEitherSignAndInEitherCamera) {
  CameraInfoWithSource left = placed_info("left"), right = placed_info("right");
  left.info.p = right.info.p = {430.0, 0.0, 360.0, 0.0, 0.0, 430.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  right.info.p[3] = 43.0;
  EXPECT_TRUE(has_positive_baseline(left, right));
  EXPECT_THAT(partner_of(left, right, {}).right_from_left.translation.x(), DoubleNear(-0.1, 1e-12));
  std::swap(left.info.p, right.info.p);  // the right camera is the reference
  EXPECT_FALSE(has_positive_baseline(left, right));
  EXPECT_THAT(partner_of(left, right, {}).right_from_left.translation.x(), DoubleNear(-0.1, 1e-12));
  right.info.p[7] = -21.5;  // a vertical part
  EXPECT_THAT(partner_of(left, right, {}).right_from_left.translation.y(), DoubleNear(-0.05, 1e-12));
}

TEST(CameraInfo, RotatesRawImagesIntoTheRectifiedFrames) {
  // Rectified frames of a stereo calibration: parallel, and offset along x.
  const Pose left_turn{rotation_exp({0.003, -0.01, 0.02}), Eigen::Vector3d::Zero()};
  const Pose right_turn{rotation_exp({-0.004, 0.02, 0.01}), Eigen::Vector3d::Zero()};
  const Pose expected = inverse(right_turn) * Pose{Eigen::Quaterniond::Identity(), {-0.11, 0.0, 0.0}} * left_turn;
  CameraInfoWithSource left = placed_info("left"), right = placed_info("right");
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(left.info.r.data()) = left_turn.rotation.toRotationMatrix();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(right.info.r.data()) =
      right_turn.rotation.toRotationMatrix();
  right.info.p = {430.0, 0.0, 360.0, -0.11 * 430.0, 0.0, 430.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  EXPECT_THAT(partner_of(left, right, {}).right_from_left, PoseNear(expected, 1e-9, 1e-9));
}

TEST(CameraInfo, UsesFramesForThePairWithoutABaselineInP) {
  StaticFrames frames;
  const Pose base_from_left{rotation_exp({-1.2, 1.2, -1.2}), {0.3, 0.05, 0.4}};
  frames.take({{transform("/base_link", "left", base_from_left), transform("left", "right", inverse(kRightFromLeft))}});
  EXPECT_THAT(partner_of(placed_info("left"), placed_info("right"), frames).right_from_left,
              PoseNear(kRightFromLeft, 1e-9, 1e-9));
  EXPECT_THAT(body_from_camera("left", frames), PoseNear(base_from_left, 1e-9, 1e-9));
  EXPECT_THAT(body_from_camera("right", frames), PoseNear(base_from_left * inverse(kRightFromLeft), 1e-9, 1e-9));
}

TEST(CameraInfo, RejectsAPairWithoutABaseline) {
  EXPECT_THAT(error_of([] { partner_of(placed_info("left"), placed_info("right"), {}); }),
              HasSubstr("does not connect the frame \"left\" to \"right\" (give a calibration"));
  EXPECT_THAT(error_of([] { partner_of(placed_info("left"), placed_info("left"), {}); }),
              HasSubstr("walk.bag: /left/camera_info"));
  EXPECT_THAT(body_from_camera("left", {}), PoseNear(Pose(), 1e-15, 1e-15));
}

TEST(CameraInfo, RejectsAnInvalidRotation) {
  CameraInfoWithSource left = placed_info("left"), right = placed_info("right");
  right.info.p = {430.0, 0.0, 360.0, -43.0, 0.0, 430.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  right.info.r[4] = 2.0;
  EXPECT_THAT(error_of([&] { partner_of(left, right, {}); }),
              HasSubstr("walk.bag: /right/camera_info: has a matrix R that is not a rotation"));
  std::swap(left.info.r, right.info.r);
  EXPECT_THAT(error_of([&] { partner_of(left, right, {}); }),
              HasSubstr("walk.bag: /left/camera_info: has a matrix R that is not a rotation"));
  left.is_rectified = right.is_rectified = true;  // rectified images do not need R
  EXPECT_NO_THROW(partner_of(left, right, {}));
}

TEST(CameraInfo, RejectsInvalidValues) {
  CameraInfoWithSource left = placed_info("left");
  left.info.p = {430.0, 0.0, 360.0, 0.0, 0.0, 430.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  const auto is_refused = [&left](const std::function<void(ros::CameraInfo&)>& change) {
    CameraInfoWithSource right = left;
    right.info.p[3] = -43.0;
    change(right.info);
    EXPECT_THROW(partner_of(left, right, {}), InputError);
  };
  is_refused([](auto& info) { info.k[0] = 0.0; });
  is_refused([](auto& info) { info.k[4] = std::numeric_limits<double>::quiet_NaN(); });
  is_refused([](auto& info) { info.p[3] = 0.0; });
  is_refused([](auto& info) { info.r = {}; });
  is_refused([](auto& info) { info.distortion_model = "kannala"; });
  is_refused([](auto& info) { info.d = {1.0, 2.0, 3.0}; });
  is_refused([](auto& info) { info.roi.x_offset = 8; });
  is_refused([](auto& info) { info.width = 0; });
}

}  // namespace
}  // namespace byre
