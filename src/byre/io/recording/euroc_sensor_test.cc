#include "byre/io/recording/euroc.h"

#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kEurocSensor = R"(# General sensor definitions.
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, 0.5,
         1.0, 0.0, 0.0, -0.25,
         0.0, 0.0, 1.0, 2.0,
         0.0, 0.0, 0.0, 1.0]
resolution: [752, 480]
camera_model: pinhole
intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]
)";

class EurocSensorFile : public TestFolder {
 protected:
  // The sensor file with one piece of its text replaced.
  EurocSensor read(const std::string& old_text = "", const std::string& new_text = "") const {
    std::string text = kEurocSensor;
    if (const std::size_t at = text.find(old_text); at != std::string::npos)
      text.replace(at, old_text.size(), new_text);
    write("sensor.yaml", text);
    return read_euroc_sensor(folder_ / "sensor.yaml");
  }
};

TEST_F(EurocSensorFile, ReadsCameraAndBodyPose) {
  const EurocSensor sensor = read();
  EXPECT_EQ(sensor.camera.model, CameraModel::radial_tangential);
  EXPECT_EQ(sensor.camera.width, 752);
  EXPECT_EQ(sensor.camera.height, 480);
  EXPECT_EQ(sensor.camera.fx, 458.654);
  EXPECT_EQ(sensor.camera.cy, 248.375);
  EXPECT_THAT(sensor.camera.distortion,
              ElementsAre(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
  const Eigen::Vector3d point_in_body = sensor.body_from_camera * Eigen::Vector3d(1.0, 0.0, 0.0);
  EXPECT_LT((point_in_body - Eigen::Vector3d(0.5, 0.75, 2.0)).norm(), 1e-12);
}

TEST_F(EurocSensorFile, ReadsBackWhatItWrites) {
  EurocSensor sensor = read("radial-tangential", "equidistant");
  sensor.readout_time = 0.0125;
  write("written.yaml", write_euroc_sensor(sensor, 20.0, "recorded"));
  const EurocSensor again = read_euroc_sensor(folder_ / "written.yaml");
  EXPECT_EQ(again.camera, sensor.camera);
  EXPECT_EQ(again.readout_time, sensor.readout_time);
  EXPECT_LT((again.body_from_camera.translation - sensor.body_from_camera.translation).norm(), 1e-15);
  EXPECT_LT(again.body_from_camera.rotation.angularDistance(sensor.body_from_camera.rotation), 1e-12);
}

TEST_F(EurocSensorFile, AcceptsTheYamlDirectiveOfOpencv) {
  EXPECT_EQ(read("# General sensor definitions.", "%YAML:1.0").camera.width, 752);
  EXPECT_EQ(read("# General sensor definitions.", "%YAML:1.0\r\n---").camera.width, 752);
}

TEST_F(EurocSensorFile, ReadsOtherLensModels) {
  EXPECT_EQ(read("radial-tangential", "equidistant").camera.model, CameraModel::equidistant);
  EXPECT_EQ(read("radial-tangential", "none").camera.model, CameraModel::pinhole);
  EXPECT_EQ(read("1.76187114e-05]", "1e-05, 0.5]").camera.distortion[4], 0.5);
}

TEST_F(EurocSensorFile, ReportsTheInvalidField) {
  struct Case {
    std::string old_text, new_text, message;
  };
  const std::vector<Case> cases = {
      {"0.0, -1.0, 0.0, 0.5", "0.0, -1.1, 0.0, 0.5", "sensor.yaml: T_BS: the 3x3 part is not a rotation"},
      {"0.0, 0.0, 1.0, 2.0", "0.0, 0.0, -1.0, 2.0", "T_BS: the 3x3 part is not a rotation"},
      {"0.0, 0.0, 0.0, 1.0]", "0.0, 0.5, 0.0, 1.0]", "T_BS: the last row"},
      {"0.0, 0.0, 0.0, 1.0]", "1.0]", "T_BS: has 13 numbers instead of 16"},
      {"T_BS", "T_CB", "T_BS: is missing"},
      {"[752, 480]", "[752, 0]", "resolution: is not a width and height"},
      {"[752, 480]", "752", "resolution: is not a list of numbers"},
      {"[752, 480]", "[300, 200]", "intrinsics: the principal point is outside the image"},
      {"458.654", "-458.654", "intrinsics: the focal lengths must be positive"},
      {"458.654", "wide", "intrinsics: contains a value that is not a number"},
      {"458.654", ".nan", "intrinsics: contains a value that is not a number"},
      {"458.654, ", "", "intrinsics: has 3 numbers instead of 4"},
      {"model: pinhole", "model: ocam", "camera_model: \"ocam\" is not supported"},
      {"radial-tangential", "poly", "distortion_model: \"poly\" is not supported"},
      {"-0.28340811, ", "", "distortion_coefficients: has 3 numbers instead of 4"},
      {"radial-tangential\ndistortion_coefficients: [", "equidistant\ndistortion_coefficients: [0.1, ",
       "has 5 numbers"},
      {"distortion_model: radial-tangential", "", "distortion_model: is missing"},
      {"resolution: [752", "resolution: [752]]", "sensor.yaml:10: "},
      {kEurocSensor, "nothing", "is not a YAML mapping of named fields"},
  };
  for (const Case& bad : cases) {
    EXPECT_THAT(error_of([&] { read(bad.old_text, bad.new_text); }), HasSubstr(bad.message)) << bad.new_text;
  }
}

TEST_F(EurocSensorFile, ReportsAMissingFile) {
  EXPECT_THAT(error_of([&] { read_euroc_sensor(folder_ / "none.yaml"); }), HasSubstr("none.yaml: cannot be opened"));
}

}  // namespace
}  // namespace byre
