#include "byre/place/map_words.h"

namespace byre {

void add_words(StoredMap& stored, const Vocabulary& vocabulary) {
  if (stored.vocabulary_checksum == vocabulary.checksum()) return;
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    stored.map.set_words(id, vocabulary.words_of(*stored.map.find_keyframe(id)->frame.features));
  }
  stored.vocabulary_checksum = vocabulary.checksum();
}

}  // namespace byre
