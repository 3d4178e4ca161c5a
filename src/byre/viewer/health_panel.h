#pragma once

#include "byre/slam/frame/health.h"
#include "byre/slam/frame/state.h"
#include "byre/viewer/picture.h"

#include <string>

namespace byre {

inline constexpr int kHealthPanelWidth = 300;  // pixels

// State, verdict and doubt of a frame, and a meter per health measure with a tick at its limit.
Pane health_panel(const std::string& title, State state, const Health& health, const HealthOptions& limits);

}  // namespace byre
