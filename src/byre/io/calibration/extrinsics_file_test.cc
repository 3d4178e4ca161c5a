#include "byre/extrinsics_file.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A camera that looks ahead: x to the right, y down, z ahead.
Pose forward_camera(const Eigen::Vector3d& position) {
  Eigen::Matrix3d axes;
  axes << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return {Eigen::Quaterniond(axes), position};
}

class ExtrinsicsFiles : public TestFolder {
 protected:
  Extrinsics yaml(const std::string& content) const { return read_as("robot.yaml", content); }
  std::string yaml_error(const std::string& content) const {
    return error_of([&] { yaml(content); });
  }
  Extrinsics urdf(const std::string& content, const ExtrinsicsFrames& frames = {}) const {
    return read_as("robot.urdf", "<?xml version=\"1.0\"?>\n<robot name=\"r\">\n" + content + "</robot>\n", frames);
  }
  std::string urdf_error(const std::string& content, const ExtrinsicsFrames& frames = {}) const {
    return error_of([&] { urdf(content, frames); });
  }
  Extrinsics read_as(const std::string& name, const std::string& content, const ExtrinsicsFrames& frames = {}) const {
    write(name, content);
    return read_extrinsics(folder_ / name, frames);
  }
};

const Pose kAhead = forward_camera({0.4, 0.1, 0.9});
constexpr const char* kMatrixAhead = "base_from_camera: [[0, 0, 1, 0.4], [-1, 0, 0, 0.1], [0, -1, 0, 0.9]";

TEST_F(ExtrinsicsFiles, ReadEveryFormOfAPose) {
  const std::string translation = "base_from_camera:\n  translation_m: [0.4, 0.1, 0.9]\n";
  for (const std::string& content :
       {std::string(kMatrixAhead) + "]\n", std::string(kMatrixAhead) + ", [0, 0, 0, 1]]\n",
        translation + "  rotation_xyzw: [-0.5, 0.5, -0.5, 0.5]\n", translation + "  rpy_deg: [-90, 0, -90]\n",
        translation + "  matrix: [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]\n",
        translation + "  rpy_deg: [0, 0, 0]\ncamera_axes: body\n",
        std::string("base_from_camera:\n  matrix: [0, 0, 1, 0.4, -1, 0, 0, 0.1, 0, -1, 0, 0.9]\n"),
        std::string("{\"base_from_camera\": {\"rows\": 4, \"data\": [0, 0, 1, 0.4, -1, 0, 0, 0.1, 0, -1, 0, 0.9, 0, 0, "
                    "0, 1]}}")}) {
    const Extrinsics extrinsics = yaml(content);
    ASSERT_TRUE(extrinsics.camera) << content;
    EXPECT_THAT(extrinsics.camera->base_from_sensor, PoseNear(kAhead, 1e-12, 1e-7)) << content;
    EXPECT_EQ(extrinsics.camera->sigma_m, SensorMounting{}.sigma_m);
    EXPECT_EQ(extrinsics.camera->sigma_rad, SensorMounting{}.sigma_rad);
    EXPECT_FALSE(extrinsics.imu);
    EXPECT_EQ(extrinsics.wheel_scale, 1.0);
    EXPECT_FALSE(extrinsics.wheel_delay);
  }
}

TEST_F(ExtrinsicsFiles, RotateAboutFixedAxesInTheOrderOfAUrdf) {
  const Extrinsics extrinsics = yaml(
      "base_from_imu: {translation_m: [0, 0, 0], rpy_deg: [90, 0, 90], sigma_m: 0.5, sigma_deg: 9}\n"
      "wheels: {scale: 1.02, scale_sigma: 0.01, delay_s: -0.03}\n");
  ASSERT_TRUE(extrinsics.imu);
  // Roll turns y to z, then yaw turns x to y.
  EXPECT_THAT(extrinsics.imu->base_from_sensor * Eigen::Vector3d::UnitY(), PointNear(Eigen::Vector3d(0, 0, 1), 1e-12));
  EXPECT_THAT(extrinsics.imu->base_from_sensor * Eigen::Vector3d::UnitX(), PointNear(Eigen::Vector3d(0, 1, 0), 1e-12));
  EXPECT_EQ(extrinsics.imu->sigma_m, 0.5);
  EXPECT_NEAR(extrinsics.imu->sigma_rad, 9.0 * kDegree, 1e-12);
  EXPECT_FALSE(extrinsics.camera);
  EXPECT_EQ(extrinsics.wheel_scale, 1.02);
  EXPECT_EQ(extrinsics.wheel_scale_sigma, 0.01);
  EXPECT_EQ(extrinsics.wheel_delay, -0.03);
}

TEST_F(ExtrinsicsFiles, ReadTheFieldsFromACalibrationFile) {
  const std::string calibration =
      "cam0:\n  camera_model: pinhole\n  intrinsics: [461, 460, 362, 246]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [752, 480]\nsite: barn 3\n";
  const std::string matrix = std::string(kMatrixAhead) + "]\n";
  EXPECT_THAT(yaml(calibration + matrix).camera->base_from_sensor, PoseNear(kAhead, 1e-12, 1e-7));
  EXPECT_THAT(yaml_error(calibration + matrix + "base_from_inu: 3\n"),
              AllOf(HasSubstr("base_from_inu: is not a field of extrinsics"), HasSubstr("base_from_imu")));
  EXPECT_THAT(yaml_error(calibration), HasSubstr("has no extrinsics of a robot"));
  EXPECT_THAT(yaml_error("site: barn 3\n" + matrix), HasSubstr("site: is not a field of extrinsics"));
}

TEST_F(ExtrinsicsFiles, RejectInvalidFields) {
  const std::string matrix = std::string(kMatrixAhead) + "]\n";
  const auto group = [](const std::string& fields) { return "base_from_camera: {" + fields + "}\n"; };
  const std::pair<std::string, std::string> faults[] = {
      {matrix + matrix, "base_from_camera: is given twice"},
      {matrix + "wheels:\n", "wheels: is empty"},
      {matrix + "wheels: {delay: 0.1}\n",
       "wheels.delay: is not a field of extrinsics (fields: scale, scale_sigma, "
       "delay_s)"},
      {matrix + "wheels: {scale: 1000}\n", "wheels.scale: is 1000, outside 0.5 to 2"},
      {matrix + "wheels: {delay_s: 30}\n", "wheels.delay_s: is above 1 s (give seconds)"},
      {matrix + "wheels: {scale_sigma: 0}\n", "wheels.scale_sigma: is not a positive number"},
      {matrix + "camera_axes: ros\n", "camera_axes: \"ros\" is unknown (give optical or body)"},
      {"base_from_camera: [[0, 0, 1.01, 0.4], [-1, 0, 0, 0.1], [0, -1, 0, 0.9]]\n", "the 3x3 part is not a rotation"},
      {"base_from_camera: [[0, 0, 1, .nan], [-1, 0, 0, 0.1], [0, -1, 0, 0.9]]\n", "not a number"},
      {"base_from_camera: [0, 0, 1]\n", "has 3 numbers instead of 16"},
      {group("translation_m: [0, 0, 0]"),
       "has 0 rotations instead of one (give one of rotation_xyzw, rpy_deg, matrix)"},
      {group("rpy_deg: [0, 0, 0]"), "base_from_camera.translation_m: is missing"},
      {group("translation_m: [0, 0, 0], rpy_deg: [-90, 0, -90], rotation_xyzw: [0, 0, 0, 1]"), "has 2 rotations"},
      {group("translation_m: [0, 0, 0], rotation_xyzw: [-0.5, 0.5, -0.5, 0.51]"), "has the length 1.005 instead of 1"},
      {group("translation_m: [0, 0, 0], matrix: [1, 0, 0, 0, 1, 0, 0, 0, -1]"), "matrix: is not a rotation"},
      {group("translation_m: [0, 0, 0], matrix: [0, 0, 1, 0.4, -1, 0, 0, 0.1, 0, -1, 0, 0.9]"),
       "has a translation, as translation_m has"},
      {group("translation_m: [400, 0, 900], rpy_deg: [-90, 0, -90]"),
       "base_from_camera: is 984.9 m from the base, which is too far for a robot (give metres; are these "
       "millimetres?)"},
      {group("translation_m: [0, 0, 0], rpy_deg: [-90, 0, -90], sigma_m: 0"), "sigma_m: is not a positive number"},
      {group("translation_m: [0, 0, 0], rpy_deg: [-90, 0, -90], sigma_m: -1"), "sigma_m: is not a positive number"},
      {group("translation_m: [0, 0, 0], rpy_deg: [-90, 0, -90], sigma_deg: 200"), "sigma_deg: is above 180"},
      {group("translation: [0, 0, 0]"), "base_from_camera.translation: is not a field of extrinsics"}};
  for (const auto& [content, fault] : faults) EXPECT_THAT(yaml_error(content), HasSubstr(fault)) << content;
  EXPECT_THAT(error_of([&] { read_extrinsics(folder_ / "absent.yaml"); }), HasSubstr("cannot be opened"));
  EXPECT_THAT(error_of([&] { read_extrinsics(folder_); }), HasSubstr("is a folder, but no bag"));
}

TEST_F(ExtrinsicsFiles, RequireTheAxesOfACameraThatLooksUp) {
  const std::string level = "base_from_camera: {translation_m: [0, 0, 1], rpy_deg: [0, 0, 0]}\n";
  EXPECT_THAT(yaml_error(level), AllOf(HasSubstr("has a vertical z axis"), HasSubstr("camera_axes: body")));
  EXPECT_THAT(yaml(level + "camera_axes: optical\n").camera->base_from_sensor,
              PoseNear(Pose{{1, 0, 0, 0}, {0, 0, 1}}, 1e-12, 1e-9));
  EXPECT_THAT(yaml(level + "camera_axes: body\n").camera->base_from_sensor,
              PoseNear(forward_camera({0, 0, 1}), 1e-12, 1e-7));
}

TEST_F(ExtrinsicsFiles, ReadBackWhatIsWritten) {
  Extrinsics extrinsics;
  extrinsics.camera = SensorMounting{{rotation_exp({0.3, -1.2, 0.7}), {1.0 / 3.0, -0.1, 1e-9}}, 0.013, 0.07};
  extrinsics.imu = SensorMounting{{rotation_exp({-2.0, 0.2, 0.1}), {0.0, 5.0, -0.25}}, 0.5, 3.0};
  extrinsics.wheel_scale = 1.0 / 1.03;
  extrinsics.wheel_scale_sigma = 0.004;
  extrinsics.wheel_delay = -0.031;
  for (const bool is_whole : {true, false}) {
    if (!is_whole) extrinsics.camera.reset(), extrinsics.imu.reset(), extrinsics.wheel_delay.reset();
    write_extrinsics(folder_ / "written.yaml", extrinsics);
    write_extrinsics(folder_ / "written.yaml", extrinsics);  // replaces its own file
    const Extrinsics read = read_extrinsics(folder_ / "written.yaml");
    ASSERT_EQ(read.camera.has_value(), is_whole);
    ASSERT_EQ(read.imu.has_value(), is_whole);
    EXPECT_EQ(read.wheel_scale, extrinsics.wheel_scale);
    EXPECT_EQ(read.wheel_scale_sigma, extrinsics.wheel_scale_sigma);
    EXPECT_EQ(read.wheel_delay, extrinsics.wheel_delay);
    if (!is_whole) continue;
    for (const auto& [one, other] : {std::pair(read.camera, extrinsics.camera), std::pair(read.imu, extrinsics.imu)}) {
      EXPECT_EQ(one->base_from_sensor.translation, other->base_from_sensor.translation);
      EXPECT_THAT(one->base_from_sensor, PoseNear(other->base_from_sensor, 0.0, 1e-7));
      EXPECT_EQ(one->sigma_m, other->sigma_m);
      EXPECT_NEAR(one->sigma_rad, other->sigma_rad, 1e-15);
    }
  }
}

TEST_F(ExtrinsicsFiles, WriteNothingThatIsRejectedWhenRead) {
  Extrinsics extrinsics;
  extrinsics.wheel_scale = 0.01;
  EXPECT_THAT(error_of([&] { write_extrinsics(folder_ / "written.yaml", extrinsics); }),
              HasSubstr("written.yaml: wheels.scale: is 0.01, outside 0.5 to 2"));
  extrinsics.wheel_scale = 1.0;
  extrinsics.imu.emplace().base_from_sensor.translation.x() = 300.0;
  EXPECT_THAT(error_of([&] { write_extrinsics(folder_ / "written.yaml", extrinsics); }), HasSubstr("is 300 m"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "written.yaml"));
}

// A link with the joint above it.
std::string link_below(const std::string& parent, const std::string& name, const std::string& origin,
                       const std::string& type = "fixed") {
  return "<link name=\"" + name + "\"/>\n<joint name=\"" + name + "_joint\" type=\"" + type + "\"><parent link=\"" +
         parent + "\"/><child link=\"" + name + "\"/>" + origin + "</joint>\n";
}

const std::string kBase = "<link name=\"base_link\"/>\n";
constexpr const char* kOptical = "<origin rpy=\"-1.5707963267948966 0 -1.5707963267948966\"/>";
constexpr const char* kMast = "<origin xyz=\"0.4 0.1 0.9\"/>";

std::string camera_on(const std::string& parent, const std::string& prefix = "") {
  return link_below(parent, prefix + "camera_link", kMast) +
         link_below(prefix + "camera_link", prefix + "camera_optical_frame", kOptical);
}

TEST_F(ExtrinsicsFiles, FollowFixedJointsOfAUrdf) {
  const Extrinsics extrinsics =
      urdf(kBase + camera_on("base_link") +
           link_below("camera_link", "imu_link", "<origin xyz=\"0 0 0.1\" rpy=\"0 0 0.5\"/>") +
           link_below("base_link", "wheel", "<origin xyz=\"${r} 0 0\"/>", "continuous"));
  ASSERT_TRUE(extrinsics.camera && extrinsics.imu);
  EXPECT_THAT(extrinsics.camera->base_from_sensor, PoseNear(kAhead, 1e-12, 1e-7));
  EXPECT_THAT(extrinsics.imu->base_from_sensor,
              PoseNear(Pose{rotation_exp({0, 0, 0.5}), {0.4, 0.1, 1.0}}, 1e-12, 1e-7));
}

TEST_F(ExtrinsicsFiles, FindFramesByConvention) {
  const std::string footprint = "<link name=\"base_footprint\"/>\n";
  EXPECT_TRUE(urdf(footprint + camera_on("base_footprint")).camera);
  // base_link is preferred, although the camera is not below it.
  const Extrinsics beside = urdf(footprint + link_below("base_footprint", "base_link", "<origin xyz=\"0 0 0.2\"/>") +
                                 camera_on("base_footprint"));
  EXPECT_THAT(beside.camera->base_from_sensor, PoseNear(forward_camera({0.4, 0.1, 0.7}), 1e-12, 1e-7));
  const std::string pair =
      kBase + camera_on("base_link", "right_") + link_below("base_link", "beam", kMast) + camera_on("beam", "left_");
  EXPECT_THAT(urdf(pair).camera->base_from_sensor, PoseNear(forward_camera({0.8, 0.2, 1.8}), 1e-12, 1e-7));
  EXPECT_THAT(urdf(pair, {.camera = "right_camera_optical_frame"}).camera->base_from_sensor,
              PoseNear(kAhead, 1e-12, 1e-7));
  EXPECT_THAT(urdf(pair, {.base = "beam"}).camera->base_from_sensor, PoseNear(kAhead, 1e-12, 1e-7));
  const std::string imus =
      kBase + camera_on("base_link") + link_below("base_link", "imu_a", "") + link_below("base_link", "imu_b", kMast);
  EXPECT_FALSE(urdf(imus).imu);
  EXPECT_THAT(urdf(imus, {.imu = "imu_b"}).imu->base_from_sensor,
              PoseNear(Pose{{1, 0, 0, 0}, {0.4, 0.1, 0.9}}, 0.0, 0.0));
}

TEST_F(ExtrinsicsFiles, ListCandidatesOfAmbiguousOrMissingFrames) {
  EXPECT_THAT(urdf_error(kBase + camera_on("base_link", "front_") + camera_on("base_link", "rear_")),
              AllOf(HasSubstr("has 2 optical frames"),
                    HasSubstr("one of front_camera_optical_frame, rear_camera_optical_frame")));
  EXPECT_THAT(urdf_error(kBase + link_below("base_link", "camera_link", kMast)),
              AllOf(HasSubstr("has no frame whose name ends in optical_frame"), HasSubstr("frames: camera_link")));
  EXPECT_THAT(urdf_error("<link name=\"chassis\"/>" + camera_on("chassis")),
              AllOf(HasSubstr("has neither base_link nor base_footprint"), HasSubstr("chassis")));
  EXPECT_THAT(urdf_error(kBase + camera_on("base_link"), {.camera = "camera"}),
              AllOf(HasSubstr("has no frame \"camera\""), HasSubstr("camera_link, camera_optical_frame")));
}

TEST_F(ExtrinsicsFiles, ReportTheConfusionOfBodyAndOpticalFrame) {
  EXPECT_THAT(urdf_error(kBase + camera_on("base_link"), {.camera = "camera_link"}),
              AllOf(HasSubstr("robot.urdf: camera_link: has a vertical z axis"),
                    HasSubstr("camera_optical_frame instead of camera_link")));
  EXPECT_TRUE(urdf(kBase + link_below("base_link", "ceiling_optical_frame", kMast)).camera) << "it may look up";
}

TEST_F(ExtrinsicsFiles, RejectJointsThatMove) {
  EXPECT_THAT(urdf_error(kBase + link_below("base_link", "pan", "", "revolute") + camera_on("pan")),
              HasSubstr("robot.urdf:5: joint \"pan_joint\": is revolute, not fixed"));
  EXPECT_THAT(
      urdf_error("<link name=\"lift\"/>" + link_below("lift", "base_link", "", "prismatic") + camera_on("base_link")),
      HasSubstr("joint \"base_link_joint\": is prismatic, not fixed, above the base \"base_link\""));
  EXPECT_THAT(urdf_error(kBase + link_below("base_link", "imu_link", "", "floating") + camera_on("base_link")),
              HasSubstr("joint \"imu_link_joint\": is floating, not fixed"));
}

TEST_F(ExtrinsicsFiles, RejectInvalidUrdfs) {
  const std::string sound = kBase + camera_on("base_link");
  const std::pair<std::string, std::string> faults[] = {
      {sound + "<xacro:include filename=\"x\"/>", "<xacro:include> (expand it first: xacro robot.urdf.xacro"},
      {kBase + link_below("base_link", "${side}_optical_frame", ""), "is xacro, not URDF: ${side}_optical_frame"},
      {kBase + link_below("base_link", "a_optical_frame", "<origin xyz=\"0 0\"/>"),
       "has no three finite numbers as xyz"},
      {kBase + link_below("base_link", "a_optical_frame", "<origin rpy=\"0 nan 0\"/>"), "finite numbers as rpy"},
      {kBase + link_below("base_link", "a_optical_frame", "<origin xyz=\"400 0 0\" rpy=\"1.57 0 0\"/>"), "millimetres"},
      {sound + kBase, "defines the link \"base_link\" again"},
      {sound + "<joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"gone\"/></joint>",
       "joint \"j\": names an unknown link \"gone\""},
      {sound + "<joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/></joint>", "<joint> has no <child>"},
      {sound + "<joint name=\"j\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"camera_link\"/></joint>",
       "gives the link \"camera_link\" a second parent"},
      {sound + "<joint name=\"j\" type=\"fixed\"><parent link=\"camera_link\"/><child link=\"base_link\"/></joint>",
       "has a cycle of transforms"},
      {sound + "<link/>", "<link> has no name"},
      {sound + "<link name=\"open\">", "is not valid XML"},
      {kBase + "<link name=\"far_optical_frame\"/>",
       "does not connect the frame \"far_optical_frame\" to \"base_link\""},
      {"", "has no links"}};
  for (const auto& [content, fault] : faults) EXPECT_THAT(urdf_error(content), HasSubstr(fault)) << content;
  const auto file_error = [&](const std::string& content) { return error_of([&] { read_as("robot.urdf", content); }); };
  EXPECT_THAT(file_error("<sdf version=\"1.6\"><model/></sdf>"), HasSubstr("is XML with the root <sdf>, not a URDF"));
  EXPECT_THAT(file_error("<!DOCTYPE r [<!ENTITY a \"b\">]>\n<robot name=\"r\"/>"), HasSubstr("defines entities"));
  std::string deep = "<robot name=\"r\">";
  for (int i = 0; i < 10000; ++i) deep += "<a>";
  EXPECT_THAT(file_error(deep), HasSubstr("nested too deep"));
  EXPECT_THAT(file_error("<robot>" + std::string(9 << 20, ' ')), HasSubstr("larger than 8 MB"));
}

TEST_F(ExtrinsicsFiles, ReadLongChainsOfLinks) {
  constexpr int kLinks = 20000;
  std::string content = kBase + link_below("base_link", "link_0", "");
  for (int i = 1; i < kLinks; ++i) {
    content += link_below("link_" + std::to_string(i - 1), "link_" + std::to_string(i), "<origin xyz=\"0.0001 0 0\"/>");
  }
  content += link_below("link_" + std::to_string(kLinks - 1), "a_optical_frame", kOptical);
  EXPECT_THAT(urdf(content).camera->base_from_sensor, PoseNear(forward_camera({1.9999, 0, 0}), 1e-9, 1e-7));
}

}  // namespace
}  // namespace byre
