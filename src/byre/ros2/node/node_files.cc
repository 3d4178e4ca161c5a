#include "byre/calibration_file.h"
#include "byre/floor_plan.h"
#include "byre/geometry/baseline.h"
#include "byre/map/map_file.h"
#include "byre/ros2/node/map_messages.h"
#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/slam_runner.h"
#include "byre/site.h"
#include "byre/slam/system/stored_map.h"

#include <filesystem>
#include <fstream>
#include <functional>

namespace byre {

namespace {

namespace fs = std::filesystem;

void require_cameras(const Calibration& calibration, const NodeConfig& config) {
  if (!config.has_right() || calibration.right) return;
  throw InputError(config.calibration->string(), "is of one camera, but images.right gives a second one",
                   "give the calibration of the pair (Kalibr camchain), or leave images.right empty");
}

// Whether the axes of the body are those of the left camera: right, down, forward.
bool has_optical_axes(const Calibration& calibration) {
  constexpr double kMaxTurn = 0.3;  // radians
  return angle_between(calibration.body_from_left.rotation, Eigen::Quaterniond::Identity()) < kMaxTurn;
}

bool has_no_body(const Calibration& calibration) {
  constexpr double kRounding = 1e-9;
  return log_pose(calibration.body_from_left).norm() < kRounding;
}

}  // namespace

std::vector<InputError> faults_in_files(const NodeConfig& config, std::vector<std::string>& notes) {
  std::vector<InputError> faults;
  const auto look = [&faults](const std::function<void()>& open) {
    try {
      open();
    } catch (const InputError& error) {
      faults.push_back(error);
    }
  };
  look([&] { SlamRunner runner(config); });
  if (config.plan) look([&] { grid_of(read_floor_plan(*config.plan)); });
  look([&] {
    const Vocabulary vocabulary = open_vocabulary(config.vocabulary);
    if (config.map) load_for_mapping(*config.map, vocabulary);
    require_plan_of_map(config);
  });
  look([&] { fleet_options(config); });
  if (config.calibration) {
    look([&] {
      const CalibrationReading reading = read_node_calibration(config);
      notes = reading.notes;
      if (const auto fault = fault_of_base_frame(reading.calibration, config)) faults.push_back(*fault);
      if (config.has_depth()) read_node_depth_camera(config);
      with_checked_baseline(reading.calibration, config.baseline, config.calibration->string(), kBaselineSetting);
    });
  }
  return faults;
}

std::optional<FleetOptions> fleet_options(const NodeConfig& config) {
  const FleetSettings& fleet = config.fleet;
  if (fleet.host.empty()) return std::nullopt;
  FleetOptions options;
  options.broker = {fleet.host, fleet.port, fleet.user, "", ""};
  if (fleet.password_file) {
    std::ifstream file(*fleet.password_file);
    if (!std::getline(file, options.broker.password)) {
      throw InputError(fleet.password_file->string(), "has no readable password",
                       "write it into the first line, and give byre read permission");
    }
  }
  options.identity = {fleet.interface_name, fleet.manufacturer,
                      fleet.serial_number.empty() ? config.name : fleet.serial_number};
  options.rate = fleet.rate;
  return options;
}

void require_plan_of_map(const NodeConfig& config) {
  if (!config.plan) return;
  if (is_site_file(*config.map)) {
    throw InputError("slam.plan", "is of one map, but slam.map is a site", "name plans in the site file");
  }
  const auto registration = load_plan_registration(*config.map);
  const std::string name = config.plan->filename().string();
  if (!registration) {
    throw InputError(config.map->string(), "is not registered on a floor plan, but slam.plan is set",
                     "register it on the plan with byre register or byre view, or leave slam.plan empty");
  }
  if (registration->plan != name) {
    throw InputError(config.plan->string(), "is not the floor plan of the map, " + registration->plan,
                     "give that plan, or register the map on this one");
  }
}

CalibrationReading read_node_calibration(const NodeConfig& config) {
  const fs::path& file = *config.calibration;
  CalibrationReading reading = read_calibration_file(file);
  reading.calibration = read_calibration(file);  // with the image size
  require_cameras(reading.calibration, config);
  if (config.extrinsics_source() == ExtrinsicsSource::file && has_optical_axes(reading.calibration) &&
      !has_no_body(reading.calibration)) {
    reading.notes.push_back(
        "the left camera looks along z of " + config.base_frame +
        ", which is up; if its body is an IMU with the axes of the camera, set frames.mounting: tf");
  }
  for (std::string& note : reading.notes) note = file.string() + ": " + note;
  return reading;
}

std::optional<DepthCamera> read_node_depth_camera(const NodeConfig& config) {
  if (!config.calibration || !has_depth_camera_fields(*config.calibration)) return std::nullopt;
  return read_depth_camera(*config.calibration);
}

std::optional<InputError> fault_of_base_frame(const Calibration& calibration, const NodeConfig& config) {
  if (config.extrinsics_source() != ExtrinsicsSource::file || !has_no_body(calibration)) return std::nullopt;
  return InputError(config.calibration->string(),
                    "has no pose of the cameras in a body (T_cam_imu, T_BS), so " + config.base_frame +
                        " is the optical frame of the left camera, with z forward and y down",
                    "add it, or set frames.mounting: tf if the robot description has the cameras; frames.mounting: "
                    "camera confirms it");
}

}  // namespace byre
