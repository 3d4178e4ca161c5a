#include "byre/features/jpeg.h"
#include "byre/map/map_file.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

namespace byre {
namespace {

// Maps ids of one map to those of another.
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

// Features of a keyframe that are the reference of a point, ascending.
std::vector<int> features_that_define_points(const MapGraph& map, KeyframeId id,
                                             const std::vector<Sighting>& sightings) {
  std::vector<int> features;
  for (int i = 0; i < static_cast<int>(sightings.size()); ++i) {
    const std::optional<PointId>& point = sightings[static_cast<std::size_t>(i)].point;
    const MapPoint* const seen = point ? map.find_point(*point) : nullptr;
    if (seen && seen->reference == Observation{id, i}) features.push_back(i);
  }
  return features;
}

// The features in the given order, with the patches of kept_patches.
std::shared_ptr<const Features> for_keeping(const Features& features, const Rig& rig, const std::vector<int>& order,
                                            const std::vector<int>& kept_patches) {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  std::vector<Patch> patches;
  std::vector<int> patch_of_keypoint;
  for (const int i : order) {
    keypoints.push_back(features.keypoint(i));
    if (!features.descriptors().empty()) descriptors.push_back(features.descriptor(i));
    const Patch* const patch = std::ranges::binary_search(kept_patches, i) ? features.find_patch(i) : nullptr;
    patch_of_keypoint.push_back(patch ? static_cast<int>(patches.size()) : -1);
    if (patch) patches.push_back(*patch);
  }
  return std::make_shared<const Features>(rig.width, rig.height, std::move(keypoints), std::move(descriptors),
                                          std::move(patches), std::move(patch_of_keypoint));
}

// Features with a point, in the order of a file: the grid of their order depends on their positions and their number.
std::vector<int> order_of_features_with_points(const Keyframe& keyframe, const Rig& rig) {
  std::vector<int> with_point;
  std::vector<Keypoint> keypoints;
  for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
    if (!keyframe.sightings[i].point) continue;
    with_point.push_back(static_cast<int>(i));
    keypoints.push_back(keyframe.frame.features->keypoint(static_cast<int>(i)));
  }
  std::vector<int> order = Features::order_of(rig.width, rig.height, keypoints);
  for (int& i : order) i = with_point[static_cast<std::size_t>(i)];
  return order;
}

// Drops a keyframe's features without a point, with sightings and words. Returns the new index of each feature, or -1.
std::vector<int> keep_features_with_points(Keyframe& keyframe, const Rig& rig, const std::vector<int>& kept_patches) {
  if (!keyframe.frame.features) return {};
  const std::vector<int> order = order_of_features_with_points(keyframe, rig);
  std::vector<int> number_of(keyframe.sightings.size(), -1);
  std::vector<Sighting> sightings;
  std::vector<Word> words;
  for (const int before : order) {
    number_of[static_cast<std::size_t>(before)] = static_cast<int>(sightings.size());
    sightings.push_back(keyframe.sightings[static_cast<std::size_t>(before)]);
    if (!keyframe.words.empty()) words.push_back(keyframe.words[static_cast<std::size_t>(before)]);
  }
  keyframe.frame.features = for_keeping(*keyframe.frame.features, rig, order, kept_patches);
  keyframe.sightings = std::move(sightings);
  keyframe.words = std::move(words);
  return number_of;
}

// Restores symmetry, which rounding in matrix products loses.
template <typename Matrix>
Matrix symmetric(const Matrix& covariance) {
  return covariance.template selfadjointView<Eigen::Upper>();
}

// take returns each keyframe, ascending. is_done is called when the map is no longer needed.
MapGraph made_offline(const MapGraph& online, const std::function<Keyframe(KeyframeId)>& take,
                      const std::function<void()>& is_done) {
  const Renumbering<KeyframeId> keyframes(online.keyframe_ids());
  const Renumbering<PointId> points(online.point_ids());
  MapParts parts{online.rigs(), {}, {}};
  std::vector<std::vector<int>> feature_numbers;  // new index of each feature of a keyframe, by keyframe number
  for (const KeyframeId id : keyframes.ids()) {
    Keyframe keyframe = take(id);
    const Rig& rig = online.rigs()[static_cast<std::size_t>(keyframe.rig)];
    const std::vector<int> defining = features_that_define_points(online, id, keyframe.sightings);
    for (Sighting& sighting : keyframe.sightings) sighting.point = points(sighting.point);
    feature_numbers.push_back(keep_features_with_points(keyframe, rig, defining));
    keyframe.parent = keyframes(keyframe.parent);
    keyframe.covariance = symmetric(keyframe.covariance);
    if (const auto picture = std::exchange(keyframe.frame.picture, nullptr)) {
      keyframe.picture = StoredPicture(encode_jpeg(*picture, StoredPicture::kMadeBytes));
    }
    parts.keyframes.push_back(std::move(keyframe));
  }
  parts.points.reserve(points.ids().size());
  for (const PointId id : points.ids()) {
    MapPoint point = *online.find_point(id);
    point.reference.keyframe = keyframes(point.reference.keyframe).value();
    point.reference.feature =
        feature_numbers[point.reference.keyframe.number][static_cast<std::size_t>(point.reference.feature)];
    point.covariance = symmetric(point.covariance);
    parts.points.push_back(point);
  }
  is_done();
  return MapGraph(Origin::offline, std::move(parts));
}

}  // namespace

MapGraph offline_copy(const MapGraph& online) {
  return made_offline(
      online, [&online](KeyframeId id) { return *online.find_keyframe(id); }, [] {});
}

MapGraph offline_copy(MapGraph&& online) {
  return made_offline(
      online, [&online](KeyframeId id) { return online.take_keyframe(id); },
      [&online] { online = MapGraph(online.origin()); });
}

}  // namespace byre
