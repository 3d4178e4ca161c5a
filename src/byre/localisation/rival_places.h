#pragma once

#include "byre/localisation/place_hypothesis.h"
#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// Other places in the offline map that may be the robot's. Searches propose them; frames test each of them as they test
// the robot's place. The robot moves alike at all of them, so a rival stays at the same pose relative to the place.
class RivalPlaces {
 public:
  // What a frame shows at a rival.
  struct Look {
    Pose camera_from_offline;  // refined by the points seen there where it was tracked; else as predicted
    PlaceView view;
    bool is_tracked = false;
  };
  using LookAt = std::function<Look(const Pose& predicted_camera_from_offline)>;

  // max_speed: highest speed of the robot, metres per second.
  explicit RivalPlaces(double max_speed) : max_speed_(max_speed) {}

  // Test of the place, or of the rival, where a frame is found: within reach of its pose in the last frame, of the
  // second before. nullptr: none.
  const PlaceHypothesis* known_at(Timestamp time, const Pose& camera_from_offline) const;
  // A frame was found at camera_from_place without a prediction. Rivals from now on: the place before, unless it was
  // accepted, and the rivals elsewhere.
  void begin(Timestamp time, const Pose& camera_from_place);
  // rival_from_place: takes poses at the robot's place to poses at the rival. prior: log-odds. Ignored within half a
  // metre of the place or of a known rival.
  void propose(const Pose& camera_from_place, const Pose& rival_from_place, double prior);
  // A frame of which camera_from_place is the pose at the robot's place.
  void observe(const Pose& camera_from_place, const LookAt& look_at);
  // The test of the robot's place after that frame.
  void note_place(Timestamp time, const Pose& camera_from_place, const PlaceHypothesis& place);

  // What the robot's place must outweigh: log of 1 + the sum of the odds of all rivals; 0 without rivals.
  double log_odds() const;
  // Whether a rival is so much more likely than the robot's place that the place is to be given up. An accepted place
  // is given up only after 2 m of way: places that look alike from one spot differ along a way.
  bool outdo(const PlaceHypothesis& place) const;
  // Pose of the last frame at the likeliest rival; empty without rivals.
  std::optional<Pose> camera_from_likeliest() const;

  void forget() { rivals_.clear(); }

 private:
  struct Rival {
    Pose rival_from_place;
    PlaceHypothesis test;
    Eigen::Vector3d proposed_at;  // camera at the robot's place, metres
    double way = 0.0;             // metres, largest distance from there
    int frames = 0;               // frames tracked there
  };
  struct LastFrame {
    Timestamp time{};
    Pose camera_from_place;
    PlaceHypothesis place;
  };
  double reach(Timestamp time) const;  // metres, since the last frame; precondition: there is one
  bool is_recent(Timestamp time) const;
  Pose offline_from_last(const Rival& rival) const;  // pose of the last frame at the rival

  double max_speed_;  // constant after construction
  std::vector<Rival> rivals_;
  std::optional<LastFrame> last_;
};

}  // namespace byre
