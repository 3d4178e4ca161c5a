#pragma once

#include "byre/map/map_view.h"
#include "byre/place/place_index.h"
#include "byre/slam/tracking.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace byre {

// Why a frame was not found in a map; ordered by how far the attempt came.
enum class LocalisationFailure : std::uint8_t {
  none,
  too_few_features,     // the image is dark, blurred or blank
  no_similar_keyframe,  // nothing in the map looks like it
  too_few_matches,      // too few features of the frame match points of the places that look like it
  geometry_disagrees,   // no pose explains the matches
  too_few_inliers,      // a pose was found, but too few of the points around it are where they should be
  clustered,            // the points that agree lie in a small part of the image
  uncertain,            // the points that agree leave the pose open by more than is useful
  impossible,           // the camera cannot be at the place that explains the image
  ambiguous             // two places explain the image
};

std::string_view to_string(LocalisationFailure failure);

inline constexpr int kKeyframesOfPlace = 20;  // keyframes whose points are looked for around a first pose

struct LocaliseOptions {
  std::uint64_t seed = 0;            // seed of the poses that are tried from three points
  int min_inliers = 40;              // inliers at the end
  double min_spread = 0.05;          // deviation of the inliers where they spread least over the image's diagonal
  double max_position_sigma = 0.02;  // position's sigma over the median depth of the inliers
  double max_rotation_sigma = 0.02;  // radians
  HiddenCells hidden{};              // where no points are asked for
};

struct Localisation {
  std::optional<TrackedFrame> tracked;  // empty when the frame was not found
  // Places that show the frame, most inliers first; no two of them can be right. Not empty where two places fit.
  std::vector<TrackedFrame> places_found{};
  LocalisationFailure failure = LocalisationFailure::too_few_features;
  int places = 0;   // places tried
  int matches = 0;  // matches by words at the place that came furthest; zero before any was tried
  int inliers = 0;  // features that agreed with a pose in the last step it came to
};

// What speaks for or against places besides the image. Empty functions: nothing.
struct PlaceFilter {
  std::function<bool(KeyframeId)> is_excluded{};             // the keyframe is no place
  std::function<bool(const TrackedFrame&)> is_impossible{};  // the camera cannot be where the frame was found
};

// Finds a frame in the map without any guess of its pose: places that share visual words, matches of their points,
// a pose from three points at a time, points looked for around it, and refinement on all of them. Accepted only when
// many points agree, spread over the image, and determine the pose, and no other place does as well.
Localisation localise(const Frame& frame, const Rig& rig, const MapView& map, const PlaceIndex& index,
                      const LocaliseOptions& options, const PlaceFilter& filter = {});

// The same at places that were found already, for a frame whose words are known.
Localisation localise_at(const Frame& frame, std::span<const Word> words, const Rig& rig, const MapView& map,
                         const Vocabulary& vocabulary, std::span<const PlaceCandidate> places,
                         const LocaliseOptions& options, const PlaceFilter& filter = {});

// Standard deviation of the pixels along the direction in which they spread least, as a share of the image's diagonal.
double spread_of(std::span<const TrackedFeature> features, const Rig& rig);

// Why a pose, however it was found, is not to be relied on; none when it is.
LocalisationFailure reason_to_doubt(const TrackedFrame& tracked, const Rig& rig, const MapView& map,
                                    const LocaliseOptions& options);

}  // namespace byre
