#include "byre/map/map_view.h"

namespace byre {
namespace {

const MapGraph& nothing_online() {
  static const MapGraph nothing(Origin::online);
  return nothing;
}

}  // namespace

MapView::MapView(const MapGraph& map)
    : MapView(map.origin() == Origin::offline ? &map : nullptr,
              map.origin() == Origin::offline ? nothing_online() : map) {}

const MapPoint* MapView::find_point(PointId id) const {
  const MapGraph* map = of(id.origin);
  return map ? map->find_point(id) : nullptr;
}

const Keyframe* MapView::find_keyframe(KeyframeId id) const {
  const MapGraph* map = of(id.origin);
  return map ? map->find_keyframe(id) : nullptr;
}

const Keyframe* MapView::keyframe_header(KeyframeId id) const {
  const MapGraph* map = of(id.origin);
  return map ? map->keyframe_header(id) : nullptr;
}

const Rig& MapView::rig_of(const Keyframe& keyframe, KeyframeId id) const {
  return of(id.origin)->rigs()[static_cast<std::size_t>(keyframe.rig)];
}

ScratchVector<Covisible> MapView::covisible_keyframes(KeyframeId id, int max_count) const {
  const MapGraph* const map = of(id.origin);
  return map == nullptr ? ScratchVector<Covisible>{} : map->covisible_keyframes(id, max_count);
}

}  // namespace byre
