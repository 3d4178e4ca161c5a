// Writes keyframes' features and sightings; map_section_views.cc reads them.

#include "byre/map/descriptor_difference.h"
#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_view_layout.h"
#include "byre/map/packed_steps.h"

namespace byre {
namespace {

std::uint32_t disparity_code(const Keypoint& keypoint) {
  return keypoint.has_disparity() ? float24_code(keypoint.disparity) : 0;
}

std::uint8_t bits_of(const Keypoint& keypoint, bool has_patch, bool sees_point) {
  return static_cast<std::uint8_t>((keypoint.octave < kOctaves ? keypoint.octave : kNoOctave) |
                                   (disparity_code(keypoint) != 0 ? kHasDisparity : 0) | (has_patch ? kHasPatch : 0) |
                                   (sees_point ? kSeesPoint : 0));
}

void write_keypoint(const Keypoint& keypoint, std::uint8_t bits, const Rig& rig, ByteWriter& writer) {
  writer.write(bits);
  writer.write_low_bytes(pixel_code(keypoint.pixel.x(), rig.width), bytes_for_pixels(rig.width));
  writer.write_low_bytes(pixel_code(keypoint.pixel.y(), rig.height), bytes_for_pixels(rig.height));
  if ((bits & kHasDisparity) == 0) return;
  writer.write_low_bytes(disparity_code(keypoint), kDisparityBytes);
  writer.write(sigma_code(keypoint.disparity_sigma));
}

void write_descriptors(const MapGraph& map, const Keyframe& keyframe, ByteWriter& writer) {
  const std::span<const Descriptor> descriptors = features_of(keyframe).descriptors();
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const std::optional<PointId>& point = keyframe.sightings[i].point;
    if (point) {
      write_difference(descriptors[i], map.find_point(*point)->descriptor, writer);
    } else {
      writer.write_all<std::uint64_t>(descriptors[i]);
    }
  }
}

void write_sighting(const Sighting& sighting, const Keypoint& keypoint, const Rig& rig, std::size_t point_count,
                    ByteWriter& writer) {
  writer.write_low_bytes(sighting.point->number, bytes_for(point_count));
  const Eigen::Vector2f rounded(coordinate_of(pixel_code(keypoint.pixel.x(), rig.width)),
                                coordinate_of(pixel_code(keypoint.pixel.y(), rig.height)));
  writer.write_varint(offset_code(sighting.pixel.x() - rounded.x()));
  writer.write_varint(offset_code(sighting.pixel.y() - rounded.y()));
  writer.write(sigma_code(sighting.pixel_sigma));
}

void write_patch(const Patch& patch, ByteWriter& writer) {
  const PatchCode code = patch_code(patch);
  writer.write(code.darkest);
  writer.write(code.brightest);
  writer.write_all<std::uint16_t>(code.centre);
  write_packed_steps(code.steps, writer);
}

ViewSizes written(const ViewWriters& sections) {
  ViewSizes sizes{};
  sizes[kFeaturesOfView] = static_cast<std::uint32_t>(sections.features.size());
  sizes[kPatchesOfView] = static_cast<std::uint32_t>(sections.patches.size());
  sizes[kObservationsOfView] = static_cast<std::uint32_t>(sections.observations.size());
  sizes[kDescriptorsOfView] = static_cast<std::uint32_t>(sections.descriptors.size());
  return sizes;
}

}  // namespace

const Features& features_of(const Keyframe& keyframe) {
  static const Features kNone;
  return keyframe.frame.features ? *keyframe.frame.features : kNone;
}

void write_views(const MapGraph& map, const Keyframes& keyframes, ViewWriters& sections, PartSizes& sizes) {
  sizes.views.reserve(keyframes.size());
  for (const Keyframe* const keyframe : keyframes) {
    const ViewSizes before = written(sections);
    const Features& features = features_of(*keyframe);
    const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe->rig)];
    sections.features.write(static_cast<std::uint32_t>(features.size()));
    for (int i = 0; i < features.size(); ++i) {
      const Keypoint& keypoint = features.keypoint(i);
      const Sighting& sighting = keyframe->sightings[static_cast<std::size_t>(i)];
      const Patch* const patch = features.find_patch(i);
      write_keypoint(keypoint, bits_of(keypoint, patch != nullptr, sighting.point.has_value()), rig, sections.features);
      if (patch) write_patch(*patch, sections.patches);
      if (sighting.point) {
        write_sighting(sighting, keypoint, rig, static_cast<std::size_t>(map.point_count()), sections.observations);
      }
    }
    write_descriptors(map, *keyframe, sections.descriptors);
    set_taken(written(sections), before, sizes.views.emplace_back());
  }
}

}  // namespace byre
