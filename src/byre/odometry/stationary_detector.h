#pragma once

#include "byre/body_motion.h"
#include "byre/odometry/gyroscope_calibration.h"
#include "byre/odometry/visual_motion.h"
#include "byre/trajectory.h"

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

namespace byre {

// Samples of gyroscope and accelerometer of the last seconds, and whether they are steady. They are steady at rest and
// during even acceleration; the two cannot be distinguished.
class SteadyWindow {
 public:
  static constexpr Timestamp kWindow = std::chrono::milliseconds(800);

  // Samples that are not later than the previous one are dropped.
  void add(const AngularRate& rate);
  void add(const Acceleration& acceleration);
  bool has_accelerations() const { return !accelerations_.empty(); }

  // Means over the window that ends at a time, about the sensor's axes.
  struct Steady {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // a unit vector; biased during acceleration
    double sigma = 0.0;  // radians, from a consumer sensor's bias and the deviation of samples
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // radians per second, with the bias
  };
  // Empty if samples are missing or not steady. Vibration is tolerated, sway is not.
  std::optional<Steady> until(Timestamp time) const;

 private:
  std::deque<AngularRate> rates_;
  std::deque<Acceleration> accelerations_;
};

// Up direction in a map, measured by accelerations at stops with well-known poses.
struct UpInMap {
  Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();  // a unit vector
  double sigma = 0.0;                                    // radians
};

// Tilt of the body at standstill: constrains roll and pitch, not the heading.
struct BodyTilt {
  Eigen::Vector3d up_in_body = Eigen::Vector3d::UnitZ();  // a unit vector
  Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();   // a unit vector
  double sigma = 0.0;                                     // radians
  int stop = 0;  // number of the stop; all tilts of one stop are one measurement
};

// Detects standstill, and measures the up direction there. Acceleration is steady at rest and also during even braking;
// standstill therefore requires that wheels or images show it, and that neither contradicts.
class StationaryDetector {
 public:
  // Sets the up direction of an earlier map that is extended.
  void begin_with(const std::optional<UpInMap>& known) { prior_ = known; }

  void add(const AngularRate& rate) { track_.add(rate); }
  void add(const Acceleration& acceleration) { track_.add(acceleration); }

  // Visual pose of a frame, in lengths of the map; empty if it was not tracked.
  void note_visual_pose(Timestamp time, const std::optional<Pose>& seen);
  // Whether the poses of the window before the last frame are equal up to noise. Empty if not all frames were tracked.
  std::optional<bool> are_poses_stationary(double metres_per_unit) const;

  // Evidence of standstill over the last window before a time. Empty: no measurement.
  struct StationaryEvidence {
    std::optional<bool> are_wheels_stationary;
    std::optional<bool> are_poses_stationary;
  };
  // Means of gyroscope and accelerometer at standstill; empty if standstill is not detected.
  // bias: of the gyroscope, if available.
  std::optional<SteadyWindow::Steady> at(Timestamp time, const StationaryEvidence& evidence,
                                         const std::optional<Eigen::Vector3d>& bias) const;

  // Adds a frame; steady is empty if the body moved.
  void note(Timestamp time, const std::optional<SteadyWindow::Steady>& steady);
  // Sets the map pose of the last frame. Call it only for well-known poses.
  void note_place(const Eigen::Quaterniond& map_from_body);
  // Replaces the poses of all stops by the final ones.
  void reestimate(const Trajectory& seen);

  const std::optional<SteadyWindow::Steady>& now() const { return now_; }
  int stops() const { return stops_; }
  double seconds() const { return seconds_; }  // total time at standstill

  // Up in the map by all stops. Without a stop or a gyroscope calibration: that of the earlier map, if any.
  std::optional<UpInMap> up_in_map(const std::optional<GyroscopeCalibration>& calibration) const;
  // Empty if the body does not stand still, or the tilt is too uncertain.
  std::optional<BodyTilt> tilt(Timestamp time, const std::optional<SteadyWindow::Steady>& steady,
                               const std::optional<GyroscopeCalibration>& calibration) const;

 private:
  int stop_at(Timestamp time) const;  // number of the stop that a standstill at this time belongs to

  struct Place {
    Timestamp time{};
    Eigen::Vector3d up_in_sensor;
    Eigen::Quaterniond map_from_body;
  };

  SteadyWindow track_;
  std::deque<StampedPose> seen_;  // consecutive tracked frames up to the last one, of about a second
  std::optional<UpInMap> prior_;
  std::optional<SteadyWindow::Steady> now_;
  std::optional<Timestamp> last_stationary_;
  std::vector<Place> places_;
  int stops_ = 0;
  double seconds_ = 0.0;
};

// Up axis of the body measured by the sensor, and its largest standard deviation, radians. The deviation includes the
// uncertainty of the calibration about axes without turns.
struct UpInBody {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double sigma = 0.0;
};
UpInBody up_in_body(const SteadyWindow::Steady& steady, const GyroscopeCalibration& calibration);

}  // namespace byre
