#pragma once

#include "byre/localisation/place_bounds.h"
#include "byre/pose_hint.h"
#include "byre/slam/localisation.h"
#include "byre/slam/offline_map.h"
#include "byre/slam/place_view.h"

#include <optional>
#include <vector>

namespace byre {

struct PlaceSearchOptions {
  LocaliseOptions localise;
  PlaceBoundsOptions bounds;
};

// What is looked for from nothing.
struct SoughtFrame {
  const Frame& frame;
  const Rig& rig;
  std::optional<PoseHint> hint{};         // where alone it is looked for; empty: everywhere
  std::optional<PlaceBounds::Way> way{};  // since the robot was last trusted to be somewhere
  HiddenCells hidden{};                   // where no points are asked for
};

// The frame in the offline map alone, but not where the robot cannot be.
struct BoundedLocalisation {
  Localisation found;
  Doubt refused = Doubt::none;  // why it cannot be at a place where the frame was found otherwise
};

BoundedLocalisation localise_in(const OfflineMap& offline, const SoughtFrame& sought,
                                const PlaceSearchOptions& options);

// Where the offline map shows what a frame saw.
struct FoundPlace {
  Pose camera_from_offline;
  double median_depth = 0.0;  // metres, of the matched points
  PlaceView view{};           // the part of the map that the frame shows
};

// What came of looking for a frame in the offline map without a guess.
struct PlaceSearch {
  Timestamp time{};                   // time of the frame
  Rig rig{};                          // cameras of the frame
  std::optional<FoundPlace> found{};  // empty where it was not found
  Doubt refused = Doubt::none;        // see BoundedLocalisation
  std::vector<Pose> places{};         // camera_from_offline at each place that shows the frame
};
PlaceSearch search_place(const OfflineMap& offline, const SoughtFrame& sought, const PlaceSearchOptions& options);

}  // namespace byre
