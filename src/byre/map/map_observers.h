#pragma once

#include "byre/base/byte_stream.h"
#include "byre/map/map_numbers.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace byre {

// Checks observations while sightings are read keyframe by keyframe. Fails for a point with two observations by one
// keyframe, and at the end for a point without observations.
class PointObservers {
 public:
  explicit PointObservers(std::size_t point_count) : last_observer_(point_count, kNoObserver) {}

  std::size_t point_count() const { return last_observer_.size(); }

  // Precondition: point < point_count().
  void add(const ByteReader& reader, std::uint32_t point, std::uint32_t keyframe) {
    if (last_observer_[point] == keyframe) require_no_fault(reader, "is observed twice by a keyframe", "point", point);
    last_observer_[point] = keyframe;
  }

  void require_all_observed(const ByteReader& reader) const {
    for (std::size_t point = 0; point < last_observer_.size(); ++point) {
      if (last_observer_[point] == kNoObserver)
        require_no_fault(reader, "is not observed by any keyframe", "point", point);
    }
  }

 private:
  static constexpr auto kNoObserver = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> last_observer_;  // number of the last keyframe that observes each point
};

}  // namespace byre
