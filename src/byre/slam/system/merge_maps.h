#pragma once

#include "byre/alignment.h"
#include "byre/slam/system/refine_map.h"

#include <optional>
#include <string>

namespace byre {

// Placement of a map in another one by its keyframes.
struct MapPlace {
  int keyframes = 0;  // searched
  int found = 0;
  int agreeing = 0;  // found where the transform has them
  int expected = 0;  // the transform has them beside keyframes of the target, so that they should be found
  std::optional<Similarity> target_from_source{};
  std::string fault{};  // why the transform is not accepted; empty: it is
};

// Localises keyframes of a map in another one; the transform that most of them agree with. Scale of the source is
// estimated unless both maps are metric. Precondition: both maps have words of the vocabulary.
MapPlace place_in(const StoredMap& target, const StoredMap& source, const Vocabulary& vocabulary);

struct MergedMaps {
  MapPlace place;
  std::string refusal{};  // why the maps were not merged; empty: they were
  FinishResult finishing{};
};

// Merges two maps that overlap: places the second in the first, searches loops between both, and adjusts them together
// around these. The merged map has frame, registration on a plan, extrinsics and notes of the first. `first` becomes
// the merged map, and is unspecified after a refusal by the finishing. Precondition: words of the vocabulary.
MergedMaps merge_maps(StoredMap& first, const StoredMap& second, const Vocabulary& vocabulary,
                      const FinishHooks& hooks);

}  // namespace byre
