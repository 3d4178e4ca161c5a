#pragma once

#include "byre/map/map.h"

#include <algorithm>
#include <vector>

namespace byre {

// Reads the offline and the online map as one. Borrows both; the offline map may be absent (nullptr).
class MapView {
 public:
  MapView(const Map* offline, const Map& online) : offline_(offline), online_(&online) {}
  // NOLINTNEXTLINE(google-explicit-constructor): an online map alone can be read wherever two can
  MapView(const Map& online) : MapView(nullptr, online) {}

  const Map* offline() const { return offline_; }
  const Map& online() const { return *online_; }

  const MapPoint* find_point(PointId id) const;             // nullptr when it is gone
  const Keyframe* find_keyframe(KeyframeId id) const;       // nullptr when it is gone
  const Keyframe* find_bare_keyframe(KeyframeId id) const;  // as Map's
  const Rig& rig_of(const Keyframe& keyframe, KeyframeId id) const;

  // Calls visit(observation) for every keyframe, of both maps, that sees the point.
  template <typename Visitor>
  void visit_observations(PointId id, Visitor visit) const {
    if (offline_ != nullptr) std::ranges::for_each(offline_->observations(id), visit);
    std::ranges::for_each(online_->observations(id), visit);
  }

  // Calls visit(observation) for every keyframe that sees the point, also through a foreign view.
  template <typename Visitor>
  void visit_views(PointId id, Visitor visit) const {
    visit_observations(id, visit);
    for (const ForeignView& view : online_->foreign_views(id)) visit(view.observation);
  }

  // Keyframes of the same map that share points with this one, most shared first.
  ReusedVector<Covisible> covisible_keyframes(KeyframeId id, int max_count) const;

 private:
  const Map* of(Origin origin) const { return origin == Origin::offline ? offline_ : online_; }

  const Map* offline_;
  const Map* online_;
};

// The online map as one that stands alone, to be kept: the offline points that its keyframes see become points of its
// own, defined by the first of their online views, and foreign views are left out.
Map standalone_copy(const MapView& map);

}  // namespace byre
