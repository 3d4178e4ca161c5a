#pragma once

#include "byre/map/map.h"

namespace byre {

// Reads the offline and the online map as one. Borrows both; the offline map may be absent (nullptr).
class MapView {
 public:
  MapView(const Map* offline, const Map& online) : offline_(offline), online_(&online) {}

  const Map* offline() const { return offline_; }
  const Map& online() const { return *online_; }

  const MapPoint* find_point(PointId id) const;        // nullptr when it is gone
  const Keyframe* find_keyframe(KeyframeId id) const;  // nullptr when it is gone
  const Rig& rig_of(const Keyframe& keyframe, KeyframeId id) const;

 private:
  const Map* of(Origin origin) const { return origin == Origin::offline ? offline_ : online_; }

  const Map* offline_;
  const Map* online_;
};

}  // namespace byre
