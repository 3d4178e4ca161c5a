#pragma once

// Helpers for tests of the session.

#include "byre/slam/places/place_scene.h"
#include "byre/slam/session/session.h"
#include "byre/slam/tracking/mission_scene.h"

#include <memory>
#include <vector>

namespace byre {

inline Frame without_features(const Frame& frame) {
  return {frame.time, std::make_shared<const Features>()};
}

inline std::vector<FrameReport> reports_of(Session& session, const std::vector<Frame>& frames) {
  std::vector<FrameReport> reports;
  for (const Frame& frame : frames) reports.push_back(session.process(frame));
  return reports;
}

}  // namespace byre
