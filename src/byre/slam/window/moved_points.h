#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/map/ids.h"
#include "byre/map/map_graph.h"

#include <cstdint>
#include <span>
#include <vector>

namespace byre {

struct MovedPointsOptions {
  int frames = 8;            // frames that find a point elsewhere, minus those that find it in place, to suspend it
  int frames_to_return = 3;  // consecutive frames that find a suspended point in place, to use it again
};

// Points found elsewhere that lie among others found elsewhere: a moved object is a cluster in space, and a single
// point among neighbours in place is a wrong match. All ascending.
ScratchVector<PointId> moved_together(const MapGraph& offline, std::span<const PointId> agreed,
                                      std::span<const PointId> moved);

// Offline points on objects that were moved. They are suspended until found in place again; the map does not change.
class MovedPoints {
 public:
  explicit MovedPoints(const MovedPointsOptions& options) : options_(options) {}

  // Adds a frame whose pose offline points constrain: points found in place, and points found elsewhere.
  void note(std::span<const PointId> agreed, std::span<const PointId> moved);
  // Adds the result of a new search of suspended points.
  void note_retest(std::span<const PointId> agreed, std::span<const PointId> moved);

  bool is_suspended(PointId id) const;
  int count() const { return count_; }

 private:
  struct Record {
    std::int16_t excess = 0;    // frames that found it elsewhere, minus those that found it in place; at least zero
    std::int16_t in_place = 0;  // consecutive frames that found it in place while suspended
    bool suspended = false;
  };
  Record& record_of(PointId id);

  MovedPointsOptions options_;
  std::vector<Record> records_;  // by point number
  int count_ = 0;
};

}  // namespace byre
