#pragma once

#include "byre/motion/gyroscope_mounting.h"
#include "byre/motion/seen_motion.h"
#include "byre/motion/steady_track.h"
#include "byre/trajectory.h"

#include <deque>
#include <optional>
#include <vector>

namespace byre {

// Which way is up in a map, as accelerations told where the body stood still at poses that were well known.
struct KnownUp {
  Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();  // a unit vector
  double sigma = 0.0;                                    // radians
};

// How a body that stands still is tilted, and no more than that: its heading stays open.
struct BodyTilt {
  Eigen::Vector3d up_in_body = Eigen::Vector3d::UnitZ();  // a unit vector
  Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();   // a unit vector
  double sigma = 0.0;                                     // radians
  int stop = 0;  // number of the stop: all that is told of one is one measurement
};

// Where the body stands still, and which way is up by that. What an accelerometer tells is steady at rest and while a
// body brakes evenly; so the body stands where wheels do not turn, or nothing that is seen moves, and nothing says
// otherwise.
class Standing {
 public:
  // Up in a map that is gone on with.
  void begin_with(const std::optional<KnownUp>& known) { known_ = known; }

  void add(const AngularRate& rate) { track_.add(rate); }
  void add(const Acceleration& acceleration) { track_.add(acceleration); }

  // Pose of a frame by images, in lengths of the map; empty if it was not tracked.
  void note_sight(Timestamp time, const std::optional<Pose>& seen);
  // Whether the poses of the window before the last frame are equal up to noise. Empty if not all frames were tracked.
  std::optional<bool> does_sight_stand(double metres_per_unit) const;

  // What others say of the last window before a time. Empty: they say nothing.
  struct Witnesses {
    std::optional<bool> do_wheels_stand;
    std::optional<bool> does_sight_stand;
  };
  // What is told of a body that stands until a time; empty where it is not known to.
  // bias: of the gyroscope, where it is known.
  std::optional<SteadyTrack::Steady> at(Timestamp time, const Witnesses& witnesses,
                                        const std::optional<Eigen::Vector3d>& bias) const;

  // A frame at which the body stood, or did not.
  void note(Timestamp time, const std::optional<SteadyTrack::Steady>& steady);
  // The pose in the map of the last frame, where it is well known.
  void note_place(const Eigen::Quaterniond& map_from_body);
  // The poses of the map in the end.
  void look_again(const Trajectory& seen);

  const std::optional<SteadyTrack::Steady>& now() const { return now_; }
  int stops() const { return stops_; }
  double seconds() const { return seconds_; }  // time that it stood

  // Up in the map by all stops; empty where there was none, and while it is not known how the sensor is turned.
  std::optional<KnownUp> up_in_map(const std::optional<GyroscopeMounting>& mounting) const;
  // Empty where the body does not stand, or too little is known to tell a tilt.
  std::optional<BodyTilt> tilt(Timestamp time, const std::optional<SteadyTrack::Steady>& steady,
                               const std::optional<GyroscopeMounting>& mounting) const;

 private:
  int stop_at(Timestamp time) const;  // number of the stop that a body belongs to which stands then

  struct Place {
    Timestamp time{};
    Eigen::Vector3d up_in_sensor;
    Eigen::Quaterniond map_from_body;
  };

  SteadyTrack track_;
  std::deque<StampedPose> seen_;  // consecutive tracked frames up to the last one, of about a second
  std::optional<KnownUp> known_;
  std::optional<SteadyTrack::Steady> now_;
  std::optional<Timestamp> last_stood_;
  std::vector<Place> places_;
  int stops_ = 0;
  double seconds_ = 0.0;
};

// Up in the body by the sensor's axes, and how well it is known, radians: worst where turns left open how the sensor is
// turned.
struct UpInBody {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double sigma = 0.0;
};
UpInBody up_in_body(const SteadyTrack::Steady& steady, const GyroscopeMounting& mounting);

}  // namespace byre
