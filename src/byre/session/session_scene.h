#pragma once

// What tests of the session have in common.

#include "byre/session/session.h"
#include "byre/slam/mission_scene.h"
#include "byre/slam/place_scene.h"

#include <memory>
#include <utility>
#include <vector>

namespace byre {

// Trained on a lap in a simulated room.
inline const Vocabulary& simulated_vocabulary() {
  static const Vocabulary trained =
      vocabulary_of(simulate_mission(simulated_rig(), circling_trajectory(120, 10.0, 2.0, 1.0), {}));
  return trained;
}

// The map of a visit before, by its true poses; each fourth frame is a keyframe.
inline std::shared_ptr<const OfflineMap> offline_map_of(const SimulatedMission& visit) {
  Map map = true_map(visit, 4, Origin::offline);
  for (const KeyframeId id : map.keyframe_ids()) {
    map.set_words(id, simulated_vocabulary().words_of(*map.find_keyframe(id)->frame.features));
  }
  return std::make_shared<const OfflineMap>(std::move(map), simulated_vocabulary());
}

inline std::vector<FrameReport> reports_of(Session& session, const std::vector<Frame>& frames) {
  std::vector<FrameReport> reports;
  for (const Frame& frame : frames) reports.push_back(session.process(frame));
  return reports;
}

}  // namespace byre
