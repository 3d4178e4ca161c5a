// What the keyframes see of the points.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kSightingBytes = 2 * sizeof(std::uint32_t) + 3 * sizeof(float);

std::uint32_t count_observations(const Keyframe& keyframe) {
  std::uint32_t count = 0;
  for (const Sighting& sighting : keyframe.sightings) count += sighting.point ? 1 : 0;
  return count;
}

// Reads the sightings of one keyframe after the other, and remembers who saw each point last.
class SightingReader {
 public:
  SightingReader(ByteReader& reader, std::size_t point_count) : reader_(reader), last_observer_(point_count, kNobody) {}

  void read(std::uint32_t number, Keyframe& keyframe) {
    const std::uint32_t count = reader_.read_count(kSightingBytes);
    std::size_t first_free_feature = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t feature = read_index(reader_, keyframe.sightings.size(), "feature");
      if (feature < first_free_feature) reader_.fail("has features out of order");
      first_free_feature = feature + 1;
      keyframe.sightings[feature] = read_sighting(number);
    }
  }

  void require_that_all_points_are_seen() const {
    for (std::size_t point = 0; point < last_observer_.size(); ++point) {
      if (last_observer_[point] == kNobody) require_no_fault(reader_, "is seen by no keyframe", "point", point);
    }
  }

 private:
  static constexpr auto kNobody = std::numeric_limits<std::uint32_t>::max();

  Sighting read_sighting(std::uint32_t keyframe) {
    const std::uint32_t point = read_index(reader_, last_observer_.size(), "point");
    if (last_observer_[point] == keyframe) require_no_fault(reader_, "is seen twice by a keyframe", "point", point);
    last_observer_[point] = keyframe;
    Sighting sighting{PointId{Origin::offline, point}, read_vector<Eigen::Vector2f>(reader_), reader_.read<float>()};
    require_no_fault(reader_, fault_in(sighting), "keyframe", keyframe);
    return sighting;
  }

  ByteReader& reader_;
  std::vector<std::uint32_t> last_observer_;  // number of the last keyframe that observes each point
};

bool observes(const std::vector<Keyframe>& keyframes, const Observation& observation, std::uint32_t point) {
  if (observation.keyframe.number >= keyframes.size()) return false;
  const std::vector<Sighting>& sightings = keyframes[observation.keyframe.number].sightings;
  const auto feature = static_cast<std::size_t>(observation.feature);
  return feature < sightings.size() && sightings[feature].point == PointId{Origin::offline, point};
}

// The keyframes that see each point.
std::vector<std::vector<std::uint32_t>> observers_of_points(const std::vector<Keyframe>& keyframes,
                                                            std::size_t point_count) {
  std::vector<std::vector<std::uint32_t>> observers(point_count);
  for (std::uint32_t i = 0; i < keyframes.size(); ++i) {
    for (const Sighting& sighting : keyframes[i].sightings) {
      if (sighting.point) observers[sighting.point->number].push_back(i);
    }
  }
  return observers;
}

std::size_t count_covisible_keyframes(const Keyframe& keyframe, std::uint32_t number,
                                      const std::vector<std::vector<std::uint32_t>>& observers,
                                      std::vector<std::uint32_t>& last_met_by) {
  std::size_t count = 0;
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    for (const std::uint32_t other : observers[sighting.point->number]) {
      if (other != number && std::exchange(last_met_by[other], number) != number) ++count;
    }
  }
  return count;
}

// A small file may describe keyframes that all see the same point: the map then keeps the square of their number.
bool has_too_many_covisible_keyframes(const std::vector<Keyframe>& keyframes, std::size_t point_count,
                                      std::size_t section_bytes) {
  constexpr std::size_t kAlwaysAllowed = std::size_t{1} << 19;
  const std::size_t allowed = kAlwaysAllowed + section_bytes / 2;
  if (keyframes.size() * keyframes.size() <= allowed) return false;
  const auto observers = observers_of_points(keyframes, point_count);
  std::vector<std::uint32_t> last_met_by(keyframes.size(), std::numeric_limits<std::uint32_t>::max());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < keyframes.size() && count <= allowed; ++i) {
    count += count_covisible_keyframes(keyframes[i], i, observers, last_met_by);
  }
  return count > allowed;
}

}  // namespace

void write_observations(const Keyframes& keyframes, ByteWriter& writer) {
  for (const Keyframe* const keyframe : keyframes) {
    writer.write(count_observations(*keyframe));
    for (std::uint32_t i = 0; i < keyframe->sightings.size(); ++i) {
      const Sighting& sighting = keyframe->sightings[i];
      if (!sighting.point) continue;
      writer.write(i);
      writer.write(sighting.point->number);
      write_vector(sighting.pixel, writer);
      writer.write(sighting.pixel_sigma);
    }
  }
}

void read_observations(ByteReader reader, const std::vector<MapPoint>& points, std::vector<Keyframe>& keyframes) {
  const std::size_t section_bytes = reader.remaining();
  SightingReader sightings(reader, points.size());
  for (std::uint32_t i = 0; i < keyframes.size(); ++i) sightings.read(i, keyframes[i]);
  reader.require_end();
  sightings.require_that_all_points_are_seen();
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (observes(keyframes, points[i].reference, i)) continue;
    require_no_fault(reader, "has a reference that does not see it", "point", i);
  }
  if (has_too_many_covisible_keyframes(keyframes, points.size(), section_bytes)) {
    reader.fail("has more keyframes that share points than a file of this size can hold");
  }
}

}  // namespace byre
