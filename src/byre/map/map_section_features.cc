// Keypoints, descriptors and stored patches of keyframes in formats 1 to 4.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <memory>

namespace byre {
namespace {

constexpr std::size_t kKeypointBytes = 6 * sizeof(float) + 1;
constexpr std::size_t kDescriptorBytes = sizeof(Descriptor);
constexpr std::size_t kPatchBytes = sizeof(std::uint32_t) + Patch::kSize * Patch::kSize + 2 * sizeof(float);

Keypoint read_keypoint(ByteReader& reader) {
  std::array<float, 6> values;
  reader.read_all<float>(values);
  const auto octave = reader.read<std::uint8_t>();
  Keypoint keypoint;
  keypoint.pixel = {values[0], values[1]};
  keypoint.disparity = values[2];
  keypoint.disparity_sigma = values[3];
  keypoint.angle = values[4];
  keypoint.response = values[5];
  keypoint.octave = octave;
  return keypoint;
}

std::vector<Keypoint> read_keypoints(ByteReader& reader, std::uint32_t count, const Rig& rig, std::size_t keyframe) {
  std::vector<Keypoint> keypoints;
  keypoints.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    keypoints.push_back(read_keypoint(reader));
    require_no_fault(reader, fault_in(keypoints.back(), rig), "keyframe", keyframe);
  }
  return keypoints;
}

std::vector<Descriptor> read_descriptors(ByteReader& reader, std::uint32_t count) {
  std::vector<Descriptor> descriptors(count);
  const std::span<const std::byte> bytes = reader.take(count * kDescriptorBytes);
  std::ranges::copy(bytes, std::as_writable_bytes(std::span(descriptors)).begin());
  return descriptors;
}

struct KeptPatches {
  std::vector<Patch> patches;
  std::vector<int> patch_of_keypoint;  // -1: none
};

KeptPatches read_kept_patches(ByteReader& reader, std::size_t feature_count, std::size_t keyframe) {
  const std::uint32_t count = reader.read_count(kPatchBytes);
  KeptPatches kept;
  kept.patches.resize(count);
  kept.patch_of_keypoint.assign(feature_count, -1);
  std::size_t first_free_feature = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t feature = read_index(reader, feature_count, "feature");
    if (feature < first_free_feature) reader.fail("has unsorted features");
    first_free_feature = feature + 1;
    kept.patch_of_keypoint[feature] = static_cast<int>(i);
    reader.read_all<std::uint8_t>(kept.patches[i].pixels);
    kept.patches[i].centre = read_vector<Eigen::Vector2f>(reader);
    require_no_fault(reader, fault_in(kept.patches[i]), "keyframe", keyframe);
  }
  return kept;
}

std::shared_ptr<const Features> read_features_of(std::size_t keyframe, ByteReader& reader, ByteReader& patch_reader,
                                                 const Rig& rig) {
  const std::uint32_t count = reader.read_count(kKeypointBytes + kDescriptorBytes);
  const std::vector<Keypoint> keypoints = read_keypoints(reader, count, rig, keyframe);
  std::vector<Descriptor> descriptors = read_descriptors(reader, count);
  KeptPatches kept = read_kept_patches(patch_reader, count, keyframe);
  auto features = std::make_shared<const Features>(rig.width, rig.height, keypoints, std::move(descriptors),
                                                   std::move(kept.patches), std::move(kept.patch_of_keypoint));
  if (!std::ranges::equal(features->keypoints(), keypoints, {}, &Keypoint::pixel, &Keypoint::pixel)) {
    require_no_fault(reader, "has keypoints that are not sorted by grid cell", "keyframe", keyframe);
  }
  return features;
}

}  // namespace

const Features& features_of(const Keyframe& keyframe) {
  static const Features kNone;
  return keyframe.frame.features ? *keyframe.frame.features : kNone;
}

void read_features(ByteReader features, ByteReader patches, const std::vector<Rig>& rigs,
                   std::vector<Keyframe>& keyframes) {
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    Keyframe& keyframe = keyframes[i];
    const Rig& rig = rigs[static_cast<std::size_t>(keyframe.rig)];
    keyframe.frame.features = read_features_of(i, features, patches, rig);
    keyframe.sightings.resize(static_cast<std::size_t>(keyframe.frame.features->size()));
  }
  features.require_end();
  patches.require_end();
}

}  // namespace byre
