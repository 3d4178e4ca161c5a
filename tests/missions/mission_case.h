#pragma once

#include "aligned_map.h"
#include "mission_plan.h"
#include "mission_score.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace byre {

struct MapChoice {
  MapRecipe recipe;
  double share_deleted = 0.0;
  std::optional<Span> hole{};  // seconds of its recording removed from the map
  bool is_of_another_place = false;
  bool is_absent = false;  // plain SLAM; its frame is aligned to the truth by the first pose
};

// Requirements beyond never trusting a wrong pose for long.
struct Requirements {
  bool recovers = true;                   // trusted again within kMaxRecovery of the disturbance's end
  double min_trusted_share = 0.0;         // least share of trusted frames
  bool is_never_wrong = false;            // no trusted frame has an error above kMaxTrustedError
  std::optional<DistrustReason> doubt{};  // is reported within kMaxTimeToDoubt of the disturbance's begin
};

struct MissionCase {
  std::string name;
  RecordingName recording;
  FrameRange range;
  MapChoice map;
  std::function<MissionPlan(const std::vector<Timestamp>& times)> plan;
  Requirements requirements{};
  std::optional<double> mapped_again_after{};  // seconds after which the robot is back in the mapped area
  Imperfection imperfection{};
  bool is_long_run = false;  // only in the long suite; another case of the default suite has the same kind of fault
};

// The cases of the default suite, or those that only the long suite has.
template <typename Case>
std::vector<Case> select_cases(std::vector<Case> cases, bool is_long_run) {
  std::erase_if(cases, [&](const Case& other) { return other.is_long_run != is_long_run; });
  return cases;
}

inline constexpr double kMaxWrongTrust = 0.5;   // seconds
inline constexpr double kMaxRecovery = 2.0;     // seconds
inline constexpr double kMaxTimeToDoubt = 0.5;  // seconds

// The case with cameras of map and mission in this condition, and the map's calibration error drawn by its seed.
// Mission and map still share one error if they did before.
MissionCase with_imperfection(MissionCase mission_case, const Imperfection& imperfection);

std::vector<MissionCase> real_mission_cases();
std::vector<MissionCase> twin_mission_cases();

// Sensor faults in the hall and in the rendered room, with and without their map.
std::vector<MissionCase> sensor_fault_cases();

// First missing recording of a case.
std::optional<RecordingName> missing_recording(const MissionCase& mission_case);

struct MissionRun {
  std::vector<MissionFrame> frames;
  std::optional<Similarity> truth_from_map;  // empty when the map is of another place
  MissionScore score;
};

// Cache of maps for a sequence of missions. Owned by the calling thread.
class MapCache {
 public:
  // Throws InputError when the map's recording is missing or damaged.
  AlignedMap get(const MapChoice& choice);

 private:
  std::map<std::string, AlignedMap> maps_;
};

// Runs a mission. Throws InputError when a recording is missing or damaged.
MissionRun run_mission(const MissionCase& mission_case, MapCache& maps);

// Descriptions of the unmet requirements.
std::vector<std::string> unmet_requirements(const MissionCase& mission_case, const MissionScore& score);

}  // namespace byre
