#include "byre/dataset/euroc_sensor.h"

#include "byre/dataset/camera_fields.h"

namespace byre {

EurocSensor read_euroc_sensor(const std::filesystem::path& path) {
  const CalibrationFields fields = CalibrationFields::load(path);
  EurocSensor sensor;
  sensor.camera = read_camera_fields(fields, "distortion_coefficients");
  sensor.body_from_camera = fields.pose("T_BS");
  sensor.readout_time = read_readout_time(fields, sensor.camera);
  return sensor;
}

}  // namespace byre
