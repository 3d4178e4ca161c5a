#pragma once

#include "byre/map/map_view.h"
#include "byre/place/vocabulary.h"

#include <span>
#include <vector>

namespace byre {

struct PlaceMatchOptions {
  int levels_up = 2;        // levels of the vocabulary above words; features under the same node are compared
  int max_distance = 60;    // bits between descriptors
  float max_ratio = 0.85f;  // best over second best distance
};

// A feature of a frame that looks like a map point.
struct PointMatch {
  int feature = 0;
  PointId point;
  int distance = 0;  // Hamming bits
};

// A frame's features with their words.
struct WordedFeatures {
  const Features& features;
  std::span<const Word> words;  // one per feature
};

// Matches a frame without a predicted pose: its features with those of each keyframe that see a point, among features
// of similar words, if mutually best. A feature keeps the most similar point of all keyframes, and a point the most
// similar feature. Ordered by feature. Skips keyframes without words.
std::vector<PointMatch> match_place(const WordedFeatures& frame, const MapView& map,
                                    std::span<const KeyframeId> keyframes, const Vocabulary& vocabulary,
                                    const PlaceMatchOptions& options);

}  // namespace byre
