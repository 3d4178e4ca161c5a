#pragma once

#include "byre/slam/place_hypothesis.h"
#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// Other places in the offline map that may be the robot's, each with its own test. The robot moves in the same way at
// all of them, so the pose of a rival relative to the robot's place stays the same.
class RivalPlaces {
 public:
  // A frame at a rival.
  struct View {
    Pose camera_from_offline;  // refined if the frame was tracked there; otherwise the predicted pose
    PlaceView view;
    bool is_tracked = false;
  };
  using TrackAt = std::function<View(const Pose& predicted_camera_from_offline)>;

  explicit RivalPlaces(const RegistrationOptions& options) : options_(options) {}

  // Test of the place, or of the rival, at which a frame is found: within reach of its pose in the last frame, for at
  // most a second. nullptr: a new place.
  const PlaceHypothesis* known_at(Timestamp time, const Pose& camera_from_offline) const;
  // A frame was found at camera_from_place without a prediction. Rivals from now on: the place before, unless it was
  // accepted, and the rivals elsewhere. Returns the test of known_at(); empty for a new place.
  std::optional<PlaceHypothesis> begin(Timestamp time, const Pose& camera_from_place);
  // Adds a rival with these prior log-odds. Poses of one frame; ignored within half a metre of the place or of a rival.
  void propose(const Pose& camera_from_place, const Pose& camera_from_rival, double prior);
  // Tests a frame at all rivals.
  void observe(const Pose& camera_from_place, const TrackAt& track_at);
  // The test of the robot's place after that frame.
  void note_place(Timestamp time, const Pose& camera_from_place, const PlaceHypothesis& place);

  // What the robot's place must outweigh: log of the sum of the odds of all rivals; kNoRivals without.
  double log_odds() const;
  // Whether a rival is so much more likely that the robot's place is to be given up. An accepted place, and one found
  // by a hint, is given up only after 2 m of way: places that look alike from one spot differ along a way.
  bool refute(const PlaceHypothesis& place, bool is_by_hint) const;
  // Pose of the last frame at the likeliest rival; empty without rivals.
  std::optional<Pose> camera_from_likeliest() const;

  // Whether there is a rival within a metre. Poses of one frame.
  bool has_at(const Pose& camera_from_place, const Pose& camera_from_rival) const;

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
  bool is_recent(Timestamp time) const;              // the last frame is less than a second ago
  double reach(Timestamp time) const;                // metres since the last frame; precondition: is_recent()
  Pose offline_from_last(const Rival& rival) const;  // pose of the last frame at the rival

  RegistrationOptions options_;  // constant after construction
  std::vector<Rival> rivals_;
  std::optional<LastFrame> last_;
};

}  // namespace byre
