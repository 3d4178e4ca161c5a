#include "byre/slam/upkeep/update_map.h"

#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/upkeep/additions.h"
#include "byre/slam/upkeep/place_budget.h"
#include "byre/slam/upkeep/point_survival.h"

#include <algorithm>
#include <charconv>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace byre {
namespace {

constexpr const char* kHistoryNote = "history";
constexpr std::size_t kIdDigits = 16;

// A session that fits the map.
struct Fitting {
  const StoredSession* session = nullptr;
  std::size_t number = 0;  // among all sessions
  std::vector<ReplayFrame> frames;
  std::vector<Replayed> found = {};  // in the parent
  // Map of the session, adjusted around the points of the parent.
  MapGraph online{Origin::online};
};

// Centres of places that stay as they are.
using SparedPlaces = std::vector<Eigen::Vector3d>;

bool is_spared(const SparedPlaces& places, const Keyframe& keyframe) {
  constexpr double kNear = 4.0;  // metres
  const Eigen::Vector3d camera_in_map = inverse(keyframe.camera_from_world).translation;
  return std::ranges::any_of(places,
                             [&](const Eigen::Vector3d& centre) { return (camera_in_map - centre).norm() < kNear; });
}

std::vector<std::uint64_t> versions_of(const MapVersion& map) {
  std::vector<std::uint64_t> versions = {map.id};
  for (const MapHistory& entry : history_of(map.stored)) versions.push_back(entry.parent);
  return versions;
}

// Sets the places of the sessions.
std::vector<Fitting> place_sessions(const MapVersion& parent, const std::vector<StoredSession>& sessions,
                                    const PlaceIndex& index, std::vector<SessionUse>& uses) {
  const std::vector<std::uint64_t> versions = versions_of(parent);
  std::vector<Fitting> fitting;
  for (const StoredSession& session : sessions) {
    SessionUse& use = uses.emplace_back();
    use.name = session.name;
    use.image = mean_condition(session.record);
    use.place.fault = fault_of(session, parent.stored, versions);
    if (!use.place.fault.empty()) continue;
    Fitting fits{&session, uses.size() - 1, frames_to_replay(session.stored.map)};
    fits.found = replay(fits.frames, parent.stored.map, index);
    use.place = place_of(fits.frames, fits.found, parent.stored.map);
    use.has_records = session.record.map_id == parent.id &&
                      session.record.points.size() == static_cast<std::size_t>(parent.stored.map.point_count());
    if (use.place.fault.empty()) fitting.push_back(std::move(fits));
  }
  return fitting;
}

std::vector<Survival> survival_by(const MapVersion& parent, const std::vector<Fitting>& fitting,
                                  const std::vector<SessionUse>& uses) {
  std::vector<Survival> survival = parent.survival;
  survival.resize(static_cast<std::size_t>(parent.stored.map.point_count()), kSurvivalOfNewPoint);
  for (const Fitting& fits : fitting) {
    if (!uses[fits.number].has_records) continue;
    const std::vector<PointRecord>& records = fits.session->record.points;
    for (std::size_t i = 0; i < survival.size(); ++i) survival[i] = survival_after(survival[i], records[i]);
  }
  return survival;
}

bool is_found_elsewhere(const Fitting& fits, Timestamp time) {
  for (std::size_t i = 0; i < fits.frames.size(); ++i) {
    if (fits.frames[i].frame.time == time) return is_elsewhere(fits.frames[i], fits.found[i]);
  }
  return false;
}

void add_session(const Fitting& fits, const MapGraph& parent, const SparedPlaces& spared, StoredMap& child,
                 SessionUse& use) {
  std::vector<KeyframeId> keyframes = keyframes_to_add(parent, child.map, fits.online);
  std::erase_if(keyframes, [&](KeyframeId id) {
    const Keyframe& keyframe = *fits.online.find_keyframe(id);
    return is_spared(spared, keyframe) || is_found_elsewhere(fits, keyframe.frame.time);
  });
  use.keyframes_added = use.points_added = 0;
  if (keyframes.empty()) return;
  const Added added = add_keyframes(fits.online, keyframes, static_cast<int>(child.recordings.size()), child.map);
  child.recordings.push_back(fits.session->stored.recordings.back());
  use.keyframes_added = added.keyframes;
  use.points_added = added.points;
}

void retire(std::vector<PointId> points, const SparedPlaces& spared, MapGraph& map, MapUpdate& update) {
  std::erase_if(points, [&](PointId id) {
    return std::ranges::any_of(map.observations(id), [&](const Observation& seen) {
      return is_spared(spared, *map.find_keyframe(seen.keyframe));
    });
  });
  for (const PointId id : points) map.remove_point(id);
  update.points_retired = static_cast<int>(points.size());
  update.keyframes_removed = 0;
  const auto sees_a_point = [](const Sighting& sighting) { return sighting.point.has_value(); };
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    if (std::ranges::any_of(keyframe.sightings, sees_a_point) || !keyframe.parent) continue;
    map.remove_keyframe(id);
    ++update.keyframes_removed;
  }
}

// By point number.
std::vector<Survival> survival_with(std::vector<Survival> survival, const MapGraph& added_points) {
  survival.resize(std::max(survival.size(), static_cast<std::size_t>(added_points.point_ids().back().number) + 1),
                  kSurvivalOfNewPoint);
  return survival;
}

// Ids without gaps, and the survival of each point.
void renumber(StoredMap& child, const std::vector<Survival>& survival, MapUpdate& update) {
  update.survival.clear();
  for (const PointId id : child.map.point_ids()) update.survival.push_back(survival[id.number]);
  child.map = offline_copy(std::move(child.map));
}

std::string describe(const MapUpdate& update) {
  std::vector<std::string> names;
  int keyframes = 0, points = 0;
  for (const SessionUse& use : update.sessions) {
    if (!use.place.fault.empty()) continue;
    names.push_back(use.name);
    keyframes += use.keyframes_added;
    points += use.points_added;
  }
  return fmt::format("{}: {} keyframes and {} points added, {} points retired", fmt::join(names, ", "), keyframes,
                     points, update.points_retired);
}

void note_history(const MapVersion& parent, const std::string& change, StoredMap& child) {
  std::string& history = child.notes[kHistoryNote];
  history = to_text(parent.id) + " " + change + " (byre " BYRE_VERSION ")" + (history.empty() ? "" : "\n") + history;
}

// Frames at places that a child must not make worse.
struct Witnesses {
  double least_inliers = 0.9;  // see compare_places()
  std::vector<ReplayFrame> frames;
  std::vector<Replayed> found{};  // in the parent
};

// Empty if no place is worse.
std::string fault_of_places(std::span<const PlaceProof> places) {
  const auto worse = std::ranges::count_if(places, [](const PlaceProof& place) { return !place.fault.empty(); });
  return worse == 0 ? "" : fmt::format("{} of {} places would be worse than before", worse, places.size());
}

// Keeps the places of keyframes as they are, except those spared. Returns the survival by point number of the child.
using Change = std::function<std::vector<Survival>(const SparedPlaces&, StoredMap& child)>;

// Changes a copy of the parent, by several attempts: places that one makes worse are spared in the next. Returns the
// witnesses in the child.
std::vector<Replayed> make_child(const MapVersion& parent, const Witnesses& witnesses, const Change& change,
                                 const Vocabulary& vocabulary, const StepHook& before_step, MapUpdate& update) {
  constexpr int kAttempts = 3;
  SparedPlaces spared;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    StoredMap child = parent.stored;
    renumber(child, change(spared, child), update);
    before_step("replaying frames on both maps");
    std::vector<Replayed> after = replay(witnesses.frames, child.map, index_of(child.map, vocabulary));
    update.places = compare_places(witnesses.frames, witnesses.found, after, witnesses.least_inliers);
    const std::size_t spared_before = spared.size();
    for (const PlaceProof& place : update.places) {
      if (!place.fault.empty()) spared.push_back(place.centre_in_map);
    }
    if (spared.size() > spared_before) continue;
    update.places_spared = static_cast<int>(spared.size());
    update.child = std::move(child);
    return after;
  }
  update.refusal = fault_of_places(update.places);
  return {};
}

// after: frames of all fitting sessions in the child.
void compare_by_session(const std::vector<Fitting>& fitting, std::span<const Replayed> after,
                        std::vector<SessionUse>& uses) {
  for (const Fitting& fits : fitting) {
    uses[fits.number].places = compare_places(fits.frames, fits.found, after.first(fits.frames.size()));
    after = after.subspan(fits.frames.size());
  }
}

}  // namespace

std::vector<MapHistory> history_of(const StoredMap& stored) {
  std::vector<MapHistory> history;
  const auto note = stored.notes.find(kHistoryNote);
  std::string_view rest = note == stored.notes.end() ? std::string_view() : note->second;
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    MapHistory entry;
    const std::string_view id = line.substr(0, kIdDigits);
    const auto parsed = std::from_chars(id.data(), id.data() + id.size(), entry.parent, 16);
    if (parsed.ec != std::errc() || parsed.ptr != id.data() + kIdDigits) continue;
    entry.change = line.substr(std::min(line.size(), kIdDigits + 1));
    history.push_back(std::move(entry));
  }
  return history;
}

MapUpdate update_map(const MapVersion& parent, const std::vector<StoredSession>& sessions, const Vocabulary& vocabulary,
                     const StepHook& before_step) {
  MapUpdate update;
  before_step("placing the sessions");
  std::vector<Fitting> fitting =
      place_sessions(parent, sessions, index_of(parent.stored.map, vocabulary), update.sessions);
  if (fitting.empty()) {
    update.refusal = "no session fits the map";
    return update;
  }
  before_step("adjusting the sessions around the map");
  for (Fitting& fits : fitting) {
    fits.online = online_beside(*fits.session, parent.stored.map);
    adjust_at_once(whole_map({&parent.stored.map, fits.online}), {}, {}, fits.online);
  }
  const std::vector<Survival> survival = survival_by(parent, fitting, update.sessions);
  const std::vector<PointId> unlikely = points_to_retire(parent.stored.map, survival);
  Witnesses witnesses;
  for (const Fitting& fits : fitting) {
    witnesses.frames.insert(witnesses.frames.end(), fits.frames.begin(), fits.frames.end());
    witnesses.found.insert(witnesses.found.end(), fits.found.begin(), fits.found.end());
  }
  const Change change = [&](const SparedPlaces& spared, StoredMap& child) {
    for (const Fitting& fits : fitting) {
      add_session(fits, parent.stored.map, spared, child, update.sessions[fits.number]);
    }
    retire(unlikely, spared, child.map, update);
    const std::vector<Survival> of_child = survival_with(survival, child.map);
    update.keyframes_removed += keep_to_budget(
        parent.stored.map, kPlaceBudget, of_child,
        [&](const Keyframe& keyframe) { return is_spared(spared, keyframe); }, child.map);
    return of_child;
  };
  const std::vector<Replayed> after = make_child(parent, witnesses, change, vocabulary, before_step, update);
  if (!update.child) return update;
  compare_by_session(fitting, after, update.sessions);
  note_history(parent, describe(update), *update.child);
  return update;
}

MapUpdate summarise_map(const MapVersion& parent, int keyframes_of_place, const Vocabulary& vocabulary,
                        const StepHook& before_step) {
  const MapGraph& map = parent.stored.map;
  before_step("replaying the keyframes on the map");
  constexpr double kLeastInliers = 0.6;  // points go with keyframes, evenly
  Witnesses witnesses{kLeastInliers, frames_to_replay(map)};
  witnesses.found = replay(witnesses.frames, map, index_of(map, vocabulary));
  const std::vector<Survival> survival = survival_by(parent, {}, {});
  MapUpdate update;
  const Change change = [&](const SparedPlaces& spared, StoredMap& child) {
    update.keyframes_removed = keep_to_budget(
        MapGraph(Origin::offline), keyframes_of_place, survival,
        [&](const Keyframe& keyframe) { return is_spared(spared, keyframe); }, child.map);
    return survival;
  };
  make_child(parent, witnesses, change, vocabulary, before_step, update);
  if (update.child && update.keyframes_removed == 0) {
    update.child.reset();
    update.refusal = fmt::format("no keyframe can be spared with {} for each place", keyframes_of_place);
  }
  if (update.child) {
    const std::string removed =
        fmt::format("summary: {} of {} keyframes and {} of {} points removed", update.keyframes_removed,
                    map.keyframe_count(), map.point_count() - update.child->map.point_count(), map.point_count());
    note_history(parent, removed, *update.child);
  }
  return update;
}

std::string fault_of_replacement(const MapVersion& map, const MapVersion& next, const StoredSession& session,
                                 const Vocabulary& vocabulary) {
  std::vector<std::uint64_t> versions = {map.id};
  for (const MapHistory& entry : history_of(map.stored)) versions.push_back(entry.parent);
  if (std::ranges::count(versions, next.id) > 0) return "";
  std::string fault = fault_of(session, map.stored, versions);
  const std::vector<ReplayFrame> frames = frames_to_replay(session.stored.map);
  std::vector<Replayed> before;
  if (fault.empty()) {
    before = replay(frames, map.stored.map, index_of(map.stored.map, vocabulary));
    fault = place_of(frames, before, map.stored.map).fault;
  }
  if (!fault.empty()) return "it is not proved, as session " + session.name + " " + fault;
  return fault_of_places(
      compare_places(frames, before, replay(frames, next.stored.map, index_of(next.stored.map, vocabulary))));
}

}  // namespace byre
