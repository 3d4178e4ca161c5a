#pragma once

#include "known_map.h"
#include "mission_plan.h"
#include "mission_score.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace byre {

// Which map the mission is given.
struct MapChoice {
  MapRecipe recipe;
  double share_deleted = 0.0;  // share of the map's points that are deleted
  std::optional<Span> hole{};  // seconds of its recording of which it knows nothing
  bool is_of_another_place = false;
  bool is_absent = false;  // plain SLAM, its frame laid on the truth by the first pose
};

// What the robot must get right beyond never trusting a wrong pose for long.
struct Demand {
  bool recovers = true;            // trusted again soon after the disturbance
  double min_trusted_share = 0.0;  // least share of all frames that are trusted
  bool is_never_wrong = false;     // no frame is trusted that is off by more than kMaxTrustedError
  std::optional<Doubt> doubt{};    // is told within kMaxTimeToDoubt of when the disturbance begins
};

// A mission that tries the session's health.
struct MissionCase {
  std::string name;
  RecordingName recording;
  FrameRange range;
  MapChoice map;
  std::function<MissionPlan(const std::vector<Timestamp>& times)> plan;
  Demand demand{};
  std::optional<double> mapped_again_after{};  // seconds: when it comes back from outside the mapped area
  Imperfection imperfection{};                 // imperfection of the mission's camera
};

inline constexpr double kMaxWrongTrust = 0.5;   // seconds
inline constexpr double kMaxRecovery = 2.0;     // seconds
inline constexpr double kMaxTimeToDoubt = 0.5;  // seconds

// The same with the cameras of map and mission in this condition, and the map's error of calibration drawn by the seed.
// Where mission and map had one error they still do.
MissionCase flown_with(MissionCase mission_case, const Imperfection& imperfection);

std::vector<MissionCase> real_mission_cases();
std::vector<MissionCase> twin_mission_cases();

// What cameras may say that is not so, in the hall and in the rendered room, with the map of it and without any.
std::vector<MissionCase> lying_mission_cases();

// The first recording that the case needs and that is not there.
std::optional<RecordingName> missing_recording(const MissionCase& mission_case);

struct FlownMission {
  std::vector<MissionFrame> frames;
  std::optional<Similarity> truth_from_map;  // empty when the map is of another place
  MissionScore score;
};

// Maps that were made or loaded, for the missions that follow. Owned by the calling thread.
class KnownMaps {
 public:
  // Throws InputError when the map's recording is missing or damaged.
  KnownMap get(const MapChoice& choice);

 private:
  std::map<std::string, KnownMap> maps_;
};

// Throws InputError when a recording is missing or damaged.
FlownMission fly(const MissionCase& mission_case, KnownMaps& maps);

// What the mission should have got right and did not, in words.
std::vector<std::string> broken_demands(const MissionCase& mission_case, const MissionScore& score);

}  // namespace byre
