// Cameras of MATLAB and of photogrammetry: their projection is compared with the published formula of the program.

#include "byre/calibration_file.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class PhotogrammetryFormats : public TestFolder {
 protected:
  CalibrationReading read(const std::string& text, const std::string& name = "camera.txt") const {
    write(name, text);
    return read_calibration_file(folder_ / name);
  }
  std::string refusal(const std::string& text) const {
    return error_of([&] { read(text); });
  }
};

// Largest difference of a camera to a projection of x = X/Z, y = Y/Z, over the pixels of its image.
double difference(const Camera& camera, const std::function<Eigen::Vector2d(double x, double y)>& published) {
  constexpr int kSteps = 16;
  double largest = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const auto ray = camera.bearing({(camera.width - 1.0) * i / kSteps, (camera.height - 1.0) * j / kSteps});
      EXPECT_TRUE(ray);
      if (!ray) continue;
      const auto own = camera.project(*ray);
      EXPECT_TRUE(own);
      if (own) largest = std::max(largest, (*own - published(ray->x() / ray->z(), ray->y() / ray->z())).norm());
    }
  }
  return largest;
}

constexpr double kMostDifference = 0.01;  // pixels

// ---- OpenSfM: normalised image coordinates, (u + 0.5 - width / 2) / max(width, height)

Eigen::Vector2d opensfm_pixel(const Camera& camera, double x, double y) {
  const double size = std::max(camera.width, camera.height);
  return {x * size + 0.5 * camera.width - 0.5, y * size + 0.5 * camera.height - 0.5};
}

TEST_F(PhotogrammetryFormats, ReadOpensfmBrown) {
  const CalibrationReading reading =
      read(R"({"v2 maker model 4000 3000 brown 0.7": {"projection_type": "brown", "width": 4000, "height": 3000,
               "focal_x": 0.7, "focal_y": 0.71, "c_x": 0.01, "c_y": -0.004, "k1": -0.1, "k2": 0.06, "k3": -0.01,
               "p1": -0.0009, "p2": 0.0003}})");
  EXPECT_EQ(reading.format, "OpenSfM");
  const Camera& camera = reading.calibration.left;
  EXPECT_LT(difference(camera,
                       [&](double x, double y) {
                         const double r2 = x * x + y * y;
                         const double radial = 1.0 + r2 * (-0.1 + r2 * (0.06 + r2 * -0.01));
                         const double p1 = -0.0009, p2 = 0.0003;
                         const double u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
                         const double v = y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y);
                         return opensfm_pixel(camera, 0.7 * u + 0.01, 0.71 * v - 0.004);
                       }),
            kMostDifference);
}

TEST_F(PhotogrammetryFormats, ReadOpensfmWithOneFocalLength) {
  const auto text = [](const std::string& type, const std::string& focal) {
    return R"([{"cameras": {"v2": {"projection_type": ")" + type + R"(", "width": 3000, "height": 4000, "focal": )" +
           focal + R"(, "k1": -0.05, "k2": 0.01}}}])";
  };
  const Camera perspective = read(text("perspective", "0.85")).calibration.left;
  EXPECT_LT(difference(perspective,
                       [&](double x, double y) {
                         const double r2 = x * x + y * y;
                         const double scale = 0.85 * (1.0 + r2 * (-0.05 + r2 * 0.01));
                         return opensfm_pixel(perspective, scale * x, scale * y);
                       }),
            kMostDifference);
  const Camera fisheye = read(text("fisheye", "0.5")).calibration.left;
  EXPECT_LT(difference(fisheye,
                       [&](double x, double y) {
                         const double r = std::hypot(x, y), angle = std::atan(r), a2 = angle * angle;
                         const double scale = r == 0.0 ? 0.5 : 0.5 * angle / r * (1.0 + a2 * (-0.05 + a2 * 0.01));
                         return opensfm_pixel(fisheye, scale * x, scale * y);
                       }),
            kMostDifference);
}

TEST_F(PhotogrammetryFormats, ReadOpensfmFisheyeOfOpencvAndRefuseOthers) {
  const std::string start = R"({"a": {"projection_type": ")";
  const std::string rest =
      R"(", "width": 1000, "height": 1000, "focal_x": 0.3, "focal_y": 0.3, "c_x": 0, "c_y": 0, "k1": 0.1, "k2": 0.02,
         "k3": 0.003, "k4": 0.0004, "p1": 0.001, "p2": 0.002)";
  const Camera fisheye = read(start + "fisheye_opencv" + rest + "}}").calibration.left;
  EXPECT_EQ(fisheye, (Camera{CameraModel::equidistant, 1000, 1000, 300, 300, 499.5, 499.5, {0.1, 0.02, 0.003, 4e-4}}));
  EXPECT_EQ(read(start + "fisheye62" + rest + "}}").calibration.left.distortion[3], 0.002);
  EXPECT_THAT(refusal(start + "fisheye62" + rest + R"(, "k5": 0.1}})"), HasSubstr("a.k5: coefficients above k4"));
  EXPECT_THAT(refusal(start + "spherical" + rest + "}}"),
              AllOf(HasSubstr("a.projection_type: \"spherical\" is not supported"), HasSubstr("fisheye_opencv")));
  EXPECT_THAT(refusal(R"({"a": {"projection_type": "brown", "width": 9, "height": 9}})"),
              HasSubstr("a.focal_x: is missing"));
}

TEST_F(PhotogrammetryFormats, ReportFocalLengthsThatOpensfmGuessed) {
  const auto notes_of = [&](const std::string& k1) {
    return read(R"({"a": {"projection_type": "perspective", "width": 900, "height": 600, "focal": 0.85, "k1": )" + k1 +
                R"(, "k2": 0}})")
        .notes;
  };
  EXPECT_THAT(notes_of("0.0"), Contains(HasSubstr("not a calibration")));
  EXPECT_TRUE(notes_of("0.1").empty());
}

// ---- Metashape: u = 0.5 width + cx + f x' + b1 x' + b2 y', with the centre of the first pixel at 0.5, 0.5

struct MetashapeLens {
  double f, cx, cy, b1, b2, k1, k2, k3, k4, p1, p2;
};

Eigen::Vector2d metashape_pixel(const Camera& camera, const MetashapeLens& lens, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * (lens.k3 + r2 * lens.k4)));
  const double a = x * radial + lens.p1 * (r2 + 2 * x * x) + 2 * lens.p2 * x * y;
  const double b = y * radial + lens.p2 * (r2 + 2 * y * y) + 2 * lens.p1 * x * y;
  return {0.5 * camera.width + lens.cx + a * lens.f + a * lens.b1 + b * lens.b2 - 0.5,
          0.5 * camera.height + lens.cy + b * lens.f - 0.5};
}

const std::string kMetashape =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration>\n  <projection>frame</projection>\n"
    "  <width>1920</width>\n  <height>1080</height>\n  <f>1430.15</f>\n  <cx>-24.1</cx>\n  <cy>17.5</cy>\n"
    "  <b1>1.5</b1>\n  <k1>-0.118</k1>\n  <k2>0.29</k2>\n  <k3>-0.1</k3>\n  <k4>0.02</k4>\n"
    "  <p1>0.00033</p1>\n  <p2>0.00182</p2>\n  <date>2017-11-14T23:30:12Z</date>\n</calibration>\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST_F(PhotogrammetryFormats, ReadMetashapeWithFourRadialCoefficients) {
  const CalibrationReading reading = read(kMetashape);
  EXPECT_EQ(reading.format, "Metashape");
  EXPECT_THAT(reading.notes, Contains(HasSubstr("k4: converted to the rational model")));
  const Camera& camera = reading.calibration.left;
  const MetashapeLens lens{1430.15, -24.1, 17.5, 1.5, 0, -0.118, 0.29, -0.1, 0.02, 0.00033, 0.00182};
  const auto published = [&](double x, double y) { return metashape_pixel(camera, lens, x, y); };
  EXPECT_LT(difference(camera, published), kMostDifference);
}

TEST_F(PhotogrammetryFormats, ReadMetashapeWithTangentialCoefficientsExchanged) {
  const CalibrationReading reading = read(replaced(kMetashape, "<k4>0.02</k4>", ""));
  const Camera& camera = reading.calibration.left;
  EXPECT_EQ(camera.model, CameraModel::radial_tangential);
  EXPECT_EQ(camera.distortion[2], 0.00182);
  const MetashapeLens lens{1430.15, -24.1, 17.5, 1.5, 0, -0.118, 0.29, -0.1, 0, 0.00033, 0.00182};
  const auto published = [&](double x, double y) { return metashape_pixel(camera, lens, x, y); };
  EXPECT_LT(difference(camera, published), kMostDifference);
}

TEST_F(PhotogrammetryFormats, ReadFisheyesOfMetashape) {
  const Camera camera = read(replaced(kMetashape, "frame", "fisheye")).calibration.left;
  EXPECT_LT(difference(camera,
                       [&](double x, double y) {
                         const double r = std::hypot(x, y), scale = r == 0.0 ? 1.0 : std::atan(r) / r;
                         const MetashapeLens lens{1430.15, -24.1, 17.5, 1.5,     0,      -0.118,
                                                  0.29,    -0.1,  0.02, 0.00033, 0.00182};
                         return metashape_pixel(camera, lens, scale * x, scale * y);
                       }),
            kMostDifference);
}

TEST_F(PhotogrammetryFormats, ReadTheAdjustedCalibrationOfAChunk) {
  const std::string size = "<resolution width=\"2256\" height=\"1504\"/>";
  const std::string text =
      "<document version=\"1.5.0\"><chunk><sensors><sensor id=\"0\" type=\"frame\">" + size +
      "<property name=\"fixed\" value=\"0\"/><property name=\"layer_index\" value=\"0\"/>"
      "<calibration type=\"frame\" class=\"initial\">" +
      size + "<f>1900</f></calibration><calibration type=\"frame\" class=\"adjusted\">" + size +
      "<f>1940</f><cx>13</cx><cy>9</cy><k1>-0.1</k1></calibration></sensor></sensors></chunk></document>";
  EXPECT_EQ(read(text).calibration.left,
            (Camera{CameraModel::radial_tangential, 2256, 1504, 1940, 1940, 1140.5, 760.5, {-0.1}}));
}

// The formula of Agisoft Lens, which has focal lengths fx and fy, the principal point from the corner, and p1 and p2 as
// in OpenCV.
TEST_F(PhotogrammetryFormats, ReadTheFirstFilesOfPhotoscan) {
  const std::string text =
      "<calibration><projection>frame</projection><width>800</width><height>600</height><fx>700</fx><fy>701</fy>"
      "<cx>410</cx><cy>290</cy><skew>0.01</skew><k1>-0.1</k1><k2>0.02</k2><p1>0.001</p1><p2>0.002</p2></calibration>";
  const Camera camera = read(text).calibration.left;
  EXPECT_LT(difference(camera,
                       [&](double x, double y) {
                         const double r2 = x * x + y * y, radial = 1.0 + r2 * (-0.1 + r2 * 0.02);
                         const double a = x * radial + 0.002 * (r2 + 2 * x * x) + 2 * 0.001 * x * y;
                         const double b = y * radial + 0.001 * (r2 + 2 * y * y) + 2 * 0.002 * x * y;
                         return Eigen::Vector2d(410 + a * 700 + b * 0.01 - 0.5, 290 + b * 701 - 0.5);
                       }),
            kMostDifference);
}

TEST_F(PhotogrammetryFormats, RefuseWhatMetashapeHasBeyondTheModels) {
  EXPECT_THAT(refusal(replaced(kMetashape, "<f>1430.15</f>", "<b1>3</b1>")),
              HasSubstr("is not a supported calibration file"));
  EXPECT_THAT(refusal(replaced(kMetashape, "<b1>1.5</b1>", "<b2>15</b2>")), HasSubstr("without skew"));
  EXPECT_THAT(refusal(replaced(kMetashape, "</calibration>", "<p3>1</p3></calibration>")),
              HasSubstr("calibration.p3: tangential coefficients above p2"));
  EXPECT_THAT(refusal(replaced(kMetashape, "frame", "spherical")), HasSubstr("projection: \"spherical\""));
  EXPECT_THAT(refusal(replaced(kMetashape, "<width>1920</width>", "")), HasSubstr("calibration.width: is missing"));
  EXPECT_THAT(refusal(replaced(kMetashape, "</calibration>", "")), HasSubstr("is not valid XML"));
}

// ---- MATLAB: x = fx a + s b + cx, with the centre of the first pixel at 1, 1

const std::string kMatlabCamera =
    R"({"ImageSize": [480, 752], "RadialDistortion": [-0.28, 0.07], "TangentialDistortion": [0.0002, 0.00002],
        "IntrinsicMatrix": [[458, 0, 0], [0, 457, 0], [368, 249, 1]], "WorldUnits": "millimeters"})";
const Camera kOfMatlab{CameraModel::radial_tangential, 752, 480, 458, 457, 367, 248, {-0.28, 0.07, 2e-4, 2e-5}};

TEST_F(PhotogrammetryFormats, ReadMatlabStructuresCountedFromOne) {
  const CalibrationReading reading = read(kMatlabCamera);
  EXPECT_EQ(reading.format, "MATLAB");
  EXPECT_EQ(reading.calibration.left, kOfMatlab);
  EXPECT_THAT(reading.notes, Contains(HasSubstr("counted from 1")));
  const Camera from_k = read(
                            "ImageSize: [480, 752]\nK: [[458, 0, 368], [0, 457, 249], [0, 0, 1]]\n"
                            "RadialDistortion: [-0.28, 0.07, 0]\nTangentialDistortion: [0.0002, 0.00002]\n")
                            .calibration.left;
  EXPECT_EQ(from_k, kOfMatlab);
}

TEST_F(PhotogrammetryFormats, ReadScriptsOfMatlab) {
  const std::string matrix = "[458 0 0; 0 457 0;\n   368 249 1]";
  const std::string rest = "radialDistortion = [-0.28 0.07];  % two\ntangentialDistortion = [0.0002, 0.00002];\n";
  const std::string size = "imageSize = [480 752];\n";
  EXPECT_EQ(read("clear all; close all\nIntrinsicMatrix = " + matrix + ";\n" + rest + size).calibration.left,
            kOfMatlab);
  EXPECT_EQ(read("params = cameraParameters('IntrinsicMatrix', " + matrix +
                 ", ...\n  'RadialDistortion', [-0.28 0.07], 'TangentialDistortion', [0.0002 0.00002], ...\n"
                 "  'ImageSize', [480 752]);\n")
                .calibration.left,
            kOfMatlab);
  EXPECT_EQ(read("IntrinsicMatrix = [458 0 368; 0 457 249; 0 0 1]';\n" + rest + size).calibration.left, kOfMatlab);
}

TEST_F(PhotogrammetryFormats, ReadStereoParametersOfMatlab) {
  const std::string pair = "{\"CameraParameters1\": " + kMatlabCamera + ", \"CameraParameters2\": " + kMatlabCamera;
  const CalibrationReading reading = read(pair + R"(, "RotationOfCamera2": [[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]],
                      "TranslationOfCamera2": [-110, 2, 3]})");
  ASSERT_TRUE(reading.calibration.right);
  // Rows are multiplied from the left: [X Y Z]_2 = [X Y Z]_1 R + t.
  EXPECT_THAT(reading.calibration.right->right_from_left * Eigen::Vector3d(1.0, 2.0, 5.0),
              PointNear(Eigen::Vector3d(0.8 - 3.0 - 0.110, 2.0 + 0.002, 0.6 + 4.0 + 0.003), 1e-9));
  const Calibration posed = read(pair + R"(, "PoseCamera2": {"R": [[0.8, 0, -0.6], [0, 1, 0], [0.6, 0, 0.8]],
                                                            "Translation": [-110, 2, 3]}})")
                                .calibration;
  ASSERT_TRUE(posed.right);
  EXPECT_THAT(posed.right->right_from_left, PoseNear(reading.calibration.right->right_from_left, 1e-9, 1e-9));
  EXPECT_THAT(refusal(pair + "}"), HasSubstr("RotationOfCamera2: is missing"));
}

TEST_F(PhotogrammetryFormats, RefuseMatlabCamerasThatAreIncomplete) {
  EXPECT_THAT(refusal(replaced(kMatlabCamera, "[-0.28, 0.07]", "[1, 2, 3, 4]")),
              HasSubstr("RadialDistortion: has 4 numbers instead of 2"));
  EXPECT_THAT(refusal(replaced(kMatlabCamera, "[368, 249, 1]", "[368, 249]")),
              HasSubstr("IntrinsicMatrix: has 8 numbers instead of 9"));
  EXPECT_THAT(refusal("K: [458, 0, 367, 0, 457, 248, 0, 0, 1]\nradial_part: [0.1, 0.2]\n"),
              HasSubstr("radial_part: is a distortion of an unknown form"));
}

// ---- Bouguet's toolbox: pixels count from 0, coefficients as in OpenCV

TEST_F(PhotogrammetryFormats, ReadResultsOfBouguetsToolbox) {
  const CalibrationReading reading = read(
      "% Intrinsic and Extrinsic Camera Parameters\n\n%-- Focal length:\nfc = [ 458.0 ; 457.0 ];\n\n"
      "%-- Principal point:\ncc = [ 367.0 ; 248.0 ];\n\nalpha_c = 0.000000;\n\n"
      "kc = [ -0.28 ; 0.07 ; 0.0002 ; 0.00002 ; 0.0 ];\n\nfc_error = [ 0.3 ; 0.4 ];\n\nnx = 752;\nny = 480;\n"
      "omc_1 = [ 1.65 ; 1.64 ; -0.67 ];\nTc_1  = [ NaN ; NaN ; NaN ];\n");
  EXPECT_EQ(reading.format, "Bouguet's toolbox");
  EXPECT_EQ(reading.calibration.left, kOfMatlab);
}

TEST_F(PhotogrammetryFormats, ReadStereoResultsOfBouguetsToolbox) {
  std::string text;
  for (const std::string side : {"left", "right"}) {
    text += "Intrinsic parameters of " + side + " camera:\n\nFocal Length:          fc_" + side +
            " = [ 458.0   457.0 ] \xC2\xB1 [ 0.83   0.84 ]\nPrincipal point:       cc_" + side +
            " = [ 367.0   248.0 ] \xC2\xB1 [ 1.2   1.2 ]\nSkew:             alpha_c_" + side +
            " = [ 0.00000 ] \xC2\xB1 [ 0.0  ]   => angle of pixel axes = 90.0 \xC2\xB1 0.0 degrees\n" +
            "Distortion:            kc_" + side +
            " = [ -0.28   0.07   0.0002   0.00002  0.00000 ] \xC2\xB1 [ 0.006 ]\n";
  }
  const std::string pose =
      "Rotation vector:             om = [ 0.0   0.01  0.0 ] \xC2\xB1 [ 0.002   0.003  0.0002 ]\n"
      "Translation vector:           T = [ -99.8   1.1   0.05 ] \xC2\xB1 [ 0.1   0.1  0.4 ]\n";
  const Calibration pair = read(text + pose).calibration;
  ASSERT_TRUE(pair.right);
  EXPECT_EQ(pair.right->camera.fx, 458.0);
  EXPECT_THAT(pair.right->right_from_left,
              PoseNear(Pose{rotation_exp({0.0, 0.01, 0.0}), {-0.0998, 0.0011, 0.00005}}, 1e-9, 1e-9));
  EXPECT_THAT(refusal(text), HasSubstr("om, T: is missing"));
}

// ---- Others

TEST_F(PhotogrammetryFormats, ReadPairsOfMiddlebury) {
  const CalibrationReading reading = read(
      "cam0=[3979.9 0 1244.7; 0 3979.9 1019.5; 0 0 1]\ncam1=[3979.9 0 1369.1; 0 3979.9 1019.5; 0 0 1]\n"
      "doffs=124.343\nbaseline=193.001\nwidth=2964\nheight=1988\nndisp=270\n");
  EXPECT_EQ(reading.format, "Middlebury");
  EXPECT_EQ(reading.calibration.left, (Camera{CameraModel::pinhole, 2964, 1988, 3979.9, 3979.9, 1244.7, 1019.5, {}}));
  ASSERT_TRUE(reading.calibration.right);
  EXPECT_EQ(reading.calibration.right->camera.cx, 1369.1);
  EXPECT_NEAR(reading.calibration.right->right_from_left.translation.x(), -0.193001, 1e-12);
}

TEST_F(PhotogrammetryFormats, ReadOpenmvg) {
  const auto text = [](const std::string& name, const std::string& lens) {
    return R"({"sfm_data_version": "0.3", "views": [], "intrinsics": [{"key": 0, "value": {"polymorphic_name": ")" +
           name + R"(", "ptr_wrapper": {"data": {"width": 1280, "height": 720, "focal_length": 1000.0,
                     "principal_point": [640.0, 360.0])" +
           lens + "}}}}]}";
  };
  EXPECT_EQ(read(text("pinhole_brown_t2", R"(, "disto_t2": [0.1, 0.2, 0.3, 0.001, 0.002])")).calibration.left,
            (Camera{CameraModel::radial_tangential, 1280, 720, 1000, 1000, 640, 360, {0.1, 0.2, 0.001, 0.002, 0.3}}));
  EXPECT_EQ(read(text("pinhole_radial_k1", R"(, "disto_k1": [0.1])")).calibration.left.distortion[0], 0.1);
  EXPECT_EQ(read(text("fisheye", R"(, "fisheye": [0.1, 0.2, 0.3, 0.4])")).calibration.left.model,
            CameraModel::equidistant);
  EXPECT_THAT(refusal(text("spherical", "")), HasSubstr("\"spherical\" is not supported"));
}

}  // namespace
}  // namespace byre
