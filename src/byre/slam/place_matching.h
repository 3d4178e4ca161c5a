#pragma once

#include "byre/map/map_view.h"
#include "byre/place/vocabulary.h"

#include <span>
#include <vector>

namespace byre {

struct PlaceMatchOptions {
  int levels_up = 2;        // levels of the vocabulary above words: features below the same node there are compared
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

// Matches a frame wherever it was taken: its features with those of each keyframe that see a point, among features of
// similar words, each the other's best. A feature keeps the most similar point of all keyframes, and a point the most
// similar feature. Ordered by feature. Keyframes without words are passed over.
std::vector<PointMatch> match_place(const WordedFeatures& frame, const MapView& map,
                                    std::span<const KeyframeId> keyframes, const Vocabulary& vocabulary,
                                    const PlaceMatchOptions& options);

}  // namespace byre
