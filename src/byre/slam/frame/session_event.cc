#include "byre/session_event.h"

#include "byre/base/enum_names.h"

namespace byre {

std::string_view to_string(SessionEvent event) {
  return name_among<SessionEvent::dirt_gone>(
      {"initialised", "localised", "pose lost", "relocalised", "blinded", "left mapped area", "entered mapped area",
       "navigation error", "restarted", "place refused", "place refuted", "online map corrected", "loop found",
       "map corrected", "recalibrated", "dirt on the lens", "lens is clean"},
      event);
}

}  // namespace byre
