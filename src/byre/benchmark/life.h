#pragma once

#include "byre/map.h"
#include "byre/playback/play.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Life of a map: recordings of one building in order of name, as of "byre simulate life". The first is mapped; each
// later one is a mission on the first version of the map, and another on its newest version, which is then updated by
// what that mission learned.
struct LifeCase {
  std::filesystem::path folder;                     // folder of the recordings, each with ground truth
  std::filesystem::path output;                     // receives versions of the map and sessions
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  MethodOptions method;
};

// A mission of a life. Shares of all frames; errors of causal poses in the map's frame, metres.
struct LifeMission {
  double trusted = 0.0;      // share of frames
  double within_5_cm = 0.0;  // share of frames
  int wrongly_trusted = 0;   // trusted frames off by more than 0.2 m
  double median_error = 0.0;
  double greatest_error = 0.0;
  double offline_inliers = 0.0;  // median
};

struct LifeDay {
  std::string name;
  LifeMission first;  // on the first version
  LifeMission newest;
  std::optional<MapUpdateResult> update;  // empty: the mission stored no session
  double update_seconds = 0.0;
  double update_memory_mb = 0.0;  // peak, with the program's own
  double session_mb = 0.0;
  double map_mb = 0.0;  // newest version after the day
};

// Frames localised without a prediction in a version of the map.
struct VersionLocalisation {
  int in_view = 0;  // frames from whose true pose 60 points of the map are in view
  int found = 0;    // frames among them localised within 0.2 m of the truth
  int falsely = 0;  // all frames localised farther from the truth
};

// Frames of the last days, localised in the first and in the newest version.
struct LifeLocalisation {
  int frames = 0;
  VersionLocalisation first;
  VersionLocalisation newest;
  // Change of the median pose of a place, a 2 m square, between both versions; the greatest over all places.
  int places = 0;
  double shift = 0.0;  // metres
  double turn = 0.0;   // degrees
};

struct LifeResult {
  double first_map_mb = 0.0;
  std::vector<LifeDay> days;
  std::optional<LifeLocalisation> localisation;  // empty if stopped
  bool stopped = false;
};

struct LifeHooks {
  std::function<bool()> should_stop;
  std::function<void(const std::string& what, int frames)> before_run;
  std::function<void(int done, const PlayedFrame& frame)> after_frame;
  std::function<void(const LifeResult& so_far)> after_day;
};

// Throws InputError if the folder holds fewer than two recordings, or one of them cannot be used.
LifeResult measure_life(const LifeCase& life, const LifeHooks& hooks);

std::string life_markdown(const LifeResult& result);
std::string life_json(const LifeResult& result);
std::string life_plot(const LifeResult& result);  // SVG: curves over the days, with and without updates

}  // namespace byre
