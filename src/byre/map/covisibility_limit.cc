// Limit of covisible keyframes by the size of the map file.

#include "byre/map/map_sections.h"

#include <limits>
#include <numeric>
#include <span>
#include <utility>

namespace byre {
namespace {

// Keyframes that observe each point, concatenated over points.
struct Observers {
  std::vector<std::size_t> begin;  // start index by point, then the end
  std::vector<std::uint32_t> keyframes;

  std::span<const std::uint32_t> of(std::uint32_t point) const {
    return std::span(keyframes).subspan(begin[point], begin[point + std::size_t{1}] - begin[point]);
  }
  // Number of pairs of keyframes with a common point, counted once per point.
  std::size_t count_pairs() const {
    std::size_t pairs = 0;
    for (std::size_t point = 0; point + 1 < begin.size(); ++point) {
      const std::size_t observers = begin[point + 1] - begin[point];
      pairs += observers * (observers - 1);
    }
    return pairs;
  }
};

template <typename Visitor>
void visit_sightings(const std::vector<Keyframe>& keyframes, Visitor visit) {
  for (std::uint32_t i = 0; i < keyframes.size(); ++i) {
    for (const Sighting& sighting : keyframes[i].sightings) {
      if (sighting.point) visit(i, sighting.point->number);
    }
  }
}

Observers observers_of_points(const std::vector<Keyframe>& keyframes, std::size_t point_count) {
  Observers observers;
  observers.begin.assign(point_count + 1, 0);
  visit_sightings(keyframes, [&](std::uint32_t, std::uint32_t point) { ++observers.begin[point + std::size_t{1}]; });
  std::partial_sum(observers.begin.begin(), observers.begin.end(), observers.begin.begin());
  observers.keyframes.resize(observers.begin.back());
  std::vector<std::size_t> next(observers.begin.begin(), observers.begin.end() - 1);
  visit_sightings(keyframes,
                  [&](std::uint32_t keyframe, std::uint32_t point) { observers.keyframes[next[point]++] = keyframe; });
  return observers;
}

std::size_t count_covisible_keyframes(const Keyframe& keyframe, std::uint32_t number, const Observers& observers,
                                      std::vector<std::uint32_t>& last_met_by) {
  std::size_t count = 0;
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    for (const std::uint32_t other : observers.of(sighting.point->number)) {
      if (other != number && std::exchange(last_met_by[other], number) != number) ++count;
    }
  }
  return count;
}

}  // namespace

// A small file may contain keyframes that all observe the same point, whose covisibility takes quadratic memory.
bool has_too_many_covisible_keyframes(const std::vector<Keyframe>& keyframes, std::size_t point_count,
                                      std::size_t section_bytes) {
  constexpr std::size_t kAlwaysAllowed = std::size_t{1} << 19;
  const std::size_t allowed = kAlwaysAllowed + section_bytes / 2;
  if (keyframes.size() * keyframes.size() <= allowed) return false;
  const Observers observers = observers_of_points(keyframes, point_count);
  if (observers.count_pairs() <= allowed) return false;
  std::vector<std::uint32_t> last_met_by(keyframes.size(), std::numeric_limits<std::uint32_t>::max());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < keyframes.size() && count <= allowed; ++i) {
    count += count_covisible_keyframes(keyframes[i], i, observers, last_met_by);
  }
  return count > allowed;
}

}  // namespace byre
