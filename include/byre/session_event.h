#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// What may happen in a frame and is worth telling somebody.
enum class SessionEvent : std::uint8_t {
  initialised,          // a first map was made of what is seen
  localised,            // found in the offline map for the first time, and confirmed
  pose_lost,            // tracking failed, see Health::doubt for why
  relocalised,          // found again, and confirmed
  blinded,              // the image shows too little: dark, blurred, covered or blank
  left_mapped_area,     // no offline point in view any more, as the map's extent led to expect
  entered_mapped_area,  // offline points hold the pose again
  navigation_error,     // not known where the robot is for StateOptions::lost_after; told once each time
  restarted,            // a new submap of the online map was begun, for the way back was not found
  place_refused,        // found where the robot cannot be, see FrameReport::refused_place; told once each time
  place_refuted,        // it was tracked and trusted at a place that looks alike: poses before are not to be relied on
  online_corrected,     // the online map was moved so that it agrees with the offline one
  loop_found,           // the online map met itself: its ends are fused, or a correction was begun
  map_corrected,        // a correction of the whole online map was taken over
  recalibrated,         // what the map tells of the calibration was taken over
  dirt_found,           // dirt on a lens hides a part of the image; told again when it has become half as much again
  dirt_gone             // no part of an image is hidden any more
};

std::string_view to_string(SessionEvent event);

}  // namespace byre
