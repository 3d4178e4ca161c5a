#pragma once

#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"

namespace byre {

// A map of so many keyframes, made of copies of a smaller one that lie beside each other on a square of ground and
// share no points. The first copy is the map itself. Each other one has the descriptors of its points shuffled, with a
// few bits of each flipped: it shows the same kinds of things in another arrangement, as the next hall of a site does.
// A feature differs from its point by the same bits as before, and words are those of the new descriptors. What the
// last copy has too many of is left out. Preconditions: the map has keyframes, with words of the vocabulary.
StoredMap tiled_map(const StoredMap& one, int keyframes, const Vocabulary& vocabulary);

// A map of poses alone, as a robot leaves them that drives up and down the lanes of a field. It is as large as asked
// for, a keyframe every half a metre.
Map driven_field(int keyframes);

}  // namespace byre
