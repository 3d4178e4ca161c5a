#include "byre/features/recalibrated.h"
#include "byre/map/map_graph.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

// made: converted features of this keyframe, or nullptr.
void recalibrate(Keyframe& keyframe, const RectifiedChange& change, const RecalibratedFeatures* made) {
  std::shared_ptr<const Features>& features = keyframe.frame.features;
  if (made != nullptr && made->before == features) {
    features = made->after;
  } else if (features) {
    features = std::make_shared<const Features>(recalibrated(*features, change));
  }
  for (Sighting& sighting : keyframe.sightings) {
    if (sighting.point) sighting.pixel = recalibrated(sighting.pixel, change);
  }
  recalibrate_tags(keyframe.frame.tags, change);
  keyframe.camera_from_world = change.after_from_before() * keyframe.camera_from_world;
  keyframe.covariance = move_covariance(keyframe.covariance, change.after_from_before());
}

// The point moved to the pixel of its image after the change, at the same depth in the view.
Eigen::Vector3d recalibrated_point(const Eigen::Vector3d& point_in_world, const Pose& camera_from_world,
                                   const Rig& before, const RectifiedChange& change) {
  const Eigen::Vector3d point_in_camera = camera_from_world * point_in_world;
  if (point_in_camera.z() <= 0.0) return point_in_world;
  const Eigen::Vector2d pixel = change({before.project(point_in_camera)}).pixel.head<2>();
  const Pose after_from_world = change.after_from_before() * camera_from_world;
  return inverse(after_from_world) * ((after_from_world * point_in_world).z() * change.rig().ray(pixel));
}

}  // namespace

void MapGraph::move_features(KeyframeId id, Features moved) {
  read_all();
  if (find_own_keyframe(id) == nullptr) return;
  Keyframe& keyframe = edit_keyframe(id);
  const Features& before = *keyframe.frame.features;
  for (int i = 0; i < before.size(); ++i) {
    keyframe.sightings[static_cast<std::size_t>(i)].pixel += moved.keypoint(i).pixel - before.keypoint(i).pixel;
  }
  keyframe.frame.features = std::make_shared<const Features>(std::move(moved));
}

void MapGraph::replace_features(KeyframeId id, std::shared_ptr<const Features> equal) {
  read_all();
  if (find_own_keyframe(id) != nullptr) edit_keyframe(id).frame.features = std::move(equal);
}

void MapGraph::keep_patches(KeyframeId id, std::span<const int> features) {
  read_all();
  const Keyframe* const keyframe = find_own_keyframe(id);
  if (keyframe == nullptr || !keyframe->frame.features) return;
  edit_keyframe(id).frame.features =
      std::make_shared<const Features>(keyframe->frame.features->with_patches_of(features));
}

int MapGraph::rig_of(KeyframeId id) const {
  return slot(id).keyframe ? slot(id).keyframe->rig : slot(id).removed->rig;
}

void MapGraph::recalibrate(int rig, const RectifiedChange& change, std::span<const RecalibratedFeatures> made) {
  read_all();
  const auto made_of = [&](std::size_t number) {
    const KeyframeId id{origin_, static_cast<std::uint32_t>(number)};
    const auto found = std::ranges::lower_bound(made, id, {}, &RecalibratedFeatures::keyframe);
    return found != made.end() && found->keyframe == id ? &*found : nullptr;
  };
  const Rig before = rigs_[static_cast<std::size_t>(rig)];
  if (!before.is_stereo()) {
    for (const PointId id : point_ids()) {
      MapPoint point = *find_point(id);
      const Keyframe* const view = find_own_keyframe(point.reference.keyframe);
      if (view == nullptr || view->rig != rig) continue;
      point.position_in_world = recalibrated_point(point.position_in_world, view->camera_from_world, before, change);
      update_point(id, point);
    }
  }
  const auto turn_of = [&](int other) { return other == rig ? change.after_from_before() : Pose{}; };
  for (std::size_t number = 0; number < keyframes_.size(); ++number) {
    KeyframeSlot& slot = keyframes_[number].edit();
    if (slot.keyframe && slot.keyframe->rig == rig) byre::recalibrate(*slot.keyframe, change, made_of(number));
    if (!slot.removed) continue;
    const Pose turned = turn_of(slot.removed->rig) * slot.removed->camera_from_parent;
    slot.removed->camera_from_parent = turned * inverse(turn_of(rig_of(slot.removed->parent)));
  }
  rigs_[static_cast<std::size_t>(rig)] = change.rig();
}

}  // namespace byre
