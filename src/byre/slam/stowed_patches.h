#pragma once

#include "byre/map/map.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace byre {

// The patches of a map, taken out of it while nothing looks at them, in a third of the memory: those of a site take as
// much as all else that its keyframes see. Patches as a map file has them, see docs/map_format.md. Those of a keyframe
// that are not so, as it was made since, stay where they are.
class StowedPatches {
 public:
  explicit StowedPatches(Map& map);
  // Once. Keyframes that have gone since are passed over.
  void give_back(Map& map);

 private:
  std::vector<std::pair<KeyframeId, std::vector<std::byte>>> packed_;
};

}  // namespace byre
