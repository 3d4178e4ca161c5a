#include "byre/io/recording/euroc_sensor.h"

#include "byre/io/calibration/camera_fields.h"

#include <iomanip>
#include <limits>
#include <ostream>
#include <sstream>

namespace byre {
namespace {

void write_matrix(std::ostream& text, const Pose& pose) {
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  text << "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) text << rotation(row, column) << ", ";
    text << pose.translation[row] << ",\n         ";
  }
  text << "0.0, 0.0, 0.0, 1.0]\n";
}

void write_list(std::ostream& text, const std::vector<double>& numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) text << (i == 0 ? "[" : ", ") << numbers[i];
  text << "]";
}

void write_lens(std::ostream& text, const Camera& camera) {
  KalibrLens lens = kalibr_lens(camera);
  if (camera.model == CameraModel::pinhole || camera.model == CameraModel::radial_tangential) {
    lens.distortion_model = "radial-tangential";
  }
  text << "camera_model: " << lens.camera_model << "\nintrinsics: ";
  write_list(text, lens.intrinsics);
  text << (lens.intrinsics.size() == 4 ? " #fu, fv, cu, cv\n" : "\n");
  text << "distortion_model: " << lens.distortion_model << "\ndistortion_coefficients: ";
  write_list(text, lens.coefficients);
  text << "\n";
}

}  // namespace

EurocSensor read_euroc_sensor(const std::filesystem::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  EurocSensor sensor;
  sensor.camera = read_camera_fields(fields, "distortion_coefficients");
  sensor.body_from_camera = fields.pose("T_BS");
  sensor.readout_time = read_readout_time(fields, sensor.camera);
  return sensor;
}

std::string write_euroc_sensor(const EurocSensor& sensor, double rate_hz, const std::string& comment) {
  std::ostringstream text;
  text << std::setprecision(std::numeric_limits<double>::max_digits10);
  text << "sensor_type: camera\ncomment: " << comment << "\n\n# Sensor extrinsics wrt. the body-frame.\n";
  write_matrix(text, sensor.body_from_camera);
  text << "\n# Camera specific definitions.\nrate_hz: " << rate_hz << "\nresolution: [" << sensor.camera.width << ", "
       << sensor.camera.height << "]\n";
  write_lens(text, sensor.camera);
  if (sensor.readout_time != 0.0) text << "readout_time: " << sensor.readout_time << "\n";
  return text.str();
}

}  // namespace byre
