#pragma once

#include "byre/localisation_failure.h"
#include "byre/map/map_view.h"
#include "byre/map/mapped_tag.h"
#include "byre/place/place_index.h"
#include "byre/place/vocabulary.h"
#include "byre/slam/frame/focal_check.h"
#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/tracking/tracking.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace byre {

struct PlaceMatchOptions {
  int levels_up = 2;        // levels of the vocabulary above words; features under the same node are compared
  int max_distance = 60;    // bits between descriptors
  float max_ratio = 0.85f;  // best over second best distance
};

// Matches a frame without a predicted pose: its features with those of each keyframe that see a point, among features
// of similar words, if mutually best. A feature keeps the most similar point of all keyframes, and a point the most
// similar feature. Ordered by feature. Skips keyframes without words. words: of the frame, one per feature.
std::vector<PointMatch> match_place(const Features& frame, std::span<const Word> words, const MapView& map,
                                    std::span<const KeyframeId> keyframes, const Vocabulary& vocabulary,
                                    const PlaceMatchOptions& options);

// Candidate places of a frame.
inline constexpr PlaceQueryOptions kPlacesTried{.max_candidates = 10, .group_size = 10, .min_score_share = 0.3f};

// Share of the best place's inliers from which a second place is a rival.
inline constexpr double kRivalShare = 0.7;

inline constexpr int kKeyframesOfPlace = 20;  // keyframes whose points are matched around a first pose

struct LocaliseOptions {
  std::uint64_t seed = 0;  // seed of RANSAC
  int min_inliers = 30;    // final inliers
  // Standard deviation of the inliers in their narrowest direction, share of the image diagonal.
  double min_spread = 0.04;
  double max_position_sigma = 0.02;  // sigma of the position over the median depth of the inliers
  double max_rotation_sigma = 0.02;  // radians
  ImageMask hidden{};                // image cells without expected points
  // Tags of the map. A frame that shows one is also localised around the pose by its corners; a pose is still found by
  // map points. Of places that fit as well, the only one that agrees with the tags is the place.
  std::span<const MappedTag> tags{};
};

struct Localisation {
  std::optional<TrackedFrame> tracked;  // empty: not localised
  // Places that show the frame, most inliers first, contradicting each other. Not empty if two places fit.
  std::vector<TrackedFrame> places_found{};
  LocalisationFailure failure = LocalisationFailure::too_few_features;
  int places = 0;   // places tried
  int matches = 0;  // word matches at the place with most progress; 0 before any was tried
  int inliers = 0;  // inliers of the last step reached
  // By the word matches, if many agree on a pose that too few points confirm, as with a wrong focal length.
  std::optional<FocalEvidence> focal{};
};

// Constraints on places besides the image. Empty functions: no constraint.
struct PlaceFilter {
  std::function<bool(KeyframeId)> is_excluded{};             // the keyframe is not searched
  std::function<bool(const TrackedFrame&)> is_impossible{};  // the camera cannot be at the tracked pose
};

// Localises a frame without a prediction: candidate places by visual words, matches with their points, RANSAC with
// three points, guided matching around that pose, and refinement. Succeeds only if many points agree, are spread over
// the image and constrain the pose, and no other place fits as well.
Localisation localise(const Frame& frame, const Rig& rig, const MapView& map, const PlaceIndex& index,
                      const LocaliseOptions& options, const PlaceFilter& filter = {});

// Same at given candidate places, for a frame with given words.
Localisation localise_at(const Frame& frame, std::span<const Word> words, const Rig& rig, const MapView& map,
                         const Vocabulary& vocabulary, std::span<const PlaceCandidate> places,
                         const LocaliseOptions& options, const PlaceFilter& filter = {});

// Poses camera_from_world by each of these tags that the frame shows. Two poses may explain one tag, see
// estimate_tag_pose.
std::vector<Pose> camera_poses_by_tags(const Frame& frame, const Rig& rig, std::span<const MappedTag> tags);

// Standard deviation of the pixels in their narrowest direction, share of the image diagonal.
double spread_of(std::span<const TrackedFeature> features, const Rig& rig);

// Reason why a pose, however estimated, is unreliable; none if it is reliable.
LocalisationFailure rejection_reason(const TrackedFrame& tracked, const Rig& rig, const MapView& map,
                                     const LocaliseOptions& options);

}  // namespace byre
