#pragma once

#include "byre/map/ids.h"
#include "byre/map/map.h"
#include "byre/workers/reused_memory.h"

#include <cstdint>
#include <span>
#include <vector>

namespace byre {

struct MovedPointsOptions {
  int frames = 8;            // surplus of frames that find a point elsewhere over frames that find it in its place
  int frames_to_return = 3;  // frames, one after the other, that find a suspended point in its place again
};

// Points found elsewhere that lie among others of them: a thing that was moved is a cluster in space, and a point that
// disagrees alone, among neighbours in place, was mistaken for another. All ascending.
ReusedVector<PointId> moved_together(const Map& offline, std::span<const PointId> agreed,
                                     std::span<const PointId> moved);

// Offline points that are not where the map has them: what they belong to was moved. They are left out until they are
// found in their places again; the map itself stays as it is.
class MovedPoints {
 public:
  explicit MovedPoints(const MovedPointsOptions& options) : options_(options) {}

  // Notes one frame whose pose offline points hold: the points found in their places, and those found elsewhere.
  void note(std::span<const PointId> agreed, std::span<const PointId> moved);
  // Notes where suspended points were found when they were looked for again.
  void note_again(std::span<const PointId> agreed, std::span<const PointId> moved);

  bool is_suspended(PointId id) const;
  int count() const { return count_; }

 private:
  struct Record {
    std::int16_t excess = 0;    // frames that found it elsewhere, less those that found it in its place; not below zero
    std::int16_t in_place = 0;  // frames one after the other that found it in its place while suspended
    bool suspended = false;
  };
  Record& record_of(PointId id);

  MovedPointsOptions options_;
  std::vector<Record> records_;  // by point number
  int count_ = 0;
};

}  // namespace byre
