#pragma once

#include <cstdint>
#include <string_view>

namespace byre {

// Event in a frame, for logs and operators.
enum class SessionEvent : std::uint8_t {
  initialised,          // first map initialised
  localised,            // first confirmed pose in the offline map
  pose_lost,            // tracking failed, see Health::doubt
  relocalised,          // confirmed pose after a loss
  blinded,              // offline points lost: the image shows too little, as it is dark, blurred, covered or blank
  left_mapped_area,     // offline points lost as predicted from the extent of the map
  entered_mapped_area,  // offline points support the pose again
  navigation_error,     // no confirmed pose for 10 s (option mission.lost_after_s); once per loss
  restarted,            // new submap of the online map started, as relocalisation failed
  place_refused,     // impossible place found, see FrameReport::refused_place; once per reason until a pose is trusted
  place_refuted,     // trusted place rejected for a similar-looking one: earlier poses are unreliable
  online_corrected,  // online map moved to agree with the offline map
  loop_found,        // loop closed in the online map: duplicate points fused, or a correction started
  map_corrected,     // correction of the whole online map applied
  recalibrated,      // refined calibration applied
  dirt_found,        // dirt on a lens detected; again when the hidden share has grown by half
  dirt_gone,
  tag_moved,   // tag contradicts the accepted pose repeatedly, see FrameReport::moved_tags
  map_changed  // first frame on another map of the site, or after a lift; see FrameReport::map
};

std::string_view to_string(SessionEvent event);

}  // namespace byre
