#pragma once

#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"
#include "byre/slam/finishing.h"
#include "byre/system/engine.h"

namespace byre {

// What mapping ends with, once more: looks for loops, adjusts all of the map, and removes weak points and redundant
// keyframes. The map must have the vocabulary's words; its poses are the method's own afterwards, wherever they are
// from.
Finishing refine_map(StoredMap& stored, const Vocabulary& vocabulary, const FinishHooks& hooks);

}  // namespace byre
