#pragma once

#include "byre/map/ids.h"

#include <cstdint>
#include <span>
#include <vector>

namespace byre {

struct SuspensionOptions {
  int frames = 8;  // by which a point was found elsewhere more often than in its place
};

// Offline points that are not where the map has them: what they belong to was moved. They are left out for the rest of
// the mission; the map itself stays as it is.
class Suspension {
 public:
  explicit Suspension(const SuspensionOptions& options) : options_(options) {}

  // Of one frame with a pose: which offline points were found in their places, and which elsewhere.
  void note(std::span<const PointId> agreed, std::span<const PointId> moved);

  bool is_suspended(PointId id) const;
  int count() const { return count_; }

 private:
  struct Record {
    std::int16_t excess = 0;  // frames that found it elsewhere, less those that found it in its place; not below zero
    bool suspended = false;
  };
  Record& record_of(PointId id);

  SuspensionOptions options_;
  std::vector<Record> records_;  // by point number
  int count_ = 0;
};

}  // namespace byre
