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

// Keyframes that see the same place: one of them looks most like the query, the others are covisible with it.
struct PlaceCandidate {
  KeyframeId keyframe;            // the most similar of the group
  float score = 0.0f;             // similarity of that keyframe alone
  float group_score = 0.0f;       // sum over the group: places seen by several keyframes come first
  std::vector<KeyframeId> group;  // most similar first, keyframe itself included
};

struct PlaceQueryOptions {
  int max_candidates = 10;
  int group_size = 10;           // covisible keyframes that count
  float min_score_share = 0.5f;  // share of the best score below which candidates are left out
};

// An inverted file from words to keyframes (Galvez-Lopez and Tardos 2012). Built from the words kept with keyframes
// when a map is loaded, in some thousandths of a millisecond per keyframe; never saved. Keyframes are looked up by
// their numbers, so these should be dense, as a map's are.
class PlaceIndex {
 public:
  explicit PlaceIndex(Vocabulary vocabulary);

  const Vocabulary& vocabulary() const { return vocabulary_; }
  int size() const { return size_; }  // keyframes

  void add(KeyframeId id, std::span<const Word> words);  // replaces what it had of the keyframe
  void remove(KeyframeId id);

  // Keyframes that share words with the query, best first (ties: lower id first), except those for which is_excluded,
  // unless empty, holds.
  std::vector<PlaceMatch> query(const BagOfWords& query, int max_results,
                                const std::function<bool(KeyframeId)>& is_excluded = {}) const;

 private:
  friend class PlaceGrouping;
  struct WordsOfMap;
  friend PlaceIndex index_of(const Map& map, const Vocabulary& vocabulary);

  struct Posting {
    std::uint32_t slot = 0;
    float weight = 0.0f;  // weight of the word in the keyframe's bag
  };
  struct Entry {
    KeyframeId keyframe;
    std::vector<Word> words;  // words of the keyframe's bag, where it was added by itself; none in a free slot
  };

  std::optional<std::uint32_t> slot_of(KeyframeId id) const;
  std::uint32_t take_slot(KeyframeId id);
  void add_all(const WordsOfMap& map);                          // precondition: the index holds no keyframes
  std::vector<float> scores_of(const BagOfWords& query) const;  // similarity of the keyframe in each slot

  Vocabulary vocabulary_;                       // constant after construction
  std::vector<std::vector<Posting>> postings_;  // postings of each word
  std::vector<Entry> entries_;                  // keyframes by slot
  std::vector<std::uint32_t> free_slots_;
  std::array<std::vector<std::uint32_t>, 2> slots_;  // slot by origin and number, or kNoSlot
  int size_ = 0;
};

// The index of a map's keyframes, by their words; of those that have none, by their descriptors.
PlaceIndex index_of(const Map& map, const Vocabulary& vocabulary);

// The best places for the words of a frame, most similar group first. A keyframe is in one group at most.
std::vector<PlaceCandidate> find_places(const PlaceIndex& index, const MapView& map, std::span<const Word> words,
                                        const PlaceQueryOptions& options,
                                        const std::function<bool(KeyframeId)>& is_excluded = {});

}  // namespace byre
