#pragma once

#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"

namespace byre {

// Gives every keyframe the words of this vocabulary. Does nothing when they are of this very one already, so a map
// that was saved with them is ready at once, and one that was saved with another vocabulary is made ready.
void add_words(StoredMap& stored, const Vocabulary& vocabulary);

}  // namespace byre
