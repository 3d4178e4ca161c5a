#pragma once

#include "byre/map/map_graph.h"

#include <cstdint>
#include <optional>

namespace byre {

// Grey value that clouds of points state for one without a patch: medium.
inline constexpr std::uint8_t kUnknownGrey = 128;

// Grey value at the centre of the patch that defines a point; empty if the patch was not kept.
inline std::optional<std::uint8_t> grey_of(const MapGraph& map, const MapPoint& point) {
  const Keyframe* const keyframe = map.find_keyframe(point.reference.keyframe);
  const Patch* const patch =
      keyframe && keyframe->frame.features ? keyframe->frame.features->find_patch(point.reference.feature) : nullptr;
  if (patch == nullptr) return std::nullopt;
  const auto column = static_cast<std::size_t>(patch->centre.x()), row = static_cast<std::size_t>(patch->centre.y());
  return patch->pixels[row * Patch::kSize + column];
}

}  // namespace byre
