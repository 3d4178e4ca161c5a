#pragma once

#include "byre/map.h"
#include "byre/place/vocabulary.h"
#include "byre/slam/upkeep/replay.h"
#include "byre/slam/upkeep/stored_session.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// A map with what a map file holds for its upkeep.
struct MapVersion {
  std::uint64_t id = 0;
  StoredMap stored;
  std::vector<Survival> survival;  // by point; empty: unknown
};

struct SessionUse {
  std::string name;
  SessionPlace place;        // its fault excludes the session
  bool has_records = false;  // sightings and misses count: it ran on this very version
  ImageCondition image;      // mean over its poses, shows the light
  // Its frames by place, in its light; their faults alone do not refuse the child. Empty without a child.
  std::vector<PlaceProof> places{};
  int keyframes_added = 0;
  int points_added = 0;
};

struct MapUpdate {
  std::vector<SessionUse> sessions;
  int points_retired = 0;
  int keyframes_removed = 0;       // without points that are left, or over the budget of their place
  std::vector<PlaceProof> places;  // by the frames of all used sessions
  int places_spared = 0;           // left as they are, since a first attempt made them worse
  std::string refusal{};           // why there is no child; empty: there is one
  std::optional<StoredMap> child;
  std::vector<Survival> survival;  // survival of the child's points
};

// Steps of the update, before each of them.
using StepHook = std::function<void(const char* step)>;

// Updates a map by sessions of missions that ran on it. Points that are unlikely to exist by now are removed; keyframes
// and points of new or changed places are added and adjusted around the others, which do not move. Places keep to a
// budget of keyframes. Places that an attempt makes worse are left as they are in the next one. There is a child only
// if no place of the sessions' frames is worse than before, see PlaceProof. Preconditions: keyframes have words of the
// vocabulary; the map is metric.
MapUpdate update_map(
    const MapVersion& parent, const std::vector<StoredSession>& sessions, const Vocabulary& vocabulary,
    const StepHook& before_step = [](const char*) {});

// Reduces a map to a number of keyframes for each place, within 1 m and 0.5 rad, by what the others cover: see
// keep_to_budget(). The other keyframes and points do not move. Places whose keyframes would be localised worse are
// left as they are. Without a child if no keyframe can be removed. Preconditions: as for update_map().
MapUpdate summarise_map(
    const MapVersion& parent, int keyframes_of_place, const Vocabulary& vocabulary,
    const StepHook& before_step = [](const char*) {});

// Updates that a map was made by, the newest first, by its notes.
std::vector<MapHistory> history_of(const StoredMap& stored);

// Reason against replacing a map by another version; empty: none. The frames of a session are localised in both, and no
// place may be worse, see PlaceProof. A version that the map was made of needs no proof: a reviewer returns to it.
// Preconditions: those of update_map().
std::string fault_of_replacement(const MapVersion& map, const MapVersion& next, const StoredSession& session,
                                 const Vocabulary& vocabulary);

}  // namespace byre
