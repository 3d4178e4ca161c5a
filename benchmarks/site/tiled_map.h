#pragma once

#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"

namespace byre {

// A map with a given number of keyframes, made of copies of a smaller one side by side on a square, without shared
// points. The first copy is the map itself. Every other one has its points' descriptors shuffled, with a few bits of
// each flipped: similar things in another arrangement, like the next hall of a site. Features keep their bit
// differences to their points, and words follow the new descriptors. Surplus keyframes of the last copy are left out.
// Preconditions: the map has keyframes, with words of the vocabulary.
StoredMap tiled_map(const StoredMap& one, int keyframes, const Vocabulary& vocabulary);

// A map of poses only, of a robot that drives up and down the lanes of a field, with a keyframe every half metre.
MapGraph driven_field(int keyframes);

}  // namespace byre
