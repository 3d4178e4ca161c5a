#pragma once

#include "imperfection.h"
#include "mission_score.h"

#include "byre/recording.h"
#include "byre/slam/places/offline_map.h"

#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace byre {

// Missions on a map that start at regular times of a recording.
struct StartPlan {
  double every_s = 0.5;    // seconds between starts
  double length_s = 11.0;  // duration of each mission, seconds
  double from_s = 0.0;     // first start, seconds of the recording
  double to_s = 1e9;
  std::optional<std::pair<double, double>> cover_s{};  // interval of black images, seconds after each start
};

struct StartedMission {
  double start_s = 0.0;  // seconds of the recording
  std::vector<MissionFrame> frames;
  MissionScore score;
  // The map was in view for kMaxTimeToLocalise without a trusted pose.
  bool is_localised_late = false;
};

// Sums over all starts.
struct StartTotals {
  int starts = 0;
  int frames = 0;
  int with_pose = 0;
  int correctly_trusted = 0;       // trusted frames with an error up to kMaxTrustedError
  int wrongly_trusted = 0;         // trusted frames with a larger error
  int starts_wrongly_trusted = 0;  // starts with such a frame
  int localised_late = 0;
  double worst_trusted_error = 0.0;  // metres

  void add(const StartedMission& mission);
};

inline constexpr double kMaxTimeToLocalise = 3.0;  // seconds
inline constexpr int kPointsInView = 60;           // points seen by keyframes near the true pose: the map is in view

// Starts missions with the recording's images, extracted once, and its wheels and gyroscope if opened. each: called
// after each mission. Throws InputError for damaged data.
StartTotals run_starts(Recording& recording, const Trajectory& truth, std::shared_ptr<const OfflineMap> map,
                       const Similarity& truth_from_map, const Imperfection& imperfection, const StartPlan& plan,
                       const std::function<void(const StartedMission&)>& each);

}  // namespace byre
