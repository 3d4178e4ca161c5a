#pragma once

#include "byre/map/map_view.h"
#include "byre/place/vocabulary.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace byre {

struct PlaceMatch {
  KeyframeId keyframe;
  float score = 0.0f;  // similarity of the bags of words, 0 to 1
};

// A group of covisible keyframes that match the query.
struct PlaceCandidate {
  KeyframeId keyframe;            // the best match of the group
  float score = 0.0f;             // score of that keyframe
  float group_score = 0.0f;       // sum over the group; ranks places in view of several keyframes first
  std::vector<KeyframeId> group;  // with `keyframe`, best match first
};

struct PlaceQueryOptions {
  int max_candidates = 10;
  int group_size = 10;           // largest number of covisible keyframes in a group
  float min_score_share = 0.5f;  // smallest group score of a candidate, as a share of the best one
};

// Inverted index from words to keyframes (Galvez-Lopez and Tardos 2012). Built when a map is loaded, in some
// microseconds per keyframe; never saved. Indexed by keyframe number, so numbers should be dense, as in a map.
class PlaceIndex {
 public:
  explicit PlaceIndex(Vocabulary vocabulary);

  const Vocabulary& vocabulary() const { return vocabulary_; }
  int size() const { return size_; }  // number of keyframes

  void add(KeyframeId id, std::span<const Word> words);  // replaces the words of the keyframe
  void remove(KeyframeId id);

  // Keyframes with words of the query, best first (ties: lower id first), except those for which is_excluded holds, if
  // set.
  std::vector<PlaceMatch> query(const BagOfWords& query, int max_results,
                                const std::function<bool(KeyframeId)>& is_excluded = {}) const;

 private:
  friend class PlaceGrouping;
  struct WordsOfMap;
  friend PlaceIndex index_of(const MapGraph& map, const Vocabulary& vocabulary);

  struct Posting {
    std::uint32_t slot = 0;
    float weight = 0.0f;  // weight of the word in the keyframe's bag
  };
  struct Entry {
    KeyframeId keyframe;
    std::vector<Word> words;  // words of the keyframe's bag if added by add(); empty in a free slot
  };

  std::optional<std::uint32_t> slot_of(KeyframeId id) const;
  std::uint32_t take_slot(KeyframeId id);
  void add_all(const WordsOfMap& map);                          // precondition: the index holds no keyframes
  std::vector<float> scores_of(const BagOfWords& query) const;  // by slot

  Vocabulary vocabulary_;                       // constant after construction
  std::vector<std::vector<Posting>> postings_;  // by word
  std::vector<Entry> entries_;                  // by slot
  std::vector<std::uint32_t> free_slots_;
  std::array<std::vector<std::uint32_t>, 2> slots_;  // slot by origin and number, or kNoSlot
  int size_ = 0;
};

// Index of a map's keyframes by their words. Words of keyframes without stored words are computed from descriptors.
PlaceIndex index_of(const MapGraph& map, const Vocabulary& vocabulary);

// The best places for the words of a frame, by descending group score. Each keyframe is in at most one group.
std::vector<PlaceCandidate> find_places(const PlaceIndex& index, const MapView& map, std::span<const Word> words,
                                        const PlaceQueryOptions& options,
                                        const std::function<bool(KeyframeId)>& is_excluded = {});

}  // namespace byre
