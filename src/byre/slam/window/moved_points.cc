#include "byre/slam/window/moved_points.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kNeighbours = 6;  // nearest judged points to compare with
constexpr double kMinShareMoved = 0.5;  // share of moved ones among these

struct JudgedPoint {
  Eigen::Vector3d position_in_world;
  bool moved = false;
};

ScratchVector<JudgedPoint> judged_points(const MapGraph& offline, std::span<const PointId> agreed,
                                         std::span<const PointId> moved) {
  ScratchVector<JudgedPoint> judged;
  judged.reserve(agreed.size() + moved.size());
  for (const PointId id : moved) judged.push_back({offline.find_point(id)->position_in_world, true});
  for (const PointId id : agreed) judged.push_back({offline.find_point(id)->position_in_world, false});
  return judged;
}

// Share of moved points among the nearest judged ones.
double share_around(std::span<const JudgedPoint> judged, std::size_t point) {
  ScratchVector<std::pair<double, bool>> others;  // squared metres, moved
  others.reserve(judged.size());
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (i == point) continue;
    others.push_back({(judged[i].position_in_world - judged[point].position_in_world).squaredNorm(), judged[i].moved});
  }
  const std::size_t count = std::min(kNeighbours, others.size());
  if (count == 0) return 0.0;
  std::ranges::nth_element(others, others.begin() + static_cast<std::ptrdiff_t>(count - 1));
  const auto moved = std::count_if(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(count),
                                   [](const auto& other) { return other.second; });
  return static_cast<double>(moved) / static_cast<double>(count);
}

}  // namespace

ScratchVector<PointId> moved_together(const MapGraph& offline, std::span<const PointId> agreed,
                                      std::span<const PointId> moved) {
  if (moved.empty()) return {};  // in most frames
  const ScratchVector<JudgedPoint> judged = judged_points(offline, agreed, moved);
  ScratchVector<PointId> together;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (share_around(judged, i) >= kMinShareMoved) {
      together.push_back(moved[i]);
    }
  }
  return together;
}

MovedPoints::Record& MovedPoints::record_of(PointId id) {
  if (id.number >= records_.size()) records_.resize(id.number + std::size_t{1});
  return records_[id.number];
}

void MovedPoints::note(std::span<const PointId> agreed, std::span<const PointId> moved) {
  for (const PointId id : agreed) {
    Record& record = record_of(id);
    record.excess = static_cast<std::int16_t>(std::max(0, record.excess - 1));
  }
  for (const PointId id : moved) {
    Record& record = record_of(id);
    if (record.suspended || ++record.excess < options_.frames) continue;
    record.suspended = true;
    ++count_;
  }
}

void MovedPoints::note_retest(std::span<const PointId> agreed, std::span<const PointId> moved) {
  for (const PointId id : moved) record_of(id).in_place = 0;
  for (const PointId id : agreed) {
    Record& record = record_of(id);
    if (!record.suspended || ++record.in_place < options_.frames_to_return) continue;
    record = {};
    --count_;
  }
}

bool MovedPoints::is_suspended(PointId id) const {
  return id.origin == Origin::offline && id.number < records_.size() && records_[id.number].suspended;
}

}  // namespace byre
