#include "byre/map/map_view.h"

namespace byre {

const MapPoint* MapView::find_point(PointId id) const {
  const Map* map = of(id.origin);
  return map ? map->find_point(id) : nullptr;
}

const Keyframe* MapView::find_keyframe(KeyframeId id) const {
  const Map* map = of(id.origin);
  return map ? map->find_keyframe(id) : nullptr;
}

const Rig& MapView::rig_of(const Keyframe& keyframe, KeyframeId id) const {
  return of(id.origin)->rigs()[static_cast<std::size_t>(keyframe.rig)];
}

}  // namespace byre
