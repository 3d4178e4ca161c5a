// One pair of cameras in the files of other systems.

#include "byre/calibration_file.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

// The right camera is 0.11 m to the right of the left one. The left one is 0.05 m ahead of the body along its z axis.
const std::string kBodyFromLeft = "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.05, 0, 0, 0, 1]";
const std::string kBodyFromRight = "[1, 0, 0, 0.11, 0, 1, 0, 0, 0, 0, 1, 0.05, 0, 0, 0, 1]";
const std::string kMatrix = "[458, 0, 367, 0, 457, 248, 0, 0, 1]";
const std::string kUnit = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";
const std::string kLens = "[-0.28, 0.07, 0.0002, 0.00002, 0.001]";

std::string matrix(int rows, int columns, const std::string& data) {
  return "!!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(columns) +
         "\n   dt: d\n   data: " + data + "\n";
}

Camera expected_camera(double k3) {
  return {CameraModel::radial_tangential, 752, 480, 458.0, 457.0, 367.0, 248.0, {-0.28, 0.07, 2e-4, 2e-5, k3}};
}

class CalibrationFormats : public TestFolder {
 protected:
  CalibrationReading read(const std::string& name, const std::string& text) const {
    write(name, text);
    return read_calibration_file(folder_ / name);
  }
  static void expect_pair(const CalibrationReading& reading, const std::string& format, double k3, bool has_body) {
    const Calibration& calibration = reading.calibration;
    EXPECT_EQ(reading.format, format);
    EXPECT_EQ(calibration.left, expected_camera(k3));
    ASSERT_TRUE(calibration.right);
    EXPECT_EQ(calibration.right->camera, expected_camera(k3));
    EXPECT_THAT(calibration.right->right_from_left,
                PoseNear(Pose{Eigen::Quaterniond::Identity(), {-0.11, 0.0, 0.0}}, 1e-9, 1e-9));
    const Pose body{Eigen::Quaterniond::Identity(), {0.0, 0.0, has_body ? 0.05 : 0.0}};
    EXPECT_THAT(calibration.body_from_left, PoseNear(body, 1e-9, 1e-9));
  }
};

std::string kalibr_camera(const std::string& name, const std::string& pose) {
  return name + ":\n  camera_model: pinhole\n  intrinsics: [458, 457, 367, 248]\n  distortion_model: radtan\n" +
         "  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]\n  resolution: [752, 480]\n  " + pose + "\n";
}

TEST_F(CalibrationFormats, ReadsOpenvins) {
  const std::string text = "%YAML:1.0\n---\n" + kalibr_camera("cam0", "T_imu_cam: " + kBodyFromLeft) +
                           kalibr_camera("cam1", "T_imu_cam: " + kBodyFromRight);
  expect_pair(read("kalibr_imucam_chain.yaml", text), "OpenVINS", 0.0, true);
  expect_pair(read("estimator_config.yaml", "%YAML:1.0\nrelative_config_imucam: kalibr_imucam_chain.yaml\n"),
              "OpenVINS", 0.0, true);
}

TEST_F(CalibrationFormats, ReadsKalibrWithThePosesOfBothInTheImu) {
  const std::string left = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -0.05], [0, 0, 0, 1]]";
  const std::string right = "[[1, 0, 0, -0.11], [0, 1, 0, 0], [0, 0, 1, -0.05], [0, 0, 0, 1]]";
  expect_pair(
      read("a.yaml", kalibr_camera("cam0", "T_cam_imu: " + left) + kalibr_camera("cam1", "T_cam_imu: " + right)),
      "Kalibr camchain", 0.0, true);
}

const std::string kRosStart = "image_width: 752\nimage_height: 480\ndistortion_model: plumb_bob\ncamera_name: x\n";

std::string ros_camera(const std::string& fourth, const std::string& distortion = kLens) {
  return kRosStart + "camera_matrix: {rows: 3, cols: 3, data: " + kMatrix + "}\n" +
         "distortion_coefficients: {rows: 1, cols: 5, data: " + distortion + "}\n" +
         "rectification_matrix: {rows: 3, cols: 3, data: " + kUnit + "}\n" +
         "projection_matrix: {rows: 3, cols: 4, data: [400, 0, 370, " + fourth + ", 0, 400, 240, 0, 0, 0, 1, 0]}\n";
}

TEST_F(CalibrationFormats, ReadsBothCamerasOfRos) {
  write("left.yaml", ros_camera("0"));
  write("right.yaml", ros_camera("-44"));
  expect_pair(read_calibration_file(folder_ / "left.yaml", folder_ / "right.yaml"), "ROS camera_info", 0.001, false);
  expect_pair(read_calibration_file(folder_), "ROS camera_info", 0.001, false);
  EXPECT_EQ(find_calibration(folder_), folder_);
  EXPECT_FALSE(read_calibration_file(folder_ / "left.yaml").calibration.right);
  EXPECT_THAT(read_calibration_file(folder_ / "right.yaml").notes, Contains(HasSubstr("a camera of a stereo pair")));
}

TEST_F(CalibrationFormats, RejectsRosCamerasThatAreNoPair) {
  write("left.yaml", ros_camera("0"));
  EXPECT_THAT(error_of([&] { read_calibration_file(folder_ / "left.yaml", folder_ / "left.yaml"); }),
              AllOf(HasSubstr("left.yaml: projection_matrix: has no baseline"), HasSubstr("as a stereo pair")));
}

TEST_F(CalibrationFormats, ReadsTheRotationsOfRos) {
  std::string turned = ros_camera("-44");
  turned.replace(turned.find(kUnit), kUnit.size(), "[0.8, 0, -0.6, 0, 1, 0, 0.6, 0, 0.8]");
  write("left.yaml", ros_camera("0"));
  write("right.yaml", turned);
  const Pose pose = read_calibration(folder_ / "left.yaml", folder_ / "right.yaml").right->right_from_left;
  // A point of the rectified left camera, moved by the baseline, and turned back into the right camera.
  EXPECT_THAT(pose * Eigen::Vector3d(0.0, 0.0, 1.0), PointNear(Eigen::Vector3d(-0.088 + 0.6, 0.0, 0.066 + 0.8), 1e-9));
}

TEST_F(CalibrationFormats, ReadsRosIniAndCameraInfoMessages) {
  const std::string one =
      "# oST version 5.0 parameters\n\n[image]\n\nwidth\n752\n\nheight\n480\n\n[narrow_stereo/SIDE]\n\ncamera matrix\n"
      "458.0 0.0 367.0\n0.0 457.0 248.0\n0.0 0.0 1.0\n\ndistortion\n-0.28 0.07 0.0002 0.00002 0.001\n\n"
      "rectification\n1 0 0\n0 1 0\n0 0 1\n\nprojection\n400 0 370 FOURTH\n0 400 240 0\n0 0 1 0\n\n";
  std::string left = one, right = one;
  left.replace(left.find("FOURTH"), 6, "0");
  right.replace(right.find("FOURTH"), 6, "-44");
  expect_pair(read("ost.txt", left + right), "ROS camera_info", 0.001, false);
  EXPECT_EQ(read("left.ini", left).calibration.left, expected_camera(0.001));
  const std::string message = "height: 480\nwidth: 752\ndistortion_model: rational_polynomial\nD: " + kLens +
                              "\nK: " + kMatrix + "\nR: " + kUnit +
                              "\nP: [400, 0, 370, 0, 0, 400, 240, 0, 0, 0, 1, 0]\n";
  EXPECT_EQ(read("info.yaml", message).calibration.left, expected_camera(0.001));
  EXPECT_THAT(error_of([&] { read("none.ini", left.substr(0, left.find("[narrow")) + "camera matrix\n"); }),
              HasSubstr("none.ini: has 0 cameras"));
}

TEST_F(CalibrationFormats, ReadsOrbSlam2) {
  std::string text =
      "%YAML:1.0\n#---\nCamera.fx: 400.0\nCamera.fy: 400.0\nCamera.cx: 370.0\nCamera.cy: 240.0\n"
      "Camera.bf: 44.0\nCamera.width: 752\nCamera.height: 480\n";
  const CalibrationReading rectified = read("kitti.yaml", text);
  EXPECT_EQ(rectified.format, "ORB-SLAM2");
  EXPECT_EQ(rectified.calibration.left.model, CameraModel::pinhole);
  EXPECT_NEAR(rectified.calibration.right->right_from_left.translation.x(), -0.11, 1e-12);
  for (const std::string side : {"LEFT", "RIGHT"}) {
    text += side + ".height: 480\n" + side + ".width: 752\n" + side + ".D: " + matrix(1, 5, kLens) + side +
            ".K: " + matrix(3, 3, kMatrix) + side + ".R: " + matrix(3, 3, kUnit) + side + ".P: " +
            matrix(3, 4,
                   side == "LEFT" ? "[400, 0, 370, 0, 0, 400, 240, 0, 0, 0, 1, 0]"
                                  : "[400, 0, 370, -44, 0, 400, 240, 0, 0, 0, 1, 0]");
  }
  expect_pair(read("euroc.yaml", text), "ORB-SLAM2", 0.001, false);
}

TEST_F(CalibrationFormats, ReadsOrbSlamWithPlaceholdersOfARectification) {
  std::string text =
      "%YAML:1.0\nCamera.fx: 400.0\nCamera.fy: 400.0\nCamera.cx: 370.0\nCamera.cy: 240.0\nCamera.bf: 44.0\n"
      "Camera.width: 752\nCamera.height: 480\n";
  for (const std::string side : {"LEFT", "RIGHT"}) {
    text += side + ".K: " + matrix(3, 3, kMatrix) + side + ".R: " + matrix(3, 3, "[0, 0, 0, 0, 0, 0, 0, 0, 0]");
  }
  const CalibrationReading reading = read("airsim.yaml", text);
  EXPECT_EQ(reading.calibration.left.model, CameraModel::pinhole);
  EXPECT_NEAR(reading.calibration.right->right_from_left.translation.x(), -0.11, 1e-12);
  EXPECT_THAT(reading.notes, Contains(HasSubstr("LEFT.R is zero")));
}

TEST_F(CalibrationFormats, ReadsSsvoWithTheSizeOfItsImage) {
  const Camera camera = read("ssvo.yaml",
                             "%YAML:1.0\nCamera.fx: 458\nCamera.fy: 457\nCamera.cx: 367\nCamera.cy: 248\n"
                             "Camera.k1: -0.28\nImage.width: 752\nImage.height: 480\n")
                            .calibration.left;
  EXPECT_EQ(camera, (Camera{CameraModel::radial_tangential, 752, 480, 458, 457, 367, 248, {-0.28}}));
}

TEST_F(CalibrationFormats, ReadsTheColourCamerasOfKitti) {
  const Calibration kitti = read("calib.txt",
                                 "P2: 700 0 600 45 0 700 180 0 0 0 1 0.003\nP3: 700 0 600 -340 0 700 180 0 0 0 1 "
                                 "0.004\nR0_rect: 1 0 0 0 1 0 0 0 1\n")
                                .calibration;
  EXPECT_EQ(kitti.left.fx, 700.0);
  ASSERT_TRUE(kitti.right);
  EXPECT_NEAR(kitti.right->right_from_left.translation.x(), -385.0 / 700.0, 1e-12);
}

TEST_F(CalibrationFormats, ReadsOrbSlam3) {
  std::string text =
      "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera.width: 752\nCamera.height: 480\n";
  for (const std::string camera : {"Camera1.", "Camera2."}) {
    text += camera + "fx: 458\n" + camera + "fy: 457\n" + camera + "cx: 367\n" + camera + "cy: 248\n" + camera +
            "k1: -0.28\n" + camera + "k2: 0.07\n" + camera + "p1: 0.0002\n" + camera + "p2: 0.00002\n";
  }
  text += "Stereo.T_c1_c2: " + matrix(4, 4, "[1, 0, 0, 0.11, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]") +
          "IMU.T_b_c1: " + matrix(4, 4, kBodyFromLeft);
  expect_pair(read("orb3.yaml", text), "ORB-SLAM3", 0.0, true);
  std::string fisheye = text;
  fisheye.replace(fisheye.find("PinHole"), 7, "KannalaBrandt8");
  EXPECT_EQ(read("kb.yaml", fisheye).calibration.left.model, CameraModel::equidistant);
  std::string other = text;
  other.replace(other.find("PinHole"), 7, "Dual");
  EXPECT_THAT(error_of([&] { read("other.yaml", other); }), HasSubstr("other.yaml: Camera.type: \"Dual\""));
}

TEST_F(CalibrationFormats, ReadsTheDepthCameraOfOrbSlam) {
  const std::string text =
      "%YAML:1.0\nCamera.fx: 517.3\nCamera.fy: 516.5\nCamera.cx: 318.6\nCamera.cy: 255.3\n"
      "Camera.k1: 0.2624\nCamera.k2: -0.9531\nCamera.p1: -0.0054\nCamera.p2: 0.0026\n"
      "Camera.k3: 1.1633\nCamera.width: 640\nCamera.height: 480\nCamera.bf: 40.0\nDepthMapFactor: 1000.0\n";
  const CalibrationReading reading = read("TUM1.yaml", text);
  EXPECT_FALSE(reading.calibration.right);
  EXPECT_EQ(reading.calibration.left.distortion[4], 1.1633);
  EXPECT_EQ(read_depth_camera(folder_ / "TUM1.yaml").units_per_metre, 1000.0);
}

TEST_F(CalibrationFormats, ReadsStellaNestedAndFlat) {
  const std::string nested =
      "Camera:\n  name: x\n  setup: stereo\n  model: perspective\n  fx: 458\n  fy: 457\n  cx: 367\n  cy: 248\n  k1: "
      "-0.28\n"
      "  k2: 0.07\n  p1: 0.0002\n  p2: 0.00002\n  k3: 0.001\n  cols: 752\n  rows: 480\n  focal_x_baseline: 50.38\n";
  expect_pair(read("stella.yaml", nested), "stella_vslam", 0.001, false);
  const std::string source = "StereoRectifier:\n  model: perspective\n  K_left: " + kMatrix + "\n  D_left: " + kLens +
                             "\n  R_left: " + kUnit + "\n  K_right: " + kMatrix + "\n  D_right: " + kLens +
                             "\n  R_right: " + kUnit + "\n";
  expect_pair(read("source.yaml", nested + source), "stella_vslam", 0.001, false);
  const std::string flat =
      "Camera.setup: \"monocular\"\nCamera.model: \"fisheye\"\nCamera.fx: 458\nCamera.fy: 457\nCamera.cx: 367\n"
      "Camera.cy: 248\nCamera.k1: 0.1\nCamera.k4: 0.4\nCamera.cols: 752\nCamera.rows: 480\n";
  const Camera fisheye = read("flat.yaml", flat).calibration.left;
  EXPECT_EQ(fisheye.model, CameraModel::equidistant);
  EXPECT_EQ(fisheye.distortion[3], 0.4);
  EXPECT_THAT(error_of([&] { read("panorama.yaml", "Camera: {model: equirectangular, setup: monocular}\n"); }),
              HasSubstr("Camera.model: \"equirectangular\" is not supported"));
}

TEST_F(CalibrationFormats, ReadsVinsWithTheFilesOfItsCameras) {
  const std::string start = "%YAML:1.0\n---\nmodel_type: ";
  const std::string size = "\ncamera_name: camera\nimage_width: 752\nimage_height: 480\n";
  const std::string lens = "distortion_parameters:\n   k1: -0.28\n   k2: 0.07\n   p1: 0.0002\n   p2: 0.00002\n";
  write("cam0.yaml",
        start + "PINHOLE" + size + lens + "projection_parameters:\n   fx: 458\n   fy: 457\n   cx: 367\n   cy: 248\n");
  const std::string rig =
      "%YAML:1.0\nimu: 1\nnum_of_cam: 2\ncam0_calib: \"cam0.yaml\"\ncam1_calib: \"cam0.yaml\"\n"
      "body_T_cam0: " +
      matrix(4, 4, kBodyFromLeft) + "body_T_cam1: " + matrix(4, 4, kBodyFromRight);
  expect_pair(read("vins.yaml", rig), "VINS-Fusion", 0.0, true);
  const Camera mei =
      read("mei.yaml", start + "MEI" + size + "mirror_parameters:\n   xi: 1.9\n" + lens +
                           "projection_parameters:\n   gamma1: 900\n   gamma2: 901\n   u0: 367\n   v0: 248\n")
          .calibration.left;
  EXPECT_EQ(mei, (Camera{CameraModel::unified, 752, 480, 900, 901, 367, 248, {-0.28, 0.07, 2e-4, 2e-5, 1.9}}));
  const Camera kannala = read("kb.yaml", start + "KANNALA_BRANDT" + size +
                                             "projection_parameters:\n   k2: 0.1\n   k3: 0.2\n   k4: 0.3\n   k5: 0.4\n"
                                             "   mu: 300\n   mv: 301\n   u0: 367\n   v0: 248\n")
                             .calibration.left;
  EXPECT_EQ(kannala, (Camera{CameraModel::equidistant, 752, 480, 300, 301, 367, 248, {0.1, 0.2, 0.3, 0.4}}));
  EXPECT_THAT(error_of([&] { read("ocam.yaml", start + "SCARAMUZZA" + size + "projection_parameters: {a: 1}\n"); }),
              HasSubstr("model_type: \"SCARAMUZZA\" is not supported"));
}

TEST_F(CalibrationFormats, ReadsOkvis) {
  const auto camera = [](const std::string& pose) {
    return "  - {T_SC: " + pose +
           ", image_dimension: [752, 480], distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]," +
           " distortion_type: radialtangential, focal_length: [458, 457], principal_point: [367, 248]}\n";
  };
  expect_pair(read("okvis.yaml", "%YAML:1.0\ncameras:\n" + camera(kBodyFromLeft) + camera(kBodyFromRight)), "okvis",
              0.0, true);
}

TEST_F(CalibrationFormats, ReadsMaplab) {
  const auto camera = [](const std::string& pose) {
    return "  - camera: {label: x, line-delay-nanoseconds: 10000, image_height: 480, image_width: 752, type: pinhole,\n"
           "      intrinsics: {cols: 1, rows: 4, data: [458, 457, 367, 248]},\n"
           "      distortion: {type: radial-tangential, parameters: {cols: 1, rows: 4, data: [-0.28, 0.07, 0.0002, "
           "0.00002]}}}\n    T_B_C: {cols: 4, rows: 4, data: " +
           pose + "}\n";
  };
  const CalibrationReading reading =
      read("ncamera.yaml", "label: x\ncameras:\n" + camera(kBodyFromLeft) + camera(kBodyFromRight));
  expect_pair(reading, "maplab", 0.0, true);
  EXPECT_NEAR(reading.calibration.readout_time, 0.0048, 1e-12);
}

TEST_F(CalibrationFormats, ReadsBasalt) {
  const std::string lens =
      R"({"camera_type": "ds", "intrinsics": {"fx": 158, "fy": 157, "cx": 254, "cy": 256, "xi": -0.18, "alpha": 0.59}})";
  const std::string pose = R"("py": 0, "pz": 0.05, "qx": 0, "qy": 0, "qz": 0, "qw": 1})";
  const CalibrationReading reading =
      read("calib.json", R"({"value0": {"T_imu_cam": [{"px": 0, )" + pose + R"(, {"px": 0.11, )" + pose +
                             R"(], "intrinsics": [)" + lens + ", " + lens +
                             R"(], "resolution": [[512, 512], [512, 512]]}})");
  EXPECT_EQ(reading.format, "basalt");
  EXPECT_EQ(reading.calibration.left,
            (Camera{CameraModel::double_sphere, 512, 512, 158, 157, 254, 256, {0, 0, 0, 0, -0.18, 0.59}}));
  ASSERT_TRUE(reading.calibration.right);
  EXPECT_NEAR(reading.calibration.right->right_from_left.translation.x(), -0.11, 1e-12);
  EXPECT_EQ(reading.calibration.body_from_left.translation.z(), 0.05);
}

TEST_F(CalibrationFormats, ReadsOpencvPairs) {
  const std::string size = "image_width: 752\nimage_height: 480\n";
  const std::string pose = "R: " + matrix(3, 3, kUnit) + "T: " + matrix(3, 1, "[-0.11, 0, 0]");
  for (const auto& [matrix_name, lens_name] :
       {std::pair("M", "D"), std::pair("K", "D"), std::pair("cameraMatrix", "distCoeffs")}) {
    std::string lenses;
    for (const std::string number : {"1", "2"}) {
      lenses += matrix_name + number + ": " + matrix(3, 3, kMatrix) + lens_name + number + ": " + matrix(1, 5, kLens);
    }
    expect_pair(read("stereo.yml", "%YAML:1.0\n---\n" + size + lenses + pose), "OpenCV stereo", 0.001, false);
    write("intrinsics.yml", "%YAML:1.0\n---\n" + lenses);
    write("extrinsics.yml", "%YAML:1.0\n---\n" + pose);
  }
  const Calibration apart = read_calibration_file(folder_ / "intrinsics.yml", folder_ / "extrinsics.yml").calibration;
  EXPECT_EQ(apart.left.width, 0);
  EXPECT_NEAR(apart.right->right_from_left.translation.x(), -0.11, 1e-12);
  EXPECT_EQ(read_calibration_file(folder_ / "intrinsics.yml").calibration, apart);
  EXPECT_EQ(read_calibration_file(folder_).calibration, apart);
  EXPECT_THAT(error_of([&] { read_calibration(folder_ / "intrinsics.yml"); }),
              AllOf(HasSubstr("intrinsics.yml: does not have the image size"), HasSubstr("--size")));
}

TEST_F(CalibrationFormats, ReadsOneOfSeveralCamerasByItsName) {
  const std::string rest = ", D: " + kLens + ", width: 752, height: 480}\n";
  const std::string text = "cam0: {K: [500, 0, 300, 0, 500, 200, 0, 0, 1]" + rest + "cam1: {K: " + kMatrix +
                           ", T_BS: " + kBodyFromLeft + rest + "cam2: {K: [600, 0, 300, 0, 600, 200, 0, 0, 1]" + rest;
  const std::string refusal = error_of([&] { read("cameras.yaml", text); });
  EXPECT_THAT(refusal, AllOf(HasSubstr("has 3 cameras: cam0, cam1, cam2, without relative poses"),
                             HasSubstr("one camera alone: "), HasSubstr("cameras.yaml#cam0")));
  const Calibration second = read_calibration(folder_ / "cameras.yaml#cam1");
  EXPECT_EQ(second.left, expected_camera(0.001));
  EXPECT_EQ(second.body_from_left.translation.z(), 0.05);
  EXPECT_FALSE(second.right);
  EXPECT_EQ(read_calibration(folder_ / "cameras.yaml#cam2").left.fx, 600.0);
  EXPECT_THAT(error_of([&] { read_calibration(folder_ / "cameras.yaml#cam3"); }),
              AllOf(HasSubstr("has no camera \"cam3\""), HasSubstr("cam0, cam1, cam2")));
  EXPECT_THAT(error_of([&] { read_calibration(folder_ / "absent.yaml#cam0"); }), HasSubstr("cannot be opened"));
  EXPECT_EQ(file_of_camera(folder_ / "cameras.yaml#cam1"), folder_ / "cameras.yaml");
  write("odd#name.yaml", ros_camera("0"));
  EXPECT_EQ(file_of_camera(folder_ / "odd#name.yaml"), folder_ / "odd#name.yaml");
}

TEST_F(CalibrationFormats, ReadsOneCameraOfAPairWithoutPose) {
  const std::string other = "M2: [500, 0, 300, 0, 500, 200, 0, 0, 1]\nD2: " + kLens + "\n";
  write("pair.yml", "image_width: 752\nimage_height: 480\nM1: " + kMatrix + "\nD1: " + kLens + "\n" + other);
  EXPECT_EQ(read_calibration(folder_ / "pair.yml#left").left, expected_camera(0.001));
  EXPECT_EQ(read_calibration(folder_ / "pair.yml#right").left.fx, 500.0);
  try {
    read_calibration(folder_ / "pair.yml");
    FAIL() << "no camera is chosen";
  } catch (const UnplacedCameras& unplaced) {
    EXPECT_THAT(unplaced.names(), testing::ElementsAre("left", "right"));
    EXPECT_EQ(unplaced.side(true), folder_ / "pair.yml#right");
    EXPECT_THAT(unplaced.what(), AllOf(HasSubstr("R, T: is missing"), HasSubstr("pair.yml#left")));
  }
}

TEST_F(CalibrationFormats, NamesTheCamerasOfAKalibrFileWithoutPoses) {
  const std::string text = kalibr_camera("cam0", "rostopic: /a") + kalibr_camera("cam1", "rostopic: /b");
  EXPECT_THAT(error_of([&] { read("a.yaml", text); }),
              AllOf(HasSubstr("cam1.T_cn_cnm1: is missing"), HasSubstr("a.yaml#cam0")));
  EXPECT_EQ(read_calibration(folder_ / "a.yaml#cam1").left, expected_camera(0.0));
  EXPECT_THAT(read_calibration_file(folder_ / "a.yaml#right").notes, Contains("the right camera is cam1"));
  const std::string third = "T_cn_cnm1: " + kBodyFromRight;
  write("b.yaml", kalibr_camera("cam0", third) + kalibr_camera("cam1", third) + kalibr_camera("cam2", third));
  const CalibrationReading alone = read_calibration_file(folder_ / "b.yaml#cam2");
  EXPECT_EQ(alone.calibration.left, expected_camera(0.0));
  EXPECT_THAT(alone.notes, Contains(HasSubstr("the pose of cam2 is not used")));
}

TEST_F(CalibrationFormats, ReadsArraysThatNumpyPrinted) {
  const std::string k = "K:\n [[458.   0. 367.]\n [  0. 457. 248.]\n [  0.   0.   1.]]\n";
  EXPECT_EQ(read("k.txt", k + "D:\n [[-2.8e-01  0.07  0.0002\n   0.00002 0.001]]\nsize: [752, 480]\n").calibration.left,
            expected_camera(0.001));
  EXPECT_THAT(error_of([&] { read("k.txt", "K: [[1, 2\nD: 3\n"); }), HasSubstr("correct the YAML"));
}

TEST_F(CalibrationFormats, ReadsSeveralDocumentsOfAFile) {
  const std::string k = "{K: '[[458, 0, 367], [0, 457, 248], [0, 0, 1]]', size: [752, 480]}\n";
  const CalibrationReading apart = read("a.yaml", k + "---\n{D: " + kLens + "}\n");
  EXPECT_EQ(apart.calibration.left, expected_camera(0.001)) << "the distortion is in the second document";
  EXPECT_THAT(apart.notes, Contains("2 YAML documents of the file are read together"));
  const std::string other = "K: [500, 0, 300, 0, 500, 200, 0, 0, 1]\nsize: [752, 480]\n";
  EXPECT_EQ(read("a.yaml", other + "---\n" + other).calibration.left.fx, 500.0) << "the same camera twice";
  EXPECT_THAT(error_of([&] { read("a.yaml", k + "---\n" + other); }), HasSubstr("a.yaml#documents[0]"));
  EXPECT_EQ(read_calibration(folder_ / "a.yaml#documents[1]").left.fx, 500.0);
  EXPECT_THAT(read("a.yaml", other + "---\n{K: [1\n").notes, Contains(HasSubstr("is not valid and is not used")));
}

TEST_F(CalibrationFormats, ReadsFieldsWithTheNameOfTheCamera) {
  const std::string size = "width: 752\nheight: 480\n";
  EXPECT_EQ(read("zed.yaml", size + "zed_K: " + kMatrix + "\nzed_D: " + kLens + "\n").calibration.left,
            expected_camera(0.001));
  write("groups.yaml", size + "top_projection_parameters: {fx: 458, fy: 457, cx: 367, cy: 248}\n" +
                           "top_distortion_parameters: {k1: -0.28, k2: 0.07, p1: 0.0002, p2: 0.00002}\n" +
                           "low_projection_parameters: {fx: 500, fy: 500, cx: 300, cy: 200}\n" +
                           "low_distortion_parameters: {k1: 0.1, k2: 0, p1: 0, p2: 0}\n");
  EXPECT_EQ(read_calibration(folder_ / "groups.yaml#top").left, expected_camera(0.0));
  EXPECT_EQ(read_calibration(folder_ / "groups.yaml#low").left.distortion[0], 0.1);
}

TEST_F(CalibrationFormats, NamesFishPolyAsUnsupported) {
  EXPECT_THAT(error_of([&] { read("odin.yaml", "cam_0:\n  cam_model: FishPoly\n  A11: 734\n"); }),
              AllOf(HasSubstr("cam_0.cam_model: \"FishPoly\" is not supported"), HasSubstr("--models")));
}

TEST_F(CalibrationFormats, ReadsOpencvXml) {
  const std::string start =
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>752</image_width>\n<image_height>480</image_height>\n";
  const auto element = [](const std::string& name, int rows, int columns, const std::string& data) {
    return "<" + name + " type_id=\"opencv-matrix\">\n  <rows>" + std::to_string(rows) + "</rows>\n  <cols>" +
           std::to_string(columns) + "</cols>\n  <dt>d</dt>\n  <data>\n    " + data + "</data></" + name + ">\n";
  };
  const std::string matrices = element("camera_matrix", 3, 3, "458. 0. 367. 0. 457. 248. 0. 0. 1.") +
                               element("distortion_coefficients", 5, 1, "-2.8e-01 0.07 0.0002 0.00002 0.001");
  const CalibrationReading reading = read("out_camera_data.xml", start + matrices + "</opencv_storage>\n");
  EXPECT_EQ(reading.format, "OpenCV");
  EXPECT_EQ(reading.calibration.left, expected_camera(0.001));
  EXPECT_THAT(error_of([&] { read("page.xml", "<html><body></html>"); }), HasSubstr("page.xml:1: is not valid XML"));
  EXPECT_THAT(error_of([&] { read("storage.xml", "<opencv_storage><a></opencv_storage>"); }),
              HasSubstr("storage.xml: is not XML that OpenCV wrote"));
}

TEST_F(CalibrationFormats, ReadsLongListsOfOpencv) {
  const Camera camera =
      read("rational.yaml", ros_camera("0", "[0.4, -0.1, 0.0005, -0.0004, 0.003, 0.8, -0.1, 0.002]")).calibration.left;
  EXPECT_EQ(camera.model, CameraModel::rational);
  EXPECT_EQ(camera.distortion[7], 0.002);
  EXPECT_THAT(error_of([&] { read("long.yaml", ros_camera("0", "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]")); }),
              HasSubstr("distortion_coefficients: has 15 numbers instead of 14"));
}

TEST_F(CalibrationFormats, IgnoresAByteOrderMark) {
  EXPECT_EQ(read("bom.yaml", "\xEF\xBB\xBF" + ros_camera("0")).calibration.left, expected_camera(0.001));
  EXPECT_EQ(read("bom_opencv.yaml", "\xEF\xBB\xBF%YAML:1.0\n---\n" + ros_camera("0")).calibration.left,
            expected_camera(0.001));
}

TEST_F(CalibrationFormats, RejectsShapesOutsideTheirDomain) {
  const auto kalibr = [](const std::string& model, const std::string& shape) {
    return "cam0: {camera_model: " + model + ", intrinsics: [" + shape +
           ", 458, 457, 367, 248], distortion_model: none, distortion_coeffs: [], resolution: [752, 480]}\n";
  };
  EXPECT_EQ(read("ds.yaml", kalibr("ds", "-0.2, 0.6")).calibration.left.distortion[5], 0.6);
  EXPECT_THAT(error_of([&] { read("ds.yaml", kalibr("ds", "-0.2, 1.6")); }),
              HasSubstr("cam0.intrinsics: has shape parameters outside"));
  EXPECT_THAT(error_of([&] { read("eucm.yaml", kalibr("eucm", "0.6, -1")); }), HasSubstr("beta > 0"));
  EXPECT_THAT(error_of([&] { read("omni.yaml", kalibr("omni", "-1.5")); }), HasSubstr("xi > -1"));
  EXPECT_THAT(error_of([&] { read("omni.yaml", kalibr("omni", "1.5, 3")); }), HasSubstr("has 6 numbers instead of 5"));
}

TEST_F(CalibrationFormats, ReadsBackEveryModelThatIsWritten) {
  for (int number = 0; number < kCameraModels; ++number) {
    Camera camera{static_cast<CameraModel>(number), 752, 480, 458.0, 457.0, 367.0, 248.0, {}};
    if (number > 0) camera.distortion = {-0.28, 0.07, 2e-4, 2e-5};
    if (number > 2) camera.distortion[4] = 0.5;
    if (camera.model == CameraModel::extended_unified || camera.model == CameraModel::double_sphere)
      camera.distortion[5] = 0.6;
    if (camera.model == CameraModel::thin_prism_fisheye) camera.distortion[7] = 0.002;
    if (camera.model == CameraModel::rational) camera.distortion[13] = 0.01;
    Calibration calibration;
    calibration.left = camera;
    EXPECT_EQ(read("written.yaml", write_calibration(calibration)).calibration.left, camera) << to_string(camera.model);
  }
}

}  // namespace
}  // namespace byre
