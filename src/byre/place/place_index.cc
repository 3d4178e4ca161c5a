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

// The matches that are not yet in a group, by keyframe.
using UngroupedScores = std::map<KeyframeId, float>;

// Takes the best match and those covisible with it out of the ungrouped ones.
PlaceCandidate take_group(const PlaceMatch& best, const MapView& map, int group_size, UngroupedScores& ungrouped) {
  std::vector<PlaceMatch> members = {best};
  ungrouped.erase(best.keyframe);
  for (const Covisible& covisible : map.covisible_keyframes(best.keyframe, group_size)) {
    const auto found = ungrouped.find(covisible.keyframe);
    if (found == ungrouped.end()) continue;
    members.push_back({found->first, found->second});
    ungrouped.erase(found);
  }
  std::sort(members.begin(), members.end(), is_better);
  PlaceCandidate candidate{best.keyframe, best.score, 0.0f, {}};
  for (const PlaceMatch& member : members) {
    candidate.group_score += member.score;
    candidate.group.push_back(member.keyframe);
  }
  return candidate;
}

}  // namespace

PlaceIndex::PlaceIndex(Vocabulary vocabulary)
    : vocabulary_(std::move(vocabulary)), postings_(static_cast<std::size_t>(vocabulary_.word_count())) {}

std::uint32_t PlaceIndex::take_slot(KeyframeId id) {
  if (free_slots_.empty()) {
    free_slots_.push_back(static_cast<std::uint32_t>(entries_.size()));
    entries_.emplace_back();
  }
  const std::uint32_t slot = free_slots_.back();
  free_slots_.pop_back();
  slot_of_.emplace(id, slot);
  return slot;
}

void PlaceIndex::add(KeyframeId id, std::span<const Word> words) {
  remove(id);
  const std::uint32_t slot = take_slot(id);
  entries_[slot] = {id, vocabulary_.bag_of(words)};
  for (const auto& [word, weight] : entries_[slot].bag) postings_[word].push_back({slot, weight});
}

void PlaceIndex::remove(KeyframeId id) {
  const auto found = slot_of_.find(id);
  if (found == slot_of_.end()) return;
  const std::uint32_t slot = found->second;
  for (const auto& [word, weight] : entries_[slot].bag) {
    std::erase_if(postings_[word], [slot](const Posting& posting) { return posting.slot == slot; });
  }
  entries_[slot] = {};
  free_slots_.push_back(slot);
  slot_of_.erase(found);
}

std::vector<PlaceMatch> PlaceIndex::query(const BagOfWords& query, int max_results,
                                          const std::function<bool(KeyframeId)>& is_excluded) const {
  // Equation 5 of Nister and Stewenius 2006: of the norm of the difference only the words of both matter. For weights
  // that sum to one, 1 - |a - b| / 2 is the sum of the smaller weights.
  std::vector<float> scores(entries_.size(), 0.0f);
  for (const auto& [word, weight] : query) {
    if (word >= postings_.size()) break;
    for (const Posting& posting : postings_[word]) scores[posting.slot] += std::min(weight, posting.weight);
  }
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

PlaceIndex index_of(const Map& map, const Vocabulary& vocabulary) {
  PlaceIndex index(vocabulary);
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    index.add(id, keyframe.words.empty() ? vocabulary.words_of(*keyframe.frame.features) : keyframe.words);
  }
  return index;
}

std::vector<PlaceCandidate> find_places(const PlaceIndex& index, const MapView& map, std::span<const Word> words,
                                        const PlaceQueryOptions& options,
                                        const std::function<bool(KeyframeId)>& is_excluded) {
  const std::vector<PlaceMatch> matches = index.query(index.vocabulary().bag_of(words), index.size(), is_excluded);
  UngroupedScores ungrouped;
  for (const PlaceMatch& match : matches) ungrouped.emplace(match.keyframe, match.score);
  std::vector<PlaceCandidate> candidates;
  for (const PlaceMatch& match : matches) {
    if (ungrouped.contains(match.keyframe)) {
      candidates.push_back(take_group(match, map, options.group_size, ungrouped));
    }
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
