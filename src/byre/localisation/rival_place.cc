#include "byre/localisation/rival_place.h"

#include "byre/slam/hybrid_tracking.h"

#include <algorithm>
#include <cmath>

namespace byre {

bool RivalPlace::note(const FoundPlace& found, const Pose& camera_from_tracked, const RegistrationOptions& options) {
  constexpr double kElsewhere = 0.5;       // metres
  const double of_rival = std::log(20.0);  // log-likelihood ratio of the rival to the tracked pose
  constexpr int kFinds = 5;
  constexpr double kWay = 2.0;  // metres; places that look alike from one spot differ along a way
  if (agreement_of(found.camera_from_offline, camera_from_tracked).translation <= kElsewhere) {
    forget();
    return false;
  }
  if (found.log_odds < 0.0 || found.log_odds < found.tracked_log_odds + of_rival) {
    if (rival_ && ++rival_->outdone > options.max_misses) forget();
    return false;
  }
  const Pose offline_from_tracked = inverse(found.camera_from_offline) * camera_from_tracked;
  const Eigen::Vector3d camera = inverse(camera_from_tracked).translation;
  if (rival_) {
    const auto confirmed = confirm(rival_->place, offline_from_tracked, camera, found.median_depth, options);
    if (confirmed) {
      rival_->place = *confirmed;
    } else {
      forget();
    }
  }
  if (!rival_) rival_ = Rival{{offline_from_tracked}, camera};
  return rival_->place.confirmations >= kFinds && (camera - rival_->begun_at).norm() >= kWay;
}

}  // namespace byre
