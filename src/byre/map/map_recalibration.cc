#include "byre/features/recalibrated.h"
#include "byre/map/map.h"

#include <utility>

namespace byre {
namespace {

void recalibrate(Keyframe& keyframe, const RectifiedChange& change) {
  if (keyframe.frame.features) {
    keyframe.frame.features = std::make_shared<const Features>(recalibrated(*keyframe.frame.features, change));
  }
  for (Sighting& sighting : keyframe.sightings) {
    if (sighting.point) sighting.pixel = recalibrated(sighting.pixel, change);
  }
  keyframe.camera_from_world = change.after_from_before() * keyframe.camera_from_world;
  keyframe.covariance = move_covariance(keyframe.covariance, change.after_from_before());
}

}  // namespace

void Map::move_features(KeyframeId id, Features moved) {
  read_all();
  Keyframe* const keyframe = find_own_keyframe(id);
  if (keyframe == nullptr) return;
  const Features& before = *keyframe->frame.features;
  for (int i = 0; i < before.size(); ++i) {
    keyframe->sightings[static_cast<std::size_t>(i)].pixel += moved.keypoint(i).pixel - before.keypoint(i).pixel;
  }
  keyframe->frame.features = std::make_shared<const Features>(std::move(moved));
}

void Map::replace_features(KeyframeId id, std::shared_ptr<const Features> equal) {
  read_all();
  Keyframe* const keyframe = find_own_keyframe(id);
  if (keyframe != nullptr) keyframe->frame.features = std::move(equal);
}

void Map::keep_patches(KeyframeId id, std::span<const int> features) {
  read_all();
  Keyframe* const keyframe = find_own_keyframe(id);
  if (keyframe == nullptr || !keyframe->frame.features) return;
  keyframe->frame.features = std::make_shared<const Features>(keyframe->frame.features->with_patches_of(features));
}

int Map::rig_of(KeyframeId id) const {
  return slot(id).keyframe ? slot(id).keyframe->rig : slot(id).removed->rig;
}

void Map::recalibrate(int rig, const RectifiedChange& change) {
  read_all();
  const auto turn_of = [&](int other) { return other == rig ? change.after_from_before() : Pose{}; };
  for (KeyframeSlot& slot : keyframes_) {
    if (slot.keyframe && slot.keyframe->rig == rig) byre::recalibrate(*slot.keyframe, change);
    if (!slot.removed) continue;
    const Pose turned = turn_of(slot.removed->rig) * slot.removed->camera_from_parent;
    slot.removed->camera_from_parent = turned * inverse(turn_of(rig_of(slot.removed->parent)));
  }
  rigs_[static_cast<std::size_t>(rig)] = change.rig();
}

}  // namespace byre
