#include "byre/slam/places/place_matching.h"

#include "byre/features/descriptor.h"

#include <algorithm>
#include <limits>

namespace byre {
namespace {

struct NodeFeature {
  std::uint32_t node = 0;
  int feature = 0;
  auto operator<=>(const NodeFeature&) const = default;
};

using NodeFeatures = std::vector<NodeFeature>;   // features in ascending order of their nodes
using NodeRange = std::span<const NodeFeature>;  // features of one node

template <typename Choose>
NodeFeatures features_by_node(std::span<const Word> words, const Vocabulary& vocabulary, int levels_up, Choose choose) {
  NodeFeatures result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (choose(i)) result.push_back({vocabulary.node_above(words[i], levels_up), static_cast<int>(i)});
  }
  std::sort(result.begin(), result.end());
  return result;
}

// Calls visit(range of first, range of second) for each node with features of both.
template <typename Visitor>
void visit_shared_nodes(const NodeFeatures& first, const NodeFeatures& second, Visitor visit) {
  const auto end_of_node = [](auto begin, auto end) {
    return std::find_if(begin, end, [&](const NodeFeature& entry) { return entry.node != begin->node; });
  };
  auto a = first.begin(), b = second.begin();
  while (a != first.end() && b != second.end()) {
    const auto a_end = end_of_node(a, first.end()), b_end = end_of_node(b, second.end());
    if (a->node == b->node) visit(NodeRange(a, a_end), NodeRange(b, b_end));
    const bool advance_a = a->node <= b->node, advance_b = b->node <= a->node;
    if (advance_a) a = a_end;
    if (advance_b) b = b_end;
  }
}

struct Nearest {
  int feature = -1;
  int distance = std::numeric_limits<int>::max();
  int second_distance = std::numeric_limits<int>::max();
};

Nearest nearest_of(const Descriptor& descriptor, const Features& features, NodeRange candidates) {
  Nearest nearest;
  for (const NodeFeature& candidate : candidates) {
    const int distance = hamming_distance(descriptor, features.descriptor(candidate.feature));
    if (distance < nearest.distance) {
      nearest = {candidate.feature, distance, nearest.distance};
    } else if (distance < nearest.second_distance) {
      nearest.second_distance = distance;
    }
  }
  return nearest;
}

bool is_distinct(const Nearest& nearest, const PlaceMatchOptions& options) {
  return nearest.distance <= options.max_distance &&
         static_cast<float>(nearest.distance) < options.max_ratio * static_cast<float>(nearest.second_distance);
}

// False for a point of an offline map that is not in the view.
bool shows_known_point(const MapView& map, const Sighting& sighting) {
  return sighting.point && map.find_point(*sighting.point) != nullptr;
}

// At most one match for each feature and each point: the most similar.
std::vector<PointMatch> most_similar(std::vector<PointMatch> matches) {
  const auto by_similarity = [](const PointMatch& a, const PointMatch& b) {
    return std::tie(a.distance, a.feature, a.point) < std::tie(b.distance, b.feature, b.point);
  };
  const auto keep_first_of_each = [&](auto key) {
    std::ranges::sort(matches, by_similarity);
    std::ranges::stable_sort(matches, {}, key);
    const auto is_repeated = [&](const PointMatch& a, const PointMatch& b) { return a.*key == b.*key; };
    matches.erase(std::unique(matches.begin(), matches.end(), is_repeated), matches.end());
  };
  keep_first_of_each(&PointMatch::point);
  keep_first_of_each(&PointMatch::feature);
  return matches;
}

}  // namespace

std::vector<PointMatch> match_place(const WordedFeatures& frame, const MapView& map,
                                    std::span<const KeyframeId> keyframes, const Vocabulary& vocabulary,
                                    const PlaceMatchOptions& options) {
  const NodeFeatures of_frame =
      features_by_node(frame.words, vocabulary, options.levels_up, [](std::size_t) { return true; });
  std::vector<PointMatch> matches;
  for (const KeyframeId id : keyframes) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe == nullptr) continue;
    const Features& features = *keyframe->frame.features;
    const NodeFeatures of_keyframe =
        features_by_node(keyframe->words, vocabulary, options.levels_up,
                         [&](std::size_t i) { return shows_known_point(map, keyframe->sightings[i]); });
    visit_shared_nodes(of_keyframe, of_frame, [&](NodeRange of_points, NodeRange candidates) {
      for (const NodeFeature& seen : of_points) {
        const Nearest nearest = nearest_of(features.descriptor(seen.feature), frame.features, candidates);
        if (!is_distinct(nearest, options)) continue;
        const Nearest back = nearest_of(frame.features.descriptor(nearest.feature), features, of_points);
        if (back.feature != seen.feature) continue;
        const PointId point = *keyframe->sightings[static_cast<std::size_t>(seen.feature)].point;
        matches.push_back({nearest.feature, point, nearest.distance});
      }
    });
  }
  return most_similar(std::move(matches));
}

}  // namespace byre
