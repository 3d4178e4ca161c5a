#pragma once

#include "byre/slam/session/session_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace byre {

inline constexpr int kLapFrames = 120;  // frames, at 10 Hz

inline SimulatedMission laps_of_room(double laps, std::uint64_t noise_seed, std::uint64_t room = 1) {
  SimulationOptions options;
  options.seed = room;
  options.noise_seed = noise_seed;
  const int frames = static_cast<int>(kLapFrames * laps);
  return simulate_mission(simulated_rig(), circling_trajectory(frames, 10.0, 2.0, laps), options);
}

// Map of so many laps, made by another visit.
inline std::shared_ptr<const OfflineMap> mapped(double laps, std::uint64_t room = 1) {
  return offline_map_of(laps_of_room(laps, 1, room));
}

inline Session session_on(std::shared_ptr<const OfflineMap> offline, const SessionOptions& options = {}) {
  return {simulated_rig(), options, SessionExecutors(make_inline_executor(), make_inline_executor()),
          simulated_vocabulary(), std::move(offline)};
}

inline int count(const std::vector<FrameReport>& reports, SessionEvent event) {
  return static_cast<int>(std::ranges::count_if(reports, [=](const FrameReport& report) { return report.has(event); }));
}

inline int count_trusted(const std::vector<FrameReport>& reports) {
  return static_cast<int>(
      std::ranges::count(reports, Verdict::trusted, [](const FrameReport& report) { return report.health.verdict; }));
}

// Largest error of trusted poses, metres; the map's frame is that of the truth.
inline double worst_trusted(const std::vector<FrameReport>& reports, const Trajectory& truth) {
  double worst = 0.0;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (reports[i].health.verdict != Verdict::trusted) continue;
    worst = std::max(worst, (reports[i].map_from_body->translation - truth[i].world_from_body.translation).norm());
  }
  return worst;
}

}  // namespace byre
