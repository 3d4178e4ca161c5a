#pragma once

#include "byre/localisation/place_search.h"
#include "byre/slam/registration.h"

#include <optional>

namespace byre {

// A place elsewhere that shows much more of what is seen than the one where the robot was tracked all the while. Where
// it is found again and again along the way, the robot was taken for a place that looks alike.
class RivalPlace {
 public:
  // Where a frame that tracking had at camera_from_tracked was found. Whether the rival is to be believed from now on.
  bool note(const FoundPlace& found, const Pose& camera_from_tracked, const RegistrationOptions& options);

  // Tracking sees as much as can be expected.
  void forget() { rival_.reset(); }

 private:
  struct Rival {
    RegistrationHypothesis place;
    Eigen::Vector3d begun_at;  // where tracking had the camera when the rival was found first
    int outdone = 0;           // finds that showed no more than tracking did
  };
  std::optional<Rival> rival_;
};

}  // namespace byre
