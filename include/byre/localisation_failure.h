#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// Reasons why localisation failed, ordered by the progress of the attempt.
enum class LocalisationFailure : std::uint8_t {
  none,
  too_few_features,     // the image is dark, blurred or blank
  no_similar_keyframe,  // no keyframe of the map looks similar
  too_few_matches,      // too few features match points of similar places
  geometry_disagrees,   // no pose explains the matches
  too_few_inliers,      // too few points around the pose are found
  clustered,            // the inliers lie in a small part of the image
  uncertain,            // the inliers do not constrain the pose enough
  impossible,           // the camera cannot be at the place found
  unlikely,             // too few of the points that the place should show are found
  ambiguous             // two places fit the image, or the building repeats and may do so beyond the map
};

std::string_view to_string(LocalisationFailure failure);

}  // namespace byre
