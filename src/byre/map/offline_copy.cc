#include "byre/map/map_file.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace byre {
namespace {

// Where the things of one map are in another.
template <typename Id>
class Renumbering {
 public:
  // ids: ascending; they become 0, 1, 2 and so on.
  explicit Renumbering(std::vector<Id> ids) : ids_(std::move(ids)) {}

  const std::vector<Id>& ids() const { return ids_; }

  std::optional<Id> operator()(const std::optional<Id>& id) const {
    if (!id) return std::nullopt;
    const auto place = std::ranges::lower_bound(ids_, *id);
    if (place == ids_.end() || *place != *id) return std::nullopt;
    return Id{Origin::offline, static_cast<std::uint32_t>(place - ids_.begin())};
  }

 private:
  std::vector<Id> ids_;
};

// Those features, ascending, whose patch defines a point.
std::vector<int> features_that_define_points(const Map& map, KeyframeId id) {
  std::vector<int> features;
  const std::vector<Sighting>& sightings = map.find_keyframe(id)->sightings;
  for (int i = 0; i < static_cast<int>(sightings.size()); ++i) {
    const std::optional<PointId>& point = sightings[static_cast<std::size_t>(i)].point;
    const MapPoint* const seen = point ? map.find_point(*point) : nullptr;
    if (seen && seen->reference == Observation{id, i}) features.push_back(i);
  }
  return features;
}

bool has_patches(const Features& features) {
  for (int i = 0; i < features.size(); ++i) {
    if (features.find_patch(i)) return true;
  }
  return false;
}

std::shared_ptr<const Features> with_patches_of(const std::shared_ptr<const Features>& features, const Rig& rig,
                                                const std::vector<int>& kept) {
  if (!features || !has_patches(*features)) return features;
  std::vector<Patch> patches;
  std::vector<int> patch_of_keypoint(features->keypoints().size(), -1);
  for (const int i : kept) {
    const Patch* const patch = features->find_patch(i);
    if (!patch) continue;
    patch_of_keypoint[static_cast<std::size_t>(i)] = static_cast<int>(patches.size());
    patches.push_back(*patch);
  }
  return std::make_shared<const Features>(rig.width, rig.height, features->keypoints(), features->descriptors(),
                                          std::move(patches), std::move(patch_of_keypoint));
}

// Rounding makes covariances that are the product of matrices unsymmetric in their last digits.
template <typename Matrix>
Matrix symmetric(const Matrix& covariance) {
  return covariance.template selfadjointView<Eigen::Upper>();
}

}  // namespace

Map offline_copy(const Map& online) {
  const Renumbering<KeyframeId> keyframes(online.keyframe_ids());
  const Renumbering<PointId> points(online.point_ids());
  MapParts parts{online.rigs(), {}, {}};
  for (const KeyframeId id : keyframes.ids()) {
    Keyframe keyframe = *online.find_keyframe(id);
    const Rig& rig = online.rigs()[static_cast<std::size_t>(keyframe.rig)];
    keyframe.frame.features = with_patches_of(keyframe.frame.features, rig, features_that_define_points(online, id));
    for (Sighting& sighting : keyframe.sightings) {
      sighting.point = points(sighting.point);
      if (!sighting.point) sighting = {};
    }
    keyframe.parent = keyframes(keyframe.parent);
    keyframe.covariance = symmetric(keyframe.covariance);
    parts.keyframes.push_back(std::move(keyframe));
  }
  for (const PointId id : points.ids()) {
    MapPoint point = *online.find_point(id);
    point.reference.keyframe = keyframes(point.reference.keyframe).value();
    point.covariance = symmetric(point.covariance);
    parts.points.push_back(point);
  }
  return Map(Origin::offline, std::move(parts));
}

}  // namespace byre
