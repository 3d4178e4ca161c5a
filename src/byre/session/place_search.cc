#include "byre/session/place_search.h"

#include "byre/slam/keyframes.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace byre {

void PlaceSearch::look_for(const Frame& frame, const Rig& rig, std::size_t number) {
  assert(idle());
  result_ = std::make_shared<std::optional<FoundPlace>>();
  executor_->submit([frame, rig, number, result = result_, offline = offline_, options = options_] {
    const Localisation found = localise_in(*offline, frame, rig, options);
    if (found.tracked) {
      const Map nothing_online(Origin::online);
      const double depth = median_depth(*found.tracked, MapView(&offline->map(), nothing_online));
      const double seen = static_cast<double>(found.tracked->features.size()) / std::max(1, found.tracked->expected);
      *result = FoundPlace{number, found.tracked->camera_from_world, depth, seen};
    }
    return MapDelta{};
  });
}

std::optional<FoundPlace> PlaceSearch::collect() {
  if (!executor_->collect()) return std::nullopt;
  return *std::exchange(result_, nullptr);
}

void PlaceSearch::finish() {
  executor_->finish();
  result_.reset();
}

Localisation localise_in(const OfflineMap& offline, const Frame& frame, const Rig& rig,
                         const LocaliseOptions& options) {
  const Map nothing_online(Origin::online);
  return localise(frame, rig, MapView(&offline.map(), nothing_online), offline.places(), options);
}

}  // namespace byre
