#pragma once

#include "byre/map/map_upkeep.h"

#include <functional>
#include <span>
#include <vector>

namespace byre {

// Keyframes within 1 m and 0.5 rad of a camera.
std::vector<KeyframeId> keyframes_at(const MapGraph& map, std::span<const KeyframeId> among,
                                     const Pose& camera_from_world);

inline constexpr int kPlaceBudget = 12;

// Removes keyframes from places beyond their budget: that number of keyframes, or as many as the parent has there. The
// least useful go first: those whose points are unlikely to exist, or are seen by many others. So a place keeps what is
// seen in each light, and the size of a map depends on the building, not on the number of updates. survival: by point
// number of the child. is_kept: keyframes that stay in any case. Returns the number removed.
int keep_to_budget(const MapGraph& parent, int budget, std::span<const Survival> survival,
                   const std::function<bool(const Keyframe&)>& is_kept, MapGraph& child);

// Removes online keyframes near others until at most max_keyframes are left, at least 0.3 m or 0.3 rad apart, and
// online points that only one of these sees. So the size of a session depends on the places visited, not on time, and
// is bounded.
void thin_out(MapGraph& online, int max_keyframes);

}  // namespace byre
