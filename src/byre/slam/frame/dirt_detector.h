#pragma once

#include "byre/map/map_view.h"
#include "byre/session_event.h"
#include "byre/slam/frame/dirt_mask.h"
#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/tracking/tracking.h"

#include <optional>
#include <vector>

namespace byre {

// Detects dirt on the lenses while the robot moves. A few times a second, points seen in the last seconds are searched
// once they have moved to another image cell, behind dirt as well, so that cleaning is detected too. Does not affect
// the pose.
class DirtDetector {
 public:
  // A frame with a reliable pose. Precondition: frames are in order of time.
  void note(const Frame& frame, const TrackedFrame& tracked, const Rig& rig, const MapView& map);

  const ImageMask& hidden() const { return left_.hidden(); }         // in the left image
  const ImageMask& hidden_right() const { return right_.hidden(); }  // in the right image
  std::optional<SessionEvent> take_event();                          // event to report; each event once

 private:
  // A point seen shortly before.
  struct Sight {
    PointId point;
    Eigen::Vector2f pixel;     // position of the last search
    Timestamp seen{};          // time of the last sighting
    bool is_in_right = false;  // found in the right image at that time
  };

  static bool has_left_cell(const Eigen::Vector2f& pixel, const Sight& since, const Rig& rig);
  void try_sights(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map);
  void try_sight(const Frame& frame, bool was_in_right, const Sight* now, const Projection& projection, const Rig& rig,
                 const Descriptor& descriptor);

  std::optional<Timestamp> last_;
  std::vector<Sight> sights_;  // ascending by point
  DirtMask left_;
  DirtMask right_;
  double reported_share_ = 0.0;  // sum of the hidden shares of both images at the last report
  std::vector<Sight> now_;       // buffer
  std::vector<Sight> joined_;
  std::vector<DirtTrial> trials_;
  std::vector<DirtTrial> trials_right_;
};

}  // namespace byre
