#include "byre/place/place_index.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

bool is_better(const PlaceMatch& a, const PlaceMatch& b) {
  return a.score != b.score ? a.score > b.score : a.keyframe < b.keyframe;
}

bool has_better_group(const PlaceCandidate& a, const PlaceCandidate& b) {
  return a.group_score != b.group_score ? a.group_score > b.group_score : a.keyframe < b.keyframe;
}

constexpr std::uint32_t kNoSlot = 0xFFFFFFFF;

std::vector<Word> words_in(const BagOfWords& bag) {
  std::vector<Word> words;
  words.reserve(bag.size());
  for (const auto& [word, weight] : bag) words.push_back(word);
  return words;
}

// Upper bound on the rounded sum of `count` scores up to `score`.
float greatest_sum(float score, int count) {
  constexpr float kRounding = 1.0001f;
  return kRounding * score * static_cast<float>(count);
}

// The best `count` group scores so far.
class BestGroups {
 public:
  explicit BestGroups(int count) : count_(static_cast<std::size_t>(std::max(count, 0))) {}

  void add(float score) {
    best_ = std::max(best_, score);
    scores_.insert(std::ranges::upper_bound(scores_, score, std::greater()), score);
    if (scores_.size() > count_) scores_.pop_back();
  }

  // Whether a group with at most this score is discarded.
  bool leave_out(float score, float min_score_share) const {
    const bool is_behind_all = scores_.size() >= count_ && (scores_.empty() || score < scores_.back());
    return is_behind_all || score < min_score_share * best_;
  }

 private:
  std::size_t count_;
  std::vector<float> scores_;  // descending
  float best_ = 0.0f;
};

}  // namespace

// Matches of a query that are not yet in a group.
class PlaceGrouping {
 public:
  PlaceGrouping(const PlaceIndex& index, const BagOfWords& query, const std::function<bool(KeyframeId)>& is_excluded)
      : index_(index), is_excluded_(is_excluded), scores_(index.scores_of(query)) {
    for (std::uint32_t slot = 0; slot < scores_.size(); ++slot) {
      if (scores_[slot] > 0.0f) ranking_.push_back({index.entries_[slot].keyframe, scores_[slot]});
    }
    std::ranges::make_heap(ranking_, is_worse);
  }

  // Removes and returns the best match; empty if none is left.
  std::optional<PlaceMatch> take_best() {
    while (!ranking_.empty()) {
      std::ranges::pop_heap(ranking_, is_worse);
      const PlaceMatch best = ranking_.back();
      ranking_.pop_back();
      if (take(best.keyframe) > 0.0f) return best;
    }
    return std::nullopt;
  }

  // Groups a removed match with its covisible matches, which are removed too.
  PlaceCandidate take_group(const PlaceMatch& best, const MapView& map, int group_size) {
    std::vector<PlaceMatch> members = {best};
    for (const Covisible& covisible : map.covisible_keyframes(best.keyframe, group_size)) {
      const float score = take(covisible.keyframe);
      if (score > 0.0f) members.push_back({covisible.keyframe, score});
    }
    std::sort(members.begin(), members.end(), is_better);
    PlaceCandidate candidate{best.keyframe, best.score, 0.0f, {}};
    for (const PlaceMatch& member : members) {
      candidate.group_score += member.score;
      candidate.group.push_back(member.keyframe);
    }
    return candidate;
  }

 private:
  static bool is_worse(const PlaceMatch& a, const PlaceMatch& b) { return is_better(b, a); }

  // Removes a keyframe from the matches and returns its score; zero if it is removed already, excluded, or no match.
  float take(KeyframeId id) {
    const std::optional<std::uint32_t> slot = index_.slot_of(id);
    const float score = slot ? std::exchange(scores_[*slot], 0.0f) : 0.0f;
    return score > 0.0f && is_excluded_ && is_excluded_(id) ? 0.0f : score;
  }

  const PlaceIndex& index_;
  const std::function<bool(KeyframeId)>& is_excluded_;
  std::vector<float> scores_;        // by slot; zero for removed matches
  std::vector<PlaceMatch> ranking_;  // heap with the best match on top; may contain removed ones
};

PlaceIndex::PlaceIndex(Vocabulary vocabulary)
    : vocabulary_(std::move(vocabulary)), postings_(static_cast<std::size_t>(vocabulary_.word_count())) {}

std::optional<std::uint32_t> PlaceIndex::slot_of(KeyframeId id) const {
  const std::vector<std::uint32_t>& slots = slots_[static_cast<std::size_t>(id.origin)];
  if (id.number >= slots.size() || slots[id.number] == kNoSlot) return std::nullopt;
  return slots[id.number];
}

std::uint32_t PlaceIndex::take_slot(KeyframeId id) {
  if (free_slots_.empty()) {
    free_slots_.push_back(static_cast<std::uint32_t>(entries_.size()));
    entries_.emplace_back();
  }
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  std::vector<std::uint32_t>& slots = slots_[static_cast<std::size_t>(id.origin)];
  if (id.number >= slots.size()) slots.resize(id.number + std::size_t{1}, kNoSlot);
  slots[id.number] = slot;
  ++size_;
  return slot;
}

void PlaceIndex::add(KeyframeId id, std::span<const Word> words) {
  remove(id);
  const BagOfWords bag = vocabulary_.bag_of(words);
  const std::uint32_t slot = take_slot(id);
  entries_[slot] = {id, words_in(bag)};
  for (const auto& [word, weight] : bag) postings_[word].push_back({slot, weight});
}

// Words of all keyframes of a map, concatenated.
struct PlaceIndex::WordsOfMap {
  std::vector<KeyframeId> keyframes;
  std::vector<std::size_t> ends;  // end of each keyframe's words
  std::vector<Word> words;

  // Calls visit(slot, word) for each word.
  template <typename Visitor>
  void visit(Visitor visit) const {
    std::size_t next = 0;
    for (std::uint32_t slot = 0; slot < keyframes.size(); ++slot) {
      for (; next < ends[slot]; ++next) visit(slot, words[next]);
    }
  }
};

// Bit-identical to add() for each keyframe: both sum weights in the order of the words.
void PlaceIndex::add_all(const WordsOfMap& map) {
  for (const KeyframeId id : map.keyframes) entries_[take_slot(id)].keyframe = id;

  std::vector<std::uint32_t> counts(postings_.size(), 0);
  std::vector<std::uint32_t> last_with(postings_.size(), kNoSlot);  // the last slot counted for each word
  map.visit([&](std::uint32_t slot, Word word) {
    if (word < counts.size() && std::exchange(last_with[word], slot) != slot) ++counts[word];
  });
  for (Word word = 0; word < postings_.size(); ++word) {
    if (vocabulary_.weight_of(word) != 0.0f) postings_[word].reserve(counts[word]);
  }
  map.visit([&](std::uint32_t slot, Word word) {
    const float weight = vocabulary_.weight_of(word);
    if (weight == 0.0f) return;
    std::vector<Posting>& postings = postings_[word];
    if (!postings.empty() && postings.back().slot == slot) {
      postings.back().weight += weight;
    } else {
      postings.push_back({slot, weight});
    }
  });
  std::vector<float> sums(entries_.size(), 0.0f);
  for (const std::vector<Posting>& postings : postings_) {
    for (const Posting& posting : postings) sums[posting.slot] += posting.weight;
  }
  for (std::vector<Posting>& postings : postings_) {
    for (Posting& posting : postings) posting.weight /= sums[posting.slot];
  }
}

void PlaceIndex::remove(KeyframeId id) {
  const std::optional<std::uint32_t> slot = slot_of(id);
  if (!slot) return;
  const auto erase = [&](std::vector<Posting>& postings) {
    std::erase_if(postings, [&](const Posting& posting) { return posting.slot == *slot; });
  };
  if (entries_[*slot].words.empty()) {
    std::ranges::for_each(postings_, erase);
  } else {
    for (const Word word : entries_[*slot].words) erase(postings_[word]);
  }
  entries_[*slot] = {};
  free_slots_.push_back(*slot);
  slots_[static_cast<std::size_t>(id.origin)][id.number] = kNoSlot;
  --size_;
}

// Equation 5 of Nister and Stewenius 2006 by common words alone: for weights that sum to one, 1 - |a - b| / 2 is the
// sum of the smaller weights.
std::vector<float> PlaceIndex::scores_of(const BagOfWords& query) const {
  std::vector<float> scores(entries_.size(), 0.0f);
  for (const auto& [word, weight] : query) {
    if (word >= postings_.size()) break;
    for (const Posting& posting : postings_[word]) scores[posting.slot] += std::min(weight, posting.weight);
  }
  return scores;
}

std::vector<PlaceMatch> PlaceIndex::query(const BagOfWords& query, int max_results,
                                          const std::function<bool(KeyframeId)>& is_excluded) const {
  const std::vector<float> scores = scores_of(query);
  std::vector<PlaceMatch> matches;
  for (std::size_t slot = 0; slot < scores.size(); ++slot) {
    const KeyframeId id = entries_[slot].keyframe;
    if (scores[slot] > 0.0f && !(is_excluded && is_excluded(id))) matches.push_back({id, scores[slot]});
  }
  const auto kept = std::min(matches.size(), static_cast<std::size_t>(std::max(max_results, 0)));
  std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(kept), matches.end(), is_better);
  matches.resize(kept);
  return matches;
}

PlaceIndex index_of(const MapGraph& map, const Vocabulary& vocabulary) {
  PlaceIndex::WordsOfMap all;
  map.visit_words([&](KeyframeId id, std::span<const Word> known) {
    std::vector<Word> found;
    if (known.empty()) {
      const Keyframe& keyframe = *map.find_keyframe(id);
      if (keyframe.frame.features) found = vocabulary.words_of(*keyframe.frame.features);
    }
    const std::span<const Word> words = known.empty() ? std::span<const Word>(found) : known;
    all.keyframes.push_back(id);
    all.words.insert(all.words.end(), words.begin(), words.end());
    all.ends.push_back(all.words.size());
  });
  PlaceIndex index(vocabulary);
  index.add_all(all);
  return index;
}

// Forms groups from the best match downwards. Stops once the upper bound of a group's score, with all its covisible
// keyframes matching equally well, is too small. Most of a large map is then never grouped.
std::vector<PlaceCandidate> find_places(const PlaceIndex& index, const MapView& map, std::span<const Word> words,
                                        const PlaceQueryOptions& options,
                                        const std::function<bool(KeyframeId)>& is_excluded) {
  PlaceGrouping matches(index, index.vocabulary().bag_of(words), is_excluded);
  BestGroups best(options.max_candidates);
  std::vector<PlaceCandidate> candidates;
  while (const std::optional<PlaceMatch> match = matches.take_best()) {
    const float most = greatest_sum(match->score, 1 + std::max(options.group_size, 0));
    if (best.leave_out(most, options.min_score_share)) break;
    candidates.push_back(matches.take_group(*match, map, options.group_size));
    best.add(candidates.back().group_score);
  }
  if (candidates.empty()) return candidates;
  std::sort(candidates.begin(), candidates.end(), has_better_group);
  const float least = options.min_score_share * candidates.front().group_score;
  std::erase_if(candidates, [least](const PlaceCandidate& candidate) { return candidate.group_score < least; });
  const auto kept = std::min(candidates.size(), static_cast<std::size_t>(std::max(options.max_candidates, 0)));
  candidates.resize(kept);
  return candidates;
}

}  // namespace byre
