#include "tiled_map.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <utility>

namespace byre {
namespace {

constexpr int kFlippedBits = 3;  // bits flipped in each point's descriptor
constexpr double kGap = 10.0;    // metres between copies

Descriptor difference(const Descriptor& one, const Descriptor& other) {
  Descriptor result;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = one[i] ^ other[i];
  return result;
}

// The first keyframes of a map and the points that they define.
MapParts parts_of(const MapGraph& map, std::uint32_t keyframes) {
  MapParts parts{map.rigs(), {}, {}};
  std::vector<std::optional<PointId>> kept(static_cast<std::size_t>(map.point_count()));
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    if (point.reference.keyframe.number >= keyframes) continue;
    kept[id.number] = PointId{Origin::offline, static_cast<std::uint32_t>(parts.points.size())};
    parts.points.push_back(point);
  }
  for (std::uint32_t i = 0; i < keyframes; ++i) {
    parts.keyframes.push_back(*map.find_keyframe({Origin::offline, i}));
    for (Sighting& sighting : parts.keyframes.back().sightings) {
      if (sighting.point) sighting.point = kept[sighting.point->number];
    }
  }
  return parts;
}

// Placement of copies: side by side on the ground plane.
class Ground {
 public:
  Ground(const MapParts& one, int copies)
      : columns_(static_cast<int>(std::ceil(std::sqrt(static_cast<double>(copies))))) {
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (const Keyframe& keyframe : one.keyframes) {
      up -= keyframe.camera_from_world.rotation.conjugate() * Eigen::Vector3d::UnitY();
    }
    const Eigen::Vector3d along = up.normalized().unitOrthogonal();
    along_ = extent(one, along) * along;
    const Eigen::Vector3d across = up.normalized().cross(along);
    across_ = extent(one, across) * across;
  }

  Eigen::Vector3d place_of(int copy) const { return copy / columns_ * along_ + copy % columns_ * across_; }

 private:
  static double extent(const MapParts& one, const Eigen::Vector3d& direction) {
    double least = 0.0, most = 0.0;
    for (const MapPoint& point : one.points) {
      least = std::min(least, direction.dot(point.position_in_world));
      most = std::max(most, direction.dot(point.position_in_world));
    }
    return most - least + kGap;
  }

  int columns_;
  Eigen::Vector3d along_, across_;
};

void shuffle_descriptors(MapParts& parts, int copy) {
  std::mt19937_64 random(static_cast<std::uint64_t>(copy));
  std::vector<std::size_t> order(parts.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::shuffle(order, random);
  std::vector<Descriptor> shuffled;
  for (const std::size_t from : order) {
    Descriptor& descriptor = shuffled.emplace_back(parts.points[from].descriptor);
    for (int i = 0; i < kFlippedBits; ++i) descriptor[random() % 4] ^= std::uint64_t{1} << random() % 64;
  }
  for (std::size_t i = 0; i < shuffled.size(); ++i) parts.points[i].descriptor = shuffled[i];
}

std::shared_ptr<const Features> with_descriptors(const Features& features, const Rig& rig,
                                                 std::vector<Descriptor> descriptors) {
  std::vector<Patch> patches;
  std::vector<int> patch_of_keypoint(descriptors.size(), -1);
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const Patch* const patch = features.find_patch(static_cast<int>(i));
    if (patch == nullptr) continue;
    patch_of_keypoint[i] = static_cast<int>(patches.size());
    patches.push_back(*patch);
  }
  return std::make_shared<const Features>(rig.width, rig.height, to_vector(features.keypoints()),
                                          std::move(descriptors), std::move(patches), std::move(patch_of_keypoint));
}

// Updates a keyframe's features whose points have new descriptors.
void follow_points(const std::vector<MapPoint>& before, const MapParts& parts, const Vocabulary& vocabulary,
                   Keyframe& keyframe) {
  std::vector<Descriptor> descriptors = to_vector(keyframe.frame.features->descriptors());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const std::optional<PointId>& point = keyframe.sightings[i].point;
    if (!point) continue;
    descriptors[i] = difference(difference(descriptors[i], before[point->number].descriptor),
                                parts.points[point->number].descriptor);
  }
  keyframe.frame.features = with_descriptors(
      *keyframe.frame.features, parts.rigs[static_cast<std::size_t>(keyframe.rig)], std::move(descriptors));
  keyframe.words = vocabulary.words_of(*keyframe.frame.features);
}

void append(MapParts copy, const Eigen::Vector3d& shift, Timestamp later, MapParts& site) {
  const auto first_keyframe = static_cast<std::uint32_t>(site.keyframes.size());
  const auto first_point = static_cast<std::uint32_t>(site.points.size());
  for (Keyframe& keyframe : copy.keyframes) {
    keyframe.frame.time += later;
    keyframe.camera_from_world.translation -= keyframe.camera_from_world.rotation * shift;
    if (keyframe.parent) keyframe.parent->number += first_keyframe;
    for (Sighting& sighting : keyframe.sightings) {
      if (sighting.point) sighting.point = PointId{Origin::offline, sighting.point->number + first_point};
    }
    site.keyframes.push_back(std::move(keyframe));
  }
  for (MapPoint& point : copy.points) {
    point.position_in_world += shift;
    point.reference.keyframe.number += first_keyframe;
    site.points.push_back(point);
  }
}

}  // namespace

StoredMap tiled_map(const StoredMap& one, int keyframes, const Vocabulary& vocabulary) {
  const int each = one.map.keyframe_count();
  const int copies = (keyframes + each - 1) / each;
  const Ground ground(parts_of(one.map, static_cast<std::uint32_t>(each)), copies);
  const Timestamp duration =
      one.recordings.front().last_time - one.recordings.front().first_time + std::chrono::seconds(1);
  StoredMap site = one;
  site.plan.reset();
  MapParts parts{one.map.rigs(), {}, {}};
  for (int copy = 0; copy < copies; ++copy) {
    MapParts tile = parts_of(one.map, static_cast<std::uint32_t>(std::min(each, keyframes - copy * each)));
    if (copy > 0) {
      const std::vector<MapPoint> before = tile.points;
      shuffle_descriptors(tile, copy);
      for (Keyframe& keyframe : tile.keyframes) follow_points(before, tile, vocabulary, keyframe);
    }
    append(std::move(tile), ground.place_of(copy), copy * duration, parts);
  }
  site.recordings.front().last_time += copies * duration;
  site.map = MapGraph(Origin::offline, std::move(parts));
  return site;
}

MapGraph driven_field(int keyframes) {
  constexpr int kLane = 120;
  constexpr double kStep = 0.5;      // metres between keyframes
  constexpr double kBetween = 3.0;   // metres between lanes
  constexpr double kUneven = 0.005;  // metres of unevenness
  Rig rig{752, 480, 400.0, 376.0, 240.0, 0.11, {}};
  // Forward-looking camera: its z axis is x of the body.
  rig.body_from_camera.rotation = Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5);
  MapParts parts{{rig}, std::vector<Keyframe>(static_cast<std::size_t>(keyframes)), {}};
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < keyframes; ++i) {
    const int lane = i / kLane, step = i % kLane;
    const bool is_back = lane % 2 == 1;
    const Eigen::Vector3d place(kStep * (is_back ? kLane - 1 - step : step), kBetween * lane, kUneven * normal(random));
    const Pose body{Eigen::Quaterniond(is_back ? 0.0 : 1.0, 0.0, 0.0, is_back ? 1.0 : 0.0), place};
    Keyframe& keyframe = parts.keyframes[static_cast<std::size_t>(i)];
    keyframe.frame.time = std::chrono::seconds(i);
    keyframe.camera_from_world = inverse(body * rig.body_from_camera);
  }
  return {Origin::offline, std::move(parts)};
}

}  // namespace byre
