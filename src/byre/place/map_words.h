#pragma once

#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"

namespace byre {

// Assigns every keyframe its words of this vocabulary. Does nothing if the map's words are of this vocabulary already.
void add_words(StoredMap& stored, const Vocabulary& vocabulary);

}  // namespace byre
