#include "byre/slam/upkeep/point_survival.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace byre {
namespace {

constexpr double kSteps = 16.0;      // Survival per unit of log-odds
constexpr double kMostLikely = 5.0;  // log-odds; a point that was seen often can still vanish within a few missions

// Log of the likelihood of a mission's sightings of a point that exists, over that of one that is gone.
double log_likelihood_ratio(const PointRecord& record) {
  constexpr double kMissesExplained = 2.0;    // sightings that may be missing for other reasons, such as a cow
  constexpr double kStrongestMiss = -2.0;     // a mission's misses share their causes
  constexpr double kStrongestSighting = 3.0;  // sightings of a mission share theirs
  constexpr double kPerSighting = 1.0;        // another point seldom has the same patch
  if (record.seen > 0) return std::min(kStrongestSighting, kPerSighting * record.seen);
  const double missing = std::max(0.0, record.due - kMissesExplained);
  return std::max(kStrongestMiss, -missing / kMissesExplained);
}

int points_of(const Keyframe& keyframe) {
  return static_cast<int>(
      std::ranges::count_if(keyframe.sightings, [](const Sighting& sighting) { return sighting.point.has_value(); }));
}

// Mean survival of the points that a keyframe sees with this one, within a tenth of its distance, and of a new point.
double survival_nearby(const MapGraph& map, PointId id, std::span<const Survival> survival) {
  constexpr double kNear = 0.1;  // share of the distance from the keyframe
  const Eigen::Vector3d position = map.find_point(id)->position_in_world;
  std::set<PointId> nearby;
  for (const Observation& seen : map.observations(id)) {
    const Keyframe& keyframe = *map.find_keyframe(seen.keyframe);
    const double radius = kNear * (keyframe.camera_from_world * position).norm();
    for (const Sighting& sighting : keyframe.sightings) {
      if (!sighting.point || sighting.point == id) continue;
      const Eigen::Vector3d& other = map.find_point(*sighting.point)->position_in_world;
      if ((other - position).norm() <= radius) nearby.insert(*sighting.point);
    }
  }
  double sum = kSurvivalOfNewPoint;
  for (const PointId other : nearby) sum += survival[other.number];
  return sum / static_cast<double>(nearby.size() + 1);
}

}  // namespace

double probability_of(Survival log_odds) {
  return 1.0 / (1.0 + std::exp(-log_odds / kSteps));
}

Survival survival_after(Survival before, const PointRecord& record) {
  constexpr std::uint32_t kMoved = 5;  // frames that show a point elsewhere, and none at its position
  if (record.expected == 0 && record.elsewhere < kMoved) return before;
  const bool has_moved = record.elsewhere >= kMoved && record.seen == 0;
  const double after = before / kSteps + log_likelihood_ratio(record) - (has_moved ? 1.0 : 0.0);
  return static_cast<Survival>(std::lround(kSteps * std::clamp(after, -kMostLikely, kMostLikely)));
}

std::vector<PointId> points_to_retire(const MapGraph& map, std::span<const Survival> survival) {
  constexpr int kRecognisable = 60;  // points, see kOfflineThatHolds
  std::vector<PointId> unlikely;
  for (const PointId id : map.point_ids()) {
    const double own = survival[id.number];
    if (own < 0 && own + survival_nearby(map, id, survival) <= 0) unlikely.push_back(id);
  }
  std::ranges::stable_sort(unlikely, {}, [&](PointId id) { return survival[id.number]; });
  std::map<KeyframeId, int> to_spare;  // points that the keyframe can lose
  for (const KeyframeId id : map.keyframe_ids()) {
    const int points = points_of(*map.find_keyframe(id));
    to_spare[id] = points - std::max(points / 2, std::min(points, kRecognisable));
  }
  std::vector<PointId> retired;
  for (const PointId id : unlikely) {
    const std::vector<Observation>& observers = map.observations(id);
    const bool is_needed =
        std::ranges::any_of(observers, [&](const Observation& seen) { return to_spare[seen.keyframe] <= 0; });
    if (is_needed) continue;
    for (const Observation& seen : observers) --to_spare[seen.keyframe];
    retired.push_back(id);
  }
  return retired;
}

}  // namespace byre
