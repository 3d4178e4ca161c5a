#pragma once

#include "byre/pose_hint.h"
#include "byre/slam/localisation.h"
#include "byre/slam/offline_map.h"

#include <cstddef>
#include <optional>

namespace byre {

// What is looked for from nothing.
struct SoughtFrame {
  const Frame& frame;
  const Rig& rig;
  std::optional<PoseHint> hint{};  // where alone it is looked for; empty: everywhere
};

// The frame in the offline map alone.
Localisation localise_in(const OfflineMap& offline, const SoughtFrame& sought, const LocaliseOptions& options);

// Where the offline map shows what a frame saw.
struct FoundPlace {
  Timestamp time{};  // when the frame was taken that was found
  Pose camera_from_offline;
  double median_depth = 0.0;  // metres, of the points that say so
  double seen_share = 0.0;    // share of the points that should be in view there
  // Share that tracking saw, in the same frame, of those that should be in view where it had the camera; empty where
  // that cannot be judged.
  std::optional<double> tracked_share{};
};

// Looks for a frame in the offline map without a guess. Empty when it is not found.
std::optional<FoundPlace> search_place(const OfflineMap& offline, const SoughtFrame& sought,
                                       const LocaliseOptions& options);

}  // namespace byre
