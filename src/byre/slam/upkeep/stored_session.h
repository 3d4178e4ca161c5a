#pragma once

#include "byre/map/map_upkeep.h"
#include "byre/slam/upkeep/replay.h"

#include <span>
#include <string>

namespace byre {

// A session as loaded from its file.
struct StoredSession {
  std::string name;  // in messages
  StoredMap stored;  // online map of the mission
  SessionRecord record;
};

// Fault that excludes a session from an update, apart from its place; empty without one. `maps`: the ids of the map and
// of the versions that it was made of.
std::string fault_of(const StoredSession& session, const StoredMap& map, std::span<const std::uint64_t> maps);

// Agreement of a session's poses with those found by offline points alone. Frames from outside the map count only where
// they are found at their poses: a building that repeats looks alike from there.
struct SessionPlace {
  int frames = 0;
  int found = 0;
  int elsewhere = 0;    // found away from the session's pose
  std::string fault{};  // empty: the session fits the map
};
SessionPlace place_of(std::span<const ReplayFrame> frames, std::span<const Replayed> found, const MapGraph& map);

// Mean condition of the images of a session.
ImageCondition mean_condition(const SessionRecord& record);

// The session's map beside the offline one: copies of offline points become sightings of them. Copies of points that
// the offline map no longer has stay points.
MapGraph online_beside(const StoredSession& session, const MapGraph& offline);

}  // namespace byre
