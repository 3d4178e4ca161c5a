#include "byre/slam/frame/state.h"

#include "byre/base/enum_names.h"
#include "byre/session_event.h"

namespace byre {

std::string_view to_string(SessionEvent event) {
  return name_among<SessionEvent::map_changed>(
      {"initialised", "localised", "pose lost", "relocalised", "blinded", "left mapped area", "entered mapped area",
       "navigation error", "restarted", "place refused", "place refuted", "online map corrected", "loop found",
       "map corrected", "recalibrated", "dirt on the lens", "lens is clean", "tag moved", "map changed"},
      event);
}

std::string_view to_string(State state) {
  return name_among<State::lost>({"initialising", "tracking", "relocalising", "lost"}, state);
}

State next_state(State state, const Evidence& evidence, const StateOptions& options) {
  if (evidence.pose_found && evidence.pose_confirmed) return State::tracking;
  if (state == State::initialising) return evidence.pose_found ? State::relocalising : State::initialising;
  const bool is_lost = state == State::lost || evidence.seconds_without_pose >= options.lost_after;
  return is_lost ? State::lost : State::relocalising;
}

OfflineView view_of_offline(const OfflineEvidence& evidence, const OfflineViewOptions& options) {
  if (evidence.inliers >= options.min_inliers) return OfflineView::held;
  if (evidence.image_is_faulty || evidence.features < options.min_features) return OfflineView::blinded;
  return evidence.expected < options.min_expected ? OfflineView::off_the_map : OfflineView::changed;
}

}  // namespace byre
