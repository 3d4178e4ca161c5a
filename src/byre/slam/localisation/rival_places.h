#pragma once

#include "byre/slam/places/place_hypothesis.h"
#include "byre/trajectory.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// Alternative places of the robot in the offline map, each with its own test. The robot moves in the same way at all of
// them, so the pose of a rival relative to the robot's place is constant.
class RivalPlaces {
 public:
  struct View {
    Pose camera_from_offline;  // refined if the frame was tracked there; otherwise the predicted pose
    PlaceView view;
    bool is_tracked = false;
  };
  using TrackAt = std::function<View(const Pose& predicted_camera_from_offline)>;

  explicit RivalPlaces(const RegistrationOptions& options) : options_(options) {}

  // Test of the place or rival at which a frame is found: within reach of its pose in the last frame, and within a
  // second of it. nullptr: a new place.
  const PlaceHypothesis* find_test(Timestamp time, const Pose& camera_from_offline) const;
  // Begins a place at camera_from_place, found without a prediction. Its rivals are the place before, unless accepted,
  // and the rivals elsewhere. Returns the test of find_test(); empty for a new place.
  std::optional<PlaceHypothesis> begin(Timestamp time, const Pose& camera_from_place);
  // Adds a rival with these prior log-odds. Both poses are of one frame. Ignored within half a metre of the place or of
  // a rival.
  void propose(const Pose& camera_from_place, const Pose& camera_from_rival, double prior);
  void observe(const Pose& camera_from_place, const TrackAt& track_at);
  // Sets the test of the robot's place after a frame.
  void note_place(Timestamp time, const Pose& camera_from_place, const PlaceHypothesis& place);

  // Log of the sum of the odds of all rivals, which the robot's place must outweigh; kNoRivals without rivals.
  double log_odds() const;
  // Log of the likelihood ratio of a rival to the place by earlier frames of an unbroken path.
  using OfPath = std::function<double(const Pose& rival_from_place)>;
  // Whether a rival is so much more likely that the robot's place must be given up. An accepted place, or one found by
  // a hint, is given up only after 2 m of path: places that look alike from one spot differ along a path. of_path
  // is called once for each such rival; empty: there are no earlier frames.
  bool refute(const PlaceHypothesis& place, bool is_by_hint, const OfPath& of_path = {});
  // Pose of the last frame at the likeliest rival; empty without rivals.
  std::optional<Pose> camera_from_likeliest() const;

  // Whether a rival is within a metre. Both poses are of one frame.
  bool has_at(const Pose& camera_from_place, const Pose& camera_from_rival) const;

  void forget() { rivals_.clear(); }

 private:
  struct Rival {
    Pose rival_from_place;
    PlaceHypothesis test;
    Eigen::Vector3d proposed_at;      // camera at the robot's place, metres
    double way = 0.0;                 // metres, largest distance from proposed_at
    int frames = 0;                   // frames tracked at the rival
    std::optional<double> of_path{};  // result of OfPath; empty before its call
  };
  struct LastFrame {
    Timestamp time{};
    Pose camera_from_place;
    PlaceHypothesis place;
  };
  bool is_recent(Timestamp time) const;  // the last frame is less than a second ago
  double reach(Timestamp time) const;    // largest motion since the last frame, metres; precondition: is_recent()
  Pose offline_from_last(const Rival& rival) const;  // pose of the last frame at the rival

  RegistrationOptions options_;  // constant after construction
  std::vector<Rival> rivals_;
  std::optional<LastFrame> last_;
};

}  // namespace byre
