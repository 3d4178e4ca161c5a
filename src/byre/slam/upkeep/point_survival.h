#pragma once

#include "byre/map/map_upkeep.h"

#include <span>
#include <vector>

namespace byre {

// Bayesian persistence of map points over missions (Rosen, Mason and Leonard 2016, Towards lifelong feature-based
// mapping in semi-static environments), with one step a mission.

// Log-odds of a new point, which several keyframes of a mission saw.
inline constexpr Survival kSurvivalOfNewPoint = 32;

double probability_of(Survival log_odds);

// Log-odds after a mission. A mission that did not expect the point does not change it.
Survival survival_after(Survival before, const PointRecord& record);

// Points to retire, the least likely first. Things disappear as a whole (Bateman et al. 2020, joint persistence of
// cliques): the log-odds of a point and the mean of those near it add up to less than even odds; alone, it is less
// likely than one in eight. A keyframe keeps at least half of its points, and 60 if it has as many, so that its place
// stays recognisable. survival: by point number.
std::vector<PointId> points_to_retire(const MapGraph& map, std::span<const Survival> survival);

}  // namespace byre
