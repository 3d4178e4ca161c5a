#include "byre/session_event.h"

namespace byre {

std::string_view to_string(SessionEvent event) {
  switch (event) {
    case SessionEvent::initialised:
      return "initialised";
    case SessionEvent::localised:
      return "localised";
    case SessionEvent::pose_lost:
      return "pose lost";
    case SessionEvent::relocalised:
      return "relocalised";
    case SessionEvent::blinded:
      return "blinded";
    case SessionEvent::left_mapped_area:
      return "left mapped area";
    case SessionEvent::entered_mapped_area:
      return "entered mapped area";
    case SessionEvent::navigation_error:
      return "navigation error";
    case SessionEvent::restarted:
      return "restarted";
    case SessionEvent::place_refused:
      return "place refused";
    case SessionEvent::place_refuted:
      return "place refuted";
    case SessionEvent::online_corrected:
      return "online map corrected";
    case SessionEvent::loop_found:
      return "loop found";
    case SessionEvent::map_corrected:
      return "map corrected";
    case SessionEvent::recalibrated:
      return "recalibrated";
    case SessionEvent::dirt_found:
      return "dirt on the lens";
    case SessionEvent::dirt_gone:
      return "lens is clean";
  }
  return "";
}

}  // namespace byre
