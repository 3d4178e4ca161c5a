#include "byre/slam/suspension.h"

#include <algorithm>

namespace byre {

Suspension::Record& Suspension::record_of(PointId id) {
  if (id.number >= records_.size()) records_.resize(id.number + std::size_t{1});
  return records_[id.number];
}

void Suspension::note(std::span<const PointId> agreed, std::span<const PointId> moved) {
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

bool Suspension::is_suspended(PointId id) const {
  return id.origin == Origin::offline && id.number < records_.size() && records_[id.number].suspended;
}

}  // namespace byre
