#pragma once

#include "byre/map/map_view.h"
#include "byre/session_event.h"
#include "byre/slam/guided_matching.h"
#include "byre/slam/lens_mask.h"
#include "byre/slam/tracking.h"

#include <optional>
#include <vector>

namespace byre {

// Looks for dirt on the lenses while the robot moves. A few times a second the points that were seen in the last
// seconds are looked for where they have come to another cell of the image: behind dirt too, so that it is noticed when
// that is wiped off. It has no say in the pose.
class LensWatch {
 public:
  // A frame whose pose is known. Precondition: frames come in order of time.
  void note(const Frame& frame, const TrackedFrame& tracked, const Rig& rig, const MapView& map);

  const HiddenCells& hidden() const { return left_.hidden(); }         // in the left image
  const HiddenCells& hidden_right() const { return right_.hidden(); }  // in the right image
  std::optional<SessionEvent> news();                                  // what is to be told now; told once

 private:
  // A point that was seen shortly before.
  struct Sight {
    PointId point;
    Eigen::Vector2f pixel;     // where it was looked for last
    Timestamp seen{};          // when it was seen last
    bool is_in_right = false;  // it was found in the right image then
  };

  static bool has_left_cell(const Eigen::Vector2f& pixel, const Sight& since, const Rig& rig);
  void try_sights(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map);
  void try_sight(const Frame& frame, bool was_in_right, const Sight* now, const Projection& projection, const Rig& rig,
                 const Descriptor& descriptor);

  std::optional<Timestamp> last_;
  std::vector<Sight> sights_;  // ascending by point
  LensMask left_;
  LensMask right_;
  double told_share_ = 0.0;  // shares hidden in both images when that was told last
  std::vector<Sight> now_;   // memory, as the next
  std::vector<Sight> joined_;
  std::vector<LensTrial> trials_;
  std::vector<LensTrial> trials_right_;
};

}  // namespace byre
