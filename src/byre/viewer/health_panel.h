#pragma once

#include "byre/slam/health.h"
#include "byre/slam/state.h"
#include "byre/viewer/picture.h"

#include <string>

namespace byre {

inline constexpr int kHealthPanelWidth = 300;  // pixels

// State, verdict and doubt of a frame, and a meter for each measure with a tick where the limits have it.
Pane health_panel(const std::string& title, State state, const Health& health, const HealthOptions& limits);

}  // namespace byre
