#include "byre/calibration_file.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kOpenCv = R"(%YAML:1.0
---
calibration_time: "Sat 01 Jan 2022"
image_width: 640
image_height: 480
flags: 0
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3e+02, 0., 3.2e+02, 0., 5.31e+02, 2.4e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.8e-01, 7.0e-02, 1.0e-04, 2.0e-04, 3.0e-02 ]
)";

const std::string kRos = R"(image_width: 640
image_height: 480
camera_name: front
camera_matrix:
  rows: 3
  cols: 3
  data: [530, 0, 320, 0, 531, 240, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.07, 0.0001, 0.0002, 0.0]
)";

const std::string kKalibr = R"(cam0:
  T_cam_imu:
  - [0.0, -1.0, 0.0, 0.1]
  - [1.0, 0.0, 0.0, 0.2]
  - [0.0, 0.0, 1.0, 0.3]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 2.0e-05]
  distortion_model: radtan
  intrinsics: [461.629, 460.152, 362.680, 246.049]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: -8.121e-05
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.002]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]
  distortion_model: equidistant
  intrinsics: [190.9, 190.8, 254.9, 256.8]
  resolution: [512, 512]
)";

const std::string kSensor =
    "resolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458, 457, 367, 248]\ndistortion_model: none\n";

class CalibrationFile : public TestFolder {
 protected:
  // The calibration of the file with one piece of its text replaced.
  Calibration read(std::string text, const std::string& old_text = "", const std::string& new_text = "") const {
    if (const std::size_t at = text.find(old_text); at != std::string::npos) {
      text.replace(at, old_text.size(), new_text);
    }
    write("camera.yaml", text);
    return read_calibration(folder_ / "camera.yaml");
  }
  std::string error(const std::string& text, const std::string& old_text, const std::string& new_text) const {
    return error_of([&] { read(text, old_text, new_text); });
  }
};

TEST_F(CalibrationFile, ReadsOpencvCameras) {
  const Calibration calibration = read(kOpenCv);
  const Camera& camera = calibration.left;
  EXPECT_EQ(camera.model, CameraModel::radial_tangential);
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.fx, 530.0);
  EXPECT_EQ(camera.fy, 531.0);
  EXPECT_EQ(camera.cx, 320.0);
  EXPECT_EQ(camera.cy, 240.0);
  EXPECT_THAT(camera.distortion, ElementsAre(-0.28, 0.07, 1e-4, 2e-4, 0.03, 0, 0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_FALSE(calibration.right);
  EXPECT_THAT(calibration.body_from_left, PoseNear(Pose{}, 0.0, 0.0));
}

TEST_F(CalibrationFile, ReadsOpencvFisheyes) {
  const std::string four = "[ -2.8e-01, 7.0e-02, 1.0e-04, 2.0e-04 ]";
  std::string fisheye = kOpenCv;
  fisheye.replace(fisheye.find("[ -2.8e-01"), four.size() + std::string(", 3.0e-02").size(), four);
  const Camera camera = read(fisheye, "fisheye_model: 0", "fisheye_model: 1").left;
  EXPECT_EQ(camera.model, CameraModel::equidistant);
  EXPECT_THAT(camera.distortion, ElementsAre(-0.28, 0.07, 1e-4, 2e-4, 0.0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(error(kOpenCv, "fisheye_model: 0", "fisheye_model: 1"),
              HasSubstr("distortion_coefficients: has 5 numbers instead of 4"));
}

TEST_F(CalibrationFile, ReadsRosCameras) {
  const Camera camera = read(kRos).left;
  EXPECT_EQ(camera.model, CameraModel::radial_tangential);
  EXPECT_EQ(camera.fy, 531.0);
  EXPECT_EQ(camera.distortion[1], 0.07);
  EXPECT_EQ(read(kRos, "[-0.28, 0.07, 0.0001, 0.0002, 0.0]", "[0, 0, 0, 0, 0]").left.model, CameraModel::pinhole);
}

TEST_F(CalibrationFile, ReadsTheRationalModelOfOpencv) {
  EXPECT_EQ(read(kRos, "0.0002, 0.0]", "0.0002, 0.03, 0, 0, 0]").left.model, CameraModel::radial_tangential);
  EXPECT_EQ(read(kRos, "0.0002, 0.0]", "0.0002, 0.03, 0, 0, 0]").left.distortion[4], 0.03);
  const Camera rational = read(kRos, "0.0002, 0.0]", "0.0002, 0.03, 0.1, 0, 0]").left;
  EXPECT_EQ(rational.model, CameraModel::rational);
  EXPECT_EQ(rational.distortion[5], 0.1);
}

TEST_F(CalibrationFile, ReadsPairAndBodyPoseOfKalibr) {
  const Calibration calibration = read(kKalibr);
  EXPECT_EQ(calibration.left.model, CameraModel::radial_tangential);
  EXPECT_EQ(calibration.left.cx, 362.680);
  ASSERT_TRUE(calibration.right);
  EXPECT_EQ(calibration.right->camera.model, CameraModel::equidistant);
  EXPECT_EQ(calibration.right->camera.width, 512);
  EXPECT_THAT(calibration.right->right_from_left.translation, PointNear(Eigen::Vector3d(-0.11, 0.0, 0.002), 1e-12));
  const Eigen::Vector3d point_in_left = inverse(calibration.body_from_left) * Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_THAT(point_in_left, PointNear(Eigen::Vector3d(0.1, 1.2, 0.3), 1e-12));
}

TEST_F(CalibrationFile, ReadsOneKalibrCameraWithoutABody) {
  const Calibration calibration = read(kKalibr.substr(0, kKalibr.find("cam1:")), "T_cam_imu", "T_cam_x");
  EXPECT_FALSE(calibration.right);
  EXPECT_THAT(calibration.body_from_left, PoseNear(Pose{}, 0.0, 0.0));
}

TEST_F(CalibrationFile, ReadsEurocWithoutABody) {
  EXPECT_EQ(read(kSensor).left.fx, 458.0);
  const std::string body = "T_BS: {data: [1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n";
  EXPECT_EQ(read(kSensor + body).body_from_left.translation.x(), 0.5);
}

TEST_F(CalibrationFile, ReadsTheReadoutTime) {
  EXPECT_EQ(read(kSensor).readout_time, 0.0);
  EXPECT_EQ(read(kSensor + "readout_time: 0.015\n").readout_time, 0.015);
  EXPECT_NEAR(read(kKalibr, "cam_overlaps: [1]", "line_delay: 2.5e-5").readout_time, 480 * 2.5e-5, 1e-12);
  EXPECT_EQ(read(kRos + "readout_time: -0.02\n").readout_time, -0.02);
  EXPECT_THAT(error(kSensor + "readout_time: 15\n", "", ""),
              HasSubstr("camera.yaml: readout_time: is not a valid readout time"));
  EXPECT_THAT(error(kSensor + "readout_time: nan\n", "", ""), HasSubstr("readout_time"));
}

TEST_F(CalibrationFile, ReportsUnsupportedAndSupportedModels) {
  EXPECT_THAT(error(kKalibr, "camera_model: pinhole", "camera_model: ocam"),
              AllOf(HasSubstr("cam0.camera_model: \"ocam\" is not supported"),
                    HasSubstr("radial-tangential (radtan), rational, equidistant (fisheye), fov or no"),
                    HasSubstr("pinhole-equi")));
  EXPECT_THAT(error(kKalibr, "radtan", "poly"), HasSubstr("cam0.distortion_model: \"poly\" is not supported"));
  EXPECT_THAT(error(kRos, "plumb_bob", "thin_prism"), HasSubstr("distortion_model: \"thin_prism\" is not supported"));
}

TEST_F(CalibrationFile, ReportsTheInvalidField) {
  struct Case {
    std::string text, old_text, new_text, message;
  };
  const std::vector<Case> cases = {
      {kRos, "image_width: 640", "image_width: wide", "camera.yaml: image_width: is not a number"},
      {kRos, "image_width: 640", "image_width: 0", "image_width: is not a width and height"},
      {kRos, "image_height: 480", "", "image_height: is missing"},
      {kRos, "[530, 0,", "[530, 1,", "camera_matrix: is not of the form fx 0 cx"},
      {kRos, "[530, 0,", "[530,", "camera_matrix: has 8 numbers instead of 9"},
      {kRos, "[530,", "[-530,", "camera_matrix: the focal lengths must be positive"},
      {kRos, "0, 320, 0", "0, 700, 0", "camera_matrix: the principal point is outside"},
      {kRos, "data: [530", "values: [530", "camera_matrix: has no data"},
      {kRos, "distortion_coefficients", "lens_coefficients", "distortion_coefficients: is missing"},
      {kRos, "[-0.28, 0.07, ", "[", "distortion_coefficients: has 3 numbers instead of 4"},
      {kKalibr, "[461.629, ", "[", "cam0.intrinsics: has 3 numbers instead of 4"},
      {kKalibr, "distortion_coeffs: [-0.28, ", "distortion_coeffs: [", "cam0.distortion_coeffs: has 3 numbers"},
      {kKalibr, "T_cn_cnm1", "T_x", "cam1.T_cn_cnm1: is missing"},
      {kKalibr, "- [0.0, -1.0, 0.0, 0.1]", "- [0.0, -1.1, 0.0, 0.1]", "cam0.T_cam_imu: the 3x3 part is not"},
      {kKalibr, "cam0:", "cam0: 5\ncam5:", "cam0: has no named fields"},
      {kSensor, "intrinsics", "focal",
       "camera.yaml: is not a supported calibration file (supported files have the field intrinsics"},
      {"a: [1", "", "", "camera.yaml:1: "},
      {"", "", "", "is not a YAML mapping of named fields"},
  };
  for (const Case& bad : cases) {
    EXPECT_THAT(error(bad.text, bad.old_text, bad.new_text), HasSubstr(bad.message)) << bad.new_text;
  }
  std::string together = kKalibr;
  together.replace(together.find("-0.11]"), 6, "0.0]");
  EXPECT_THAT(error(together, "0.002]", "0.0]"), HasSubstr("cam1.T_cn_cnm1: places both cameras at the same position"));
  EXPECT_THAT(error_of([&] { read_calibration(folder_ / "absent.yaml"); }), HasSubstr("absent.yaml: cannot be opened"));
}

TEST_F(CalibrationFile, IsFoundInAFolderByName) {
  EXPECT_FALSE(find_calibration(folder_));
  write("sensor.yaml", kSensor);
  EXPECT_EQ(find_calibration(folder_), folder_ / "sensor.yaml");
  write("calibration.yaml", kSensor);
  EXPECT_EQ(find_calibration(folder_), folder_ / "calibration.yaml");
}

TEST_F(CalibrationFile, ReadsBackWhatItWrites) {
  Calibration calibration;
  calibration.left = {CameraModel::radial_tangential, 752, 480, 458.654321, 457.3, 367.2, 248.4,
                      {-0.28, 0.07, 1e-4, 2e-5, 0.01}};
  calibration.right =
      StereoPartner{{CameraModel::equidistant, 752, 480, 457.6, 456.1, 380.0, 255.2, {0.1, 0.02, -0.003, 4e-4, 0.0}},
                    {rotation_exp({0.01, -0.02, 0.003}), {-0.11, 0.0004, -0.0008}}};
  calibration.body_from_left = {rotation_exp({0.1, 1.2, -0.5}), {-0.02, -0.06, 0.01}};
  calibration.readout_time = 0.0213;
  write("camera.yaml", write_calibration(calibration));
  const Calibration read = read_calibration(folder_ / "camera.yaml");
  EXPECT_EQ(read.left, calibration.left);
  EXPECT_EQ(read.readout_time, calibration.readout_time);
  ASSERT_TRUE(read.right);
  EXPECT_EQ(read.right->camera, calibration.right->camera);
  EXPECT_THAT(read.right->right_from_left, PoseNear(calibration.right->right_from_left, 1e-12, 1e-12));
  EXPECT_THAT(read.body_from_left, PoseNear(calibration.body_from_left, 1e-12, 1e-12));
}

}  // namespace
}  // namespace byre
