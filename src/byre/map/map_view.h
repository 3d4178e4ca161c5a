#pragma once

#include "byre/map/map_graph.h"

#include <algorithm>

namespace byre {

// Reads the offline and the online map as one. Borrows both; each may be absent.
class MapView {
 public:
  MapView(const MapGraph* offline, const MapGraph& online) : offline_(offline), online_(&online) {}
  // NOLINTNEXTLINE(google-explicit-constructor): one map, of either origin, can be read wherever two can
  MapView(const MapGraph& map);

  const MapGraph* offline() const { return offline_; }
  const MapGraph& online() const { return *online_; }

  const MapPoint* find_point(PointId id) const;          // nullptr if it does not exist
  const Keyframe* find_keyframe(KeyframeId id) const;    // nullptr if it does not exist
  const Keyframe* keyframe_header(KeyframeId id) const;  // see MapGraph
  const Rig& rig_of(const Keyframe& keyframe, KeyframeId id) const;

  // Calls visit(observation) for every observation of the point by keyframes of both maps.
  template <typename Visitor>
  void visit_observations(PointId id, Visitor visit) const {
    if (offline_ != nullptr) std::ranges::for_each(offline_->observations(id), visit);
    std::ranges::for_each(online_->observations(id), visit);
  }

  // Also visits foreign views.
  template <typename Visitor>
  void visit_views(PointId id, Visitor visit) const {
    visit_observations(id, visit);
    for (const ForeignView& view : online_->foreign_views(id)) visit(view.observation);
  }

  // Keyframes of the same map with points in common, most first.
  ScratchVector<Covisible> covisible_keyframes(KeyframeId id, int max_count) const;

 private:
  const MapGraph* of(Origin origin) const { return origin == Origin::offline ? offline_ : online_; }

  const MapGraph* offline_;
  const MapGraph* online_;
};

// Copy of the online map that does not depend on the offline one. Offline points with online observations become its
// own points, with their first online observation as reference; foreign views are omitted.
MapGraph standalone_copy(const MapView& map);

}  // namespace byre
