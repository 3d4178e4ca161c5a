#include "byre/localisation/place_search.h"

#include "byre/slam/keyframes.h"

#include <algorithm>

namespace byre {

Localisation localise_in(const OfflineMap& offline, const Frame& frame, const Rig& rig,
                         const LocaliseOptions& options) {
  const Map nothing_online(Origin::online);
  return localise(frame, rig, MapView(&offline.map(), nothing_online), offline.places(), options);
}

std::optional<FoundPlace> search_place(const OfflineMap& offline, const Frame& frame, const Rig& rig,
                                       std::size_t number, const LocaliseOptions& options) {
  const Localisation found = localise_in(offline, frame, rig, options);
  if (!found.tracked) return std::nullopt;
  const Map nothing_online(Origin::online);
  const double depth = median_depth(*found.tracked, MapView(&offline.map(), nothing_online));
  const double seen = static_cast<double>(found.tracked->features.size()) / std::max(1, found.tracked->expected);
  return FoundPlace{number, found.tracked->camera_from_world, depth, seen};
}

}  // namespace byre
