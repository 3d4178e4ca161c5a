#pragma once

#include "byre/input_error.h"
#include "byre/map/map_upkeep.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <string>

namespace byre {

// A small map with all that a map file can contain: two recordings, rigs with and without a baseline, a keyframe
// without features, features with and without patches and disparities, keyframes with and without words, and two
// keyframes without parent. Independent of a map's functions, so that its bytes are constant.
class StoredMapScene {
 public:
  explicit StoredMapScene(int keyframes = 5, int features = 9, std::uint64_t seed = 1)
      : random_(seed), features_(features) {
    add_origin();
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(keyframes); ++i) parts_.keyframes.push_back(keyframe(i));
    add_points();
    Keyframe empty = keyframe(static_cast<std::uint32_t>(keyframes));
    empty.frame.features = std::make_shared<const Features>();
    empty.sightings.clear();
    empty.words.clear();
    parts_.keyframes.push_back(empty);
    stored_.map = MapGraph(Origin::offline, parts_);
  }

  const StoredMap& stored() const { return stored_; }
  // With a registration on a floor plan.
  StoredMap stored_with_plan() const {
    StoredMap stored = stored_;
    stored.plan.emplace();
    stored.plan->plan = "barn 3, ground floor";
    stored.plan->plan_from_map.scale = 1.25;
    stored.plan->plan_from_map.target_from_source = {{0.8, 0.0, 0.0, 0.6}, {12.5, -3.25, 0.0}};
    stored.plan->covariance = 1e-4 * Matrix7::Identity();
    stored.plan->covariance(0, 5) = stored.plan->covariance(5, 0) = 1e-6;
    return stored;
  }
  // For maps that differ in one detail.
  const MapParts& parts() const { return parts_; }

 private:
  float between(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 40) / static_cast<float>(1 << 24);
  }

  Pose pose() {
    Pose pose;
    pose.rotation.coeffs() << between(-1, 1), between(-1, 1), between(-1, 1), 2.0;
    pose.rotation.normalize();
    pose.translation << between(-5, 5), between(-5, 5), between(0, 2);
    return pose;
  }

  void add_origin() {
    const Camera left{CameraModel::radial_tangential, 320, 240, 190.0, 191.0, 158.5, 119.5, {-0.28, 0.07, 2e-4, 1e-5}};
    const Camera fisheye{CameraModel::equidistant, 200, 160, 90.0, 91.0, 99.5, 79.5, {0.01, -0.002, 0.0, 0.0}};
    const Calibration stereo{left, StereoPartner{left, pose()}, pose()};
    stored_.recordings = {
        {"barn_morning", stereo, std::chrono::seconds(100), std::chrono::seconds(200)},
        {"barn_evening", {fisheye, std::nullopt, {}}, std::chrono::seconds(300), std::chrono::seconds(300)}};
    parts_.rigs = {{320, 240, 188.0, 158.0, 119.0, 0.11, pose()}, {200, 160, 88.0, 99.0, 79.0, 0.0, {}}};
    stored_.notes = {{"site", "barn 3"}, {"software", "byre"}};
    stored_.vocabulary_checksum = 0x0123456789abcdef;
    stored_.pose_source = PoseSource::given;
  }

  Keypoint keypoint(const Rig& rig, int number) {
    Keypoint keypoint;
    keypoint.pixel = {between(0, static_cast<float>(rig.width - 1)), between(0, static_cast<float>(rig.height - 1))};
    if (rig.is_stereo() && number % 3 > 0) {
      keypoint.disparity = between(1, 40);
      keypoint.disparity_sigma = 0.25f;
    }
    keypoint.angle = between(-3, 3);
    keypoint.response = between(20, 120);
    keypoint.octave = static_cast<std::uint8_t>(number % kOctaves);
    return keypoint;
  }

  // Noise, or a slope with a little noise.
  Patch patch(bool is_noise) {
    Patch patch;
    for (std::uint64_t i = 0; i < patch.pixels.size(); ++i) {
      patch.pixels[i] = static_cast<std::uint8_t>(is_noise ? random_() >> 56 : (random_() >> 59) + 12 * (i % 16));
    }
    patch.centre = Eigen::Vector2f::Constant(Patch::kSize / 2);
    return patch;
  }

  // Every second feature has a patch.
  std::shared_ptr<const Features> features(const Rig& rig) {
    const auto count = static_cast<std::size_t>(features_);
    std::vector<Keypoint> keypoints;
    std::vector<Descriptor> descriptors(count);
    std::vector<Patch> patches((count + 1) / 2);
    std::vector<int> patch_of_keypoint(count, -1);
    for (int i = 0; i < features_; ++i) {
      keypoints.push_back(keypoint(rig, i));
      if (i % 2 == 0) patch_of_keypoint[static_cast<std::size_t>(i)] = i / 2;
    }
    for (Descriptor& descriptor : descriptors) std::ranges::generate(descriptor, std::ref(random_));
    for (std::size_t i = 0; i < patches.size(); ++i) patches[i] = patch(i % 2 == 0);
    return std::make_shared<const Features>(rig.width, rig.height, keypoints, descriptors, patches, patch_of_keypoint);
  }

  Keyframe keyframe(std::uint32_t number) {
    Keyframe keyframe;
    keyframe.rig = number % 4 == 3 ? 1 : 0;
    keyframe.recording = keyframe.rig;
    keyframe.frame.time = std::chrono::seconds(100) + number * std::chrono::milliseconds(50);
    keyframe.frame.features = features(parts_.rigs[static_cast<std::size_t>(keyframe.rig)]);
    keyframe.camera_from_world = pose();
    keyframe.covariance = 1e-4 * Matrix6::Identity();
    keyframe.covariance(0, 5) = keyframe.covariance(5, 0) = 1e-6;
    if (number > 0 && keyframe.rig == 0) keyframe.parent = KeyframeId{Origin::offline, number - 1};
    keyframe.sightings.resize(static_cast<std::size_t>(features_));
    if (number % 2 == 0) {
      for (int i = 0; i < features_; ++i) keyframe.words.push_back(static_cast<Word>(random_() >> 48));
    }
    return keyframe;
  }

  // Point i is feature i of up to three consecutive keyframes; the last feature of each keyframe has no point.
  void add_points() {
    const auto seen_features = static_cast<std::uint32_t>(features_ - 1);
    for (std::uint32_t first = 0; first < parts_.keyframes.size(); first += 3) {
      const auto end = std::min<std::uint32_t>(first + 3, static_cast<std::uint32_t>(parts_.keyframes.size()));
      for (std::uint32_t feature = 0; feature < seen_features; ++feature) {
        for (std::uint32_t i = first; i < end; ++i) add_sighting(i, feature);
        parts_.points.push_back(point({{Origin::offline, end - 1}, static_cast<int>(feature)}));
      }
    }
  }

  // Adds a sighting of the point that is added next.
  void add_sighting(std::uint32_t number, std::uint32_t feature) {
    Keyframe& keyframe = parts_.keyframes[number];
    const PointId point{Origin::offline, static_cast<std::uint32_t>(parts_.points.size())};
    const Eigen::Vector2f pixel = keyframe.frame.features->keypoint(static_cast<int>(feature)).pixel;
    keyframe.sightings[feature] = {point, pixel + Eigen::Vector2f(0.25f, -0.125f), 0.5f};
  }

  MapPoint point(const Observation& reference) {
    MapPoint point;
    point.position_in_world << between(-10, 10), between(-10, 10), between(-1, 3);
    point.covariance = 1e-3 * Eigen::Matrix3d::Identity();
    point.covariance(0, 2) = point.covariance(2, 0) = 1e-5;
    point.mean_viewing_direction = Eigen::Vector3f(between(-1, 1), between(-1, 1), 1.0f).normalized();
    point.descriptor = parts_.keyframes[reference.keyframe.number].frame.features->descriptor(reference.feature);
    point.min_distance = between(0.5, 1);
    point.max_distance = between(2, 4);
    point.reference = reference;
    return point;
  }

  std::mt19937_64 random_;
  int features_;
  MapParts parts_;
  StoredMap stored_;
};

// Error on reading the bytes; empty for a valid map.
inline std::string refusal_of(std::span<const std::byte> bytes) {
  try {
    read_map(bytes, "barn.byre");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

inline StoredMap with_refined_calibration(StoredMap stored) {
  RefinedCalibration refined;
  refined.calibration = changed(stored.recordings.front().calibration, CalibrationVector::Constant(0.5));
  refined.change.setConstant(0.5);
  refined.sigma_before.setConstant(2.0);
  refined.sigma_after.setConstant(0.125);
  refined.keyframes = 41;
  refined.observations = 12345;
  refined.shift = 0.25;
  stored.recordings.front().refined = refined;
  return stored;
}

// Every second keyframe gets a picture, which is no real JPEG file.
inline StoredMap with_pictures(StoredMap stored) {
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    if (id.number % 2 != 0) continue;
    stored.map.set_picture(id, StoredPicture(std::vector(20 + id.number, static_cast<std::byte>(id.number))));
  }
  return stored;
}

// All that the section `upkeep` of a file of this map can contain.
inline MapUpkeep upkeep_of_session(const StoredMap& stored) {
  MapUpkeep upkeep;
  upkeep.survival.assign(static_cast<std::size_t>(stored.map.point_count()), 24);
  upkeep.survival.front() = -128;
  SessionRecord& session = upkeep.session.emplace();
  session.map_id = 0xfedcba9876543210;
  session.frames = 400;
  session.trusted = 380;
  session.copied_points = 2;
  session.points.resize(302);
  session.points[0] = {200, 3, 1, 41.25f};
  session.points[300] = {0, 0, 7, 0.0f};
  PoseRecord& pose = session.poses.emplace_back();
  pose.time = std::chrono::seconds(100);
  pose.map_from_body = {{0.8, 0.0, 0.0, 0.6}, {12.5, -3.25, 0.0}};
  pose.covariance.fill(1e-6f);
  pose.verdict = 2;
  pose.image = {90.0f, 20.0f, 0.01f, 0.7f, 2.0f};
  return upkeep;
}

}  // namespace byre
