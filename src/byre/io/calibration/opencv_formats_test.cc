// Cameras under the names that programs invent for OpenCV's matrices and coefficients, and calibrations of devices.

#include "byre/calibration_file.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>

namespace byre {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

const std::string kMatrix = "[458, 0, 367, 0, 457, 248, 0, 0, 1]";
const std::string kLens = "[-0.28, 0.07, 0.0002, 0.00002, 0.001]";
const Camera kExpected{CameraModel::radial_tangential,  752, 480, 458.0, 457.0, 367.0, 248.0,
                       {-0.28, 0.07, 2e-4, 2e-5, 0.001}};

class OtherCalibrations : public TestFolder {
 protected:
  CalibrationReading read(const std::string& name, const std::string& text) const {
    write(name, text);
    return read_calibration_file(folder_ / name);
  }
  Camera camera(const std::string& text) const { return read("camera.yaml", text).calibration.left; }
  std::string refusal(const std::string& text) const {
    return error_of([&] { camera(text); });
  }
  static Camera without_size(Camera camera) {
    camera.width = camera.height = 0;
    return camera;
  }
};

// Largest difference to OpenCV's projection of the numbers in a file, over a grid of rays.
double difference_to_opencv(const Camera& camera, const std::vector<double>& k, const std::vector<double>& d,
                            bool is_fisheye = false) {
  const cv::Matx33d matrix(k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0);
  double largest = 0.0;
  for (double x = -0.6; x < 0.61; x += 0.1) {
    for (double y = -0.4; y < 0.41; y += 0.1) {
      std::vector<cv::Point2d> pixels;
      const std::vector<cv::Point3d> points = {{x, y, 1.0}};
      if (is_fisheye) {
        cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), matrix, d);
      } else {
        cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, d, pixels);
      }
      const auto own = camera.project({x, y, 1.0});
      EXPECT_TRUE(own);
      if (own) largest = std::max(largest, (*own - Eigen::Vector2d(pixels[0].x, pixels[0].y)).norm());
    }
  }
  return largest;
}

constexpr double kMostPixels = 0.01;

TEST_F(OtherCalibrations, AreReadUnderManyNames) {
  const std::string rows = "[[458, 0, 367], [0, 457, 248], [0, 0, 1]]";
  EXPECT_EQ(camera("image_size: [752, 480]\ncamera_matrix: " + rows + "\ndistort_coeffs: " + kLens + "\n"), kExpected);
  EXPECT_EQ(
      camera("{\"resolution\": {\"width\": 752, \"height\": 480}, \"cameraIntrinsics\": {\"rows\": 3, \"cols\": 3, "
             "\"data\": " +
             kMatrix + "}, \"distCoeffs\": {\"rows\": 1, \"data\": " + kLens + "}}"),
      kExpected);
  EXPECT_EQ(camera("{\"mtx\": " + rows + ", \"dist\": [" + kLens + "]}"), without_size(kExpected));
  EXPECT_EQ(camera("image_width: 752\nimage_height: 480\ncamera_matrix: " + kMatrix + "\n").model,
            CameraModel::pinhole);
  EXPECT_THAT(refusal("K: " + kMatrix + "\nD: [1, 2]\n"), HasSubstr("D: has 2 numbers instead of 4"));
  EXPECT_THAT(refusal("K: " + kMatrix + "\nD: " + kLens + "\ndistortion_model: division\n"),
              HasSubstr("distortion_model: \"division\" is not supported"));
}

TEST_F(OtherCalibrations, AreReadColumnByColumn) {
  const CalibrationReading reading = read(
      "open3d.json", "{\"width\": 752, \"height\": 480, \"intrinsic_matrix\": [458, 0, 0, 0, 457, 0, 367, 248, 1]}");
  EXPECT_EQ(reading.calibration.left, (Camera{CameraModel::pinhole, 752, 480, 458.0, 457.0, 367.0, 248.0, {}}));
  EXPECT_THAT(reading.notes, Contains(HasSubstr("column by column")));
}

TEST_F(OtherCalibrations, AreReadOnceIfTheyAreStoredTwice) {
  const std::string flat =
      "extra: {cam_fx: 458, cam_fy: 457, cam_cx: 367, cam_cy: 248, cam_width: 752, cam_height: 480, "
      "cam_d0: -0.28, cam_d1: 0.07, cam_d2: 0.0002, cam_d3: 0.00002, cam_d4: 0.001}\n";
  EXPECT_EQ(camera("sensor:\n  K: [458, 0, 367, 0, 0, 457, 248, 0, 0, 0, 1, 0]\n  D: " + kLens +
                   "\n  size: [752, 480]\n" + flat),
            kExpected);
}

TEST_F(OtherCalibrations, LoseASkewThatMovesPixelsLittle) {
  const std::string start = "image_width: 752\nimage_height: 480\ncamera_matrix: [458, ";
  const CalibrationReading reading =
      read("skew.yaml", start + "0.3, 367, 0, 457, 248, 0, 0, 1]\ndistortion_coefficients: " + kLens + "\n");
  EXPECT_EQ(reading.calibration.left, kExpected);
  EXPECT_THAT(reading.notes, Contains(HasSubstr("moves pixels by at most 0.16 pixels")));
  EXPECT_THAT(refusal(start + "3, 367, 0, 457, 248, 0, 0, 1]\n"), HasSubstr("without skew"));
}

TEST_F(OtherCalibrations, AreFoundInsideOtherFields) {
  const std::string inner = "      width: 752\n      height: 480\n      K: " + kMatrix + "\n      D: " + kLens + "\n";
  EXPECT_EQ(camera("node:\n  ros__parameters:\n    front:\n" + inner + "    rate: 20\n"), kExpected);
  const std::string pair = "rig:\n    right:\n" + inner + "    left:\n" + inner +
                           "    R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n    T: [-0.11, 0, 0]\n";
  const Calibration both = read("pair.yaml", pair).calibration;
  ASSERT_TRUE(both.right);
  EXPECT_THAT(both.right->right_from_left.translation, PointNear(Eigen::Vector3d(-0.11, 0.0, 0.0), 1e-12));
  EXPECT_THAT(refusal("a:\n  x:\n" + inner + "  y:\n" + inner + "  z:\n" + inner),
              AllOf(HasSubstr("has 3 cameras: a.x, a.y, a.z"), HasSubstr("one camera or of a stereo pair")));
  EXPECT_THAT(refusal("a:\n  left:\n" + inner + "  right:\n" + inner), HasSubstr("is missing (give the pose"));
}

TEST_F(OtherCalibrations, ShareFieldsOfTheGroupAroundThem) {
  const std::string split =
      "camera:\n  image_size: {width: 752, height: 480}\n  intrinsics: {fx: 458, fy: 457, cx: 367, cy: 248}\n";
  EXPECT_EQ(camera(split + "  distortion: {model: radtan, k1: -0.28, k2: 0.07, p1: 0.0002, p2: 0.00002, k3: 0.001}\n"),
            kExpected);
  EXPECT_EQ(camera(split + "  distortion_coefficients: " + kLens + "\n"), kExpected);
  EXPECT_EQ(camera(split + "  distortion: {model: equidistant, coeffs: [0.1, 0.2, 0.3, 0.4]}\n").model,
            CameraModel::equidistant);
  EXPECT_EQ(camera(split).model, CameraModel::pinhole);
  EXPECT_THAT(refusal(split + "  distortion: {a: 1, b: 2}\n"), HasSubstr("distortion: has no coefficients"));
}

const std::string kBodyFromLeft = "[0, 0, 1, 0.3, -1, 0, 0, 0.1, 0, -1, 0, 0.2, 0, 0, 0, 1]";
const std::string kBodyFromRight = "[0, 0, 1, 0.3, -1, 0, 0, -0.01, 0, -1, 0, 0.2, 0, 0, 0, 1]";

void expect_placed_pair(const Calibration& calibration, const Camera& expected) {
  EXPECT_EQ(calibration.left, expected);
  ASSERT_TRUE(calibration.right);
  EXPECT_EQ(calibration.right->camera, expected);
  EXPECT_THAT(calibration.right->right_from_left,
              PoseNear(Pose{Eigen::Quaterniond::Identity(), {-0.11, 0.0, 0.0}}, 1e-9, 1e-9));
  EXPECT_THAT(calibration.body_from_left.translation, PointNear(Eigen::Vector3d(0.3, 0.1, 0.2), 1e-9));
}

TEST_F(OtherCalibrations, HaveAListOfFourIntrinsics) {
  const std::string size = "width: 752\nheight: 480\n";
  const CalibrationReading reading =
      read("mast3r.yaml", size + "calibration: [458, 457, 367, 248, -0.28, 0.07, 0.0002, 0.00002, 0.001]\n");
  EXPECT_EQ(reading.calibration.left, kExpected);
  EXPECT_THAT(reading.notes, Contains(HasSubstr("are read as fx, fy, cx, cy, k1, k2, p1, p2")));
  EXPECT_THAT(refusal(size + "intrinsics: [458, 900, 367, 248]\n"), HasSubstr("is not a supported calibration file"))
      << "focal lengths are not alike";
  std::string pair = "camera:\n";
  for (const std::string side : {"left", "right"}) {
    pair += "  intrinsics_" + side + ": [458, 457, 367, 248]\n  distortion_coeffs_" + side + ": " + kLens +
            "\n  resolution_" + side + ": [752, 480]\n  distortion_model_" + side + ": radtan\n";
  }
  expect_placed_pair(
      read("pair.yaml", pair + "  T_imu_cam_left: " + kBodyFromLeft + "\n  T_imu_cam_right: " + kBodyFromRight + "\n")
          .calibration,
      kExpected);
}

TEST_F(OtherCalibrations, ArePlacedByPosesNextToTheCameras) {
  const std::string lens = "{fx: 458, fy: 457, cx: 367, cy: 248, distortion: " + kLens + "}\n";
  expect_placed_pair(read("ekf.yaml", "camera:\n  image_width: 752\n  image_height: 480\n  cam0: " + lens + "  cam1: " +
                                          lens + "  T_BS0: " + kBodyFromLeft + "\n  T_BS1: " + kBodyFromRight + "\n")
                         .calibration,
                     kExpected);
}

TEST_F(OtherCalibrations, OfLarvioHaveTheirPoseAndSizeAround) {
  const auto text = [](const std::string& model) {
    return "%YAML:1.0\ncamera_model: \"pinhole\"\ndistortion_model: \"" + model +
           "\"\nresolution_width: 752\nresolution_height: 480\nintrinsics:\n   fx: 458\n   fy: 457\n   cx: 367\n   cy: "
           "248\ndistortion_coeffs:\n   k1: 0.1\n   k2: 0.2\n   p1: 0.3\n   p2: 0.4\nT_cam_imu: [1, 0, 0, -0.5, 0, 1, "
           "0, "
           "0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
  };
  const Calibration fisheye = read("larvio.yaml", text("equidistant")).calibration;
  EXPECT_EQ(fisheye.left, (Camera{CameraModel::equidistant, 752, 480, 458, 457, 367, 248, {0.1, 0.2, 0.3, 0.4}}));
  EXPECT_EQ(fisheye.body_from_left.translation.x(), 0.5);
  EXPECT_EQ(camera(text("radtan")).model, CameraModel::radial_tangential);
}

TEST_F(OtherCalibrations, NameTheLensByTheModelOfTheDistortion) {
  const std::string four = "[0.1, 0.2, 0.3, 0.4]";
  EXPECT_EQ(camera("camera_model: pinhole\ndistortion_model: equidistant\nK: " + kMatrix + "\nD: " + four + "\n").model,
            CameraModel::equidistant);
  EXPECT_EQ(
      camera("model: pinhole\nfx: 458\nfy: 457\ncx: 367\ncy: 248\ndistortion: {type: fisheye, coeffs: " + four + "}\n")
          .model,
      CameraModel::equidistant);
}

TEST_F(OtherCalibrations, NameTheLensAsTypeOfTheCamera) {
  EXPECT_EQ(camera("camera:\n  camera_matrix: " + kMatrix +
                   "\n  dist_coeffs: [0.1, 0.2, 0.3, 0.4]\n  camera_type: \"fisheye\"\n")
                .model,
            CameraModel::equidistant);
}

TEST_F(OtherCalibrations, AreLinesOfAMatrix) {
  const std::string rows = "458 0 367\n0 457 248\n0 0 1\n";
  EXPECT_EQ(camera(rows), without_size(Camera{CameraModel::pinhole, 0, 0, 458, 457, 367, 248, {}}));
  EXPECT_EQ(camera(rows + "-0.28 0.07 0.0002 0.00002 0.001\n"), without_size(kExpected));
  EXPECT_EQ(camera("458,0,367 0,457,248 0,0,1\n-0.28,0.07,0.0002,0.00002,0.001\n"), without_size(kExpected));
  EXPECT_EQ(camera("458 0 367 0\n0 457 248 0\n0 0 1 0\n0 0 0 1\n").fx, 458.0);
  EXPECT_EQ(camera("fx 458\nfy 457\ncx 367\ncy 248\nw 752\nh 480\n").width, 752);
}

TEST_F(OtherCalibrations, OfVispHaveOneModelWithDistortion) {
  const std::string start = "<root><camera><image_width>752</image_width><image_height>480</image_height>";
  const std::string ideal = "<model><px>450</px><py>451</py><u0>360</u0><v0>240</v0></model>";
  const std::string full =
      "<model><px>458</px><py>457</py><u0>367</u0><v0>248</v0><kud>0.02</kud><kdu>-0.02</kdu></model>";
  const Camera visp = read("camera.xml", start + ideal + full + "</camera></root>").calibration.left;
  EXPECT_EQ(visp, (Camera{CameraModel::radial_tangential, 752, 480, 458, 457, 367, 248, {0.02}}));
}

TEST_F(OtherCalibrations, OfOcamcalibAreRefusedByName) {
  EXPECT_THAT(refusal("#direct\n3 -7e+02 0 8e-04\n#inverse\n2 976 423\n#centre\n630 958\n#affine\n0.99 -0.01 0.01\n"
                      "#size\n1208 1920\n"),
              AllOf(HasSubstr("OCamCalib"), HasSubstr("omni-radtan")));
}

TEST_F(OtherCalibrations, WithManyUnplacedCamerasAreRefusedByTheirNames) {
  const std::string lens = "{K: " + kMatrix + ", D: " + kLens + "}\n";
  EXPECT_THAT(refusal("cam_front: " + lens + "cam_left: " + lens + "cam_right: " + lens),
              HasSubstr("has 3 cameras: cam_front, cam_left, cam_right"));
}

TEST_F(OtherCalibrations, AreReadOnceIfEveryFrameHasTheSame) {
  const auto frame = [](const std::string& k1) {
    return "{\"w\": 752, \"h\": 480, \"fl_x\": 458, \"fl_y\": 457, \"cx\": 367, \"cy\": 248, \"k1\": " + k1 +
           ", \"k2\": 0.07, \"p1\": 0.0002, \"p2\": 0.00002, \"k3\": 0.001}";
  };
  const CalibrationReading reading =
      read("transforms.json", "{\"frames\": [" + frame("-0.28") + ", " + frame("-0.28") + "]}");
  EXPECT_EQ(reading.calibration.left, kExpected);
  EXPECT_THAT(reading.notes, Contains(HasSubstr("2 entries have the same camera")));
  EXPECT_THAT(refusal("{\"frames\": [" + frame("-0.28") + ", " + frame("-0.3") + ", " + frame("-0.4") + "]}"),
              HasSubstr("has 3 cameras: frames[0], frames[1], frames[2]"));
}

TEST_F(OtherCalibrations, OfAColourCameraAreUsedAloneNextToItsDepthCamera) {
  const std::string lens =
      "{fx: 458, fy: 457, cx: 367, cy: 248, k1: -0.28, k2: 0.07, p1: 0.0002, p2: 0.00002, k3: 0.001}";
  const CalibrationReading reading = read("rgbd.yaml", "ir_intrinsic: " + lens + "\ncolor_intrinsic: " + lens + "\n");
  EXPECT_EQ(reading.calibration.left, without_size(kExpected));
  EXPECT_FALSE(reading.calibration.right);
  EXPECT_THAT(reading.notes, Contains(HasSubstr("of 2 cameras, color_intrinsic is used")));
}

TEST_F(OtherCalibrations, RelativeToTheImageSizeNeedIt) {
  const std::string matrix = "[[0.6, 0, 0.5], [0, 0.9, 0.5], [0, 0, 1]]";
  EXPECT_THAT(refusal(matrix), AllOf(HasSubstr("K: is relative to the image size"), HasSubstr("--size")));
  write("k.json", matrix);
  EXPECT_EQ(read_calibration_file(folder_ / "k.json", {}, std::pair(1000, 600)).calibration.left,
            (Camera{CameraModel::pinhole, 1000, 600, 600.0, 540.0, 499.5, 299.5, {}}));
}

TEST_F(OtherCalibrations, AreReadWithOneFieldForEachNumber) {
  const CalibrationReading realsense =
      read("realsense.json",
           "{\"width\": 752, \"height\": 480, \"fx\": 458, \"fy\": 457, \"ppx\": 367, \"ppy\": 248, "
           "\"model\": \"distortion.brown_conrady\", \"coeffs\": " +
               kLens + "}");
  EXPECT_EQ(realsense.calibration.left, kExpected);
  EXPECT_THAT(refusal("{fx: 458, fy: 457, ppx: 367, ppy: 248, model: inverse_brown_conrady, coeffs: " + kLens + "}"),
              HasSubstr("an inverse model"));
  EXPECT_EQ(camera("{w: 752, h: 480, fl_x: 458, fl_y: 457, cx: 367, cy: 248, k1: -0.28, k2: 0.07, p1: 0.0002, "
                   "p2: 0.00002, k3: 0.001, camera_model: OPENCV}"),
            kExpected);
  const Camera relative = camera(
      "{cam_model: ATAN, cam_width: 640, cam_height: 480, cam_fx: 1.1, cam_fy: 1.4, "
      "cam_cx: 0.49, cam_cy: 0.48, cam_d0: 0.9}");
  EXPECT_EQ(relative.model, CameraModel::field_of_view);
  EXPECT_NEAR(relative.cx, 0.49 * 640 - 0.5, 1e-9);
  EXPECT_NEAR(relative.fy, 1.4 * 480, 1e-9);
  EXPECT_NEAR(relative.distortion[4], 0.9, 1e-12);
  EXPECT_LT(difference_to_opencv(camera("{fx: 300, fy: 301, cx: 320, cy: 240, width: 640, height: 480, model: fisheye, "
                                        "k1: 0.1, k2: 0.02, k3: -0.01, k4: 0.001}"),
                                 {300, 301, 320, 240}, {0.1, 0.02, -0.01, 0.001}, true),
            kMostPixels);
}

TEST_F(OtherCalibrations, AreReadWithoutNames) {
  EXPECT_EQ(camera("458 457 367 248 -0.28 0.07 0.0002 0.00002 0.001\n"), without_size(kExpected));
  EXPECT_EQ(camera("RadTan 458 457 367 248 -0.28 0.07 0.0002 0.00002\n752 480\ncrop\n640 480\n"),
            (Camera{CameraModel::radial_tangential, 752, 480, 458.0, 457.0, 367.0, 248.0, {-0.28, 0.07, 2e-4, 2e-5}}));
  const Camera fov = camera("0.5 0.8 0.5 0.5 0.9\n640 480\nfull\n640 480\n");
  EXPECT_EQ(fov, (Camera{CameraModel::field_of_view, 640, 480, 320.0, 384.0, 319.5, 239.5, {0, 0, 0, 0, 0.9}}));
  EXPECT_EQ(camera("# cameras\n3 OPENCV 752 480 458 457 367.5 248.5 -0.28 0.07 0.0002 0.00002\n"),
            (Camera{CameraModel::radial_tangential, 752, 480, 458.0, 457.0, 367.0, 248.0, {-0.28, 0.07, 2e-4, 2e-5}}));
  EXPECT_EQ(camera("1 SIMPLE_RADIAL 752 480 458 367.5 248.5 -0.1\n"),
            (Camera{CameraModel::radial_tangential, 752, 480, 458.0, 458.0, 367.0, 248.0, {-0.1}}));
  EXPECT_THAT(refusal("1 PINHOLE 752 480 458 457 367 248\n2 PINHOLE 752 480 458 457 367 248\n"),
              HasSubstr("has 2 cameras: 1, 2, without relative poses"));
  EXPECT_THAT(refusal("458 457\n"), HasSubstr("is not a YAML mapping"));
}

TEST_F(OtherCalibrations, ReadKitti) {
  const std::string text = "P0: 718 0 607 0 0 718 185 0 0 0 1 0\nP1: 718 0 607 -386 0 718 185 0 0 0 1 0\n";
  const Calibration kitti = read("calib.txt", text).calibration;
  EXPECT_EQ(kitti.left, (Camera{CameraModel::pinhole, 0, 0, 718.0, 718.0, 607.0, 185.0, {}}));
  ASSERT_TRUE(kitti.right);
  EXPECT_THAT(kitti.right->right_from_left.translation, PointNear(Eigen::Vector3d(-386.0 / 718.0, 0.0, 0.0), 1e-9));
}

TEST_F(OtherCalibrations, ReadDepthaiWithItsChainOfSockets) {
  const auto device = [](const std::string& socket, const std::string& to, const std::string& x) {
    return "[" + socket +
           ", {\"cameraType\": 0, \"width\": 752, \"height\": 480, \"intrinsicMatrix\": [[458, 0, 367], [0, "
           "457, 248], [0, 0, 1]], \"distortionCoeff\": [0.5, -0.1, 0.0002, 0.00002, 0.001, 0.8, -0.1, 0.002, 0, 0, 0, "
           "0, "
           "0, 0], \"extrinsics\": {\"toCameraSocket\": " +
           to + ", \"rotationMatrix\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"translation\": {\"x\": " + x +
           ", \"y\": 0.0, \"z\": 0.0}}}]";
  };
  const std::string rest = "], \"stereoRectificationData\": {\"leftCameraSocket\": 1, \"rightCameraSocket\": 2}}";
  const CalibrationReading reading =
      read("oak.json", "{\"cameraData\": [" + device("0", "-1", "0") + ", " + device("1", "0", "-3.5") + ", " +
                           device("2", "0", "4.0") + rest);
  EXPECT_EQ(reading.format, "DepthAI");
  EXPECT_LT(difference_to_opencv(reading.calibration.left, {458, 457, 367, 248},
                                 {0.5, -0.1, 2e-4, 2e-5, 0.001, 0.8, -0.1, 0.002}),
            kMostPixels);
  ASSERT_TRUE(reading.calibration.right);
  EXPECT_THAT(reading.calibration.right->right_from_left.translation,
              PointNear(Eigen::Vector3d(-0.075, 0.0, 0.0), 1e-9));
}

TEST_F(OtherCalibrations, ReadZedOfTheImageSize) {
  std::string text;
  for (const auto& [name, scale] : {std::pair("FHD", 2), std::pair("VGA", 1)}) {
    for (const std::string side : {"LEFT", "RIGHT"}) {
      text += "[" + side + "_CAM_" + name + "]\nfx=" + std::to_string(350 * scale) +
              "\nfy=" + std::to_string(350 * scale) + "\ncx=" + std::to_string(330 * scale) +
              "\ncy=" + std::to_string(180 * scale) + "\nk1=-0.17\nk2=0.02\n";
    }
  }
  text += "[STEREO]\nBaseline=120\nTY=2\nTZ=0\nRX_FHD=0\nCV_FHD=0.01\nRZ_FHD=0\nRX_VGA=0\nCV_VGA=0.01\nRZ_VGA=0\n";
  const CalibrationReading first = read("SN1.conf", text);
  EXPECT_EQ(first.calibration.left.width, 1920);
  EXPECT_THAT(first.notes, Contains(HasSubstr("1920x1080 672x376; --size selects one")));
  const Calibration small = read_calibration_file(folder_ / "SN1.conf", {}, std::pair(672, 376)).calibration;
  EXPECT_EQ(small.left, (Camera{CameraModel::radial_tangential, 672, 376, 350.0, 350.0, 330.0, 180.0, {-0.17, 0.02}}));
  // As the SDK uses it for rectification: the vector to the right camera, and a rotation of points into it.
  EXPECT_THAT(small.right->right_from_left,
              PoseNear(Pose{rotation_exp({0.0, 0.01, 0.0}), {-0.12, -0.002, 0.0}}, 1e-9, 1e-9));
}

TEST_F(OtherCalibrations, OfOpencvNeedNoSpaceAfterAName) {
  EXPECT_EQ(
      camera("%YAML:1.0\nimage_width:752\nimage_height:480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n"
             "   data:" +
             kMatrix + "\ndistortion_coefficients: !!opencv-matrix\n   data:" + kLens + "\n"),
      kExpected);
}

TEST_F(OtherCalibrations, WithTheRectificationOfAnotherCameraAreRefused) {
  std::string text = "%YAML:1.0\nCamera.fx: 800\nCamera.fy: 800\nCamera.cx: 600\nCamera.cy: 400\nCamera.bf: 60\n";
  for (const std::string side : {"LEFT", "RIGHT"}) {
    text += side + ".width: 752\n" + side + ".height: 480\n" + side + ".K: " + kMatrix + "\n" + side + ".D: " + kLens +
            "\n" + side + ".R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n" + side +
            ".P: [435, 0, 367, 0, 0, 435, 252, 0, 0, 0, 1, 0]\n";
  }
  EXPECT_THAT(refusal(text), AllOf(HasSubstr("LEFT.P: has another focal length than Camera.fx"), HasSubstr("delete")));
}

}  // namespace
}  // namespace byre
