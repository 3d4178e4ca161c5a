#include "byre/slam/system/stored_map.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/input_error.h"
#include "byre/map.h"
#include "byre/place/map_words.h"

#include <utility>

namespace byre {

namespace fs = std::filesystem;

namespace {

// Empty if the plan does not define walls.
std::optional<PlacedWalls> walls_of(const StoredMap& stored, const fs::path& map, const DrawnFloorPlan& drawn) {
  const FloorPlan& plan = drawn.plan;
  if (!stored.plan) {
    throw InputError(map.string(), "is not registered on a floor plan, but a plan is given",
                     "register it on the plan with byre register or byre view");
  }
  if (stored.plan->plan != plan.name) {
    throw InputError(plan.name, "is not the floor plan of the map, " + stored.plan->plan,
                     "give that plan, or register the map on this one");
  }
  if (!plan.occupied_threshold) return std::nullopt;
  return place_walls(stored.map, *stored.plan, PlanWalls(plan, drawn.occupancy));
}

// Adds words. Throws InputError for a map without metric scale.
StoredMap made_ready(StoredMap stored, const fs::path& path, const Vocabulary& vocabulary) {
  if (stored.scale != MapScale::metric) {
    throw InputError(path.string(), "has no metric scale, which missions need",
                     "set it with byre scale, or --scale when importing a model");
  }
  if (stored.map.keyframe_count() == 0)
    throw InputError(path.string(), "contains no keyframes", "map a recording first");
  add_words(stored, vocabulary);
  return stored;
}

}  // namespace

Vocabulary open_vocabulary(const std::optional<fs::path>& path) {
  return Vocabulary::load(path ? *path : default_vocabulary_path());
}

StoredMap load_for_mapping(const fs::path& path, const Vocabulary& vocabulary) {
  return made_ready(load_map(path), path, vocabulary);
}

std::shared_ptr<const OfflineMap> load_offline_map(const fs::path& path, const Vocabulary& vocabulary,
                                                   const std::optional<DrawnFloorPlan>& plan) {
  StoredMap stored = made_ready(open_map(path), path, vocabulary);
  std::optional<PlacedWalls> walls;
  if (plan) walls = walls_of(stored, path, *plan);
  auto offline = std::make_shared<const OfflineMap>(std::move(stored.map), vocabulary, std::move(stored.recordings),
                                                    std::move(walls), read_odometry_calibration(stored.notes),
                                                    stored_tags(stored.notes));
  if (const InputError* const damage = offline->map().damage()) throw InputError(*damage);
  return offline;
}

std::vector<int> keyframes_of_recordings(const MapGraph& map, std::size_t recordings) {
  std::vector<int> counts(recordings, 0);
  for (const KeyframeId id : map.keyframe_ids())
    ++counts.at(static_cast<std::size_t>(map.keyframe_header(id)->recording));
  return counts;
}

void save_for_missions(StoredMap stored, const Vocabulary& vocabulary, const std::string& site, const fs::path& path) {
  save_for_missions_and_reload(stored, vocabulary, site, path);
}

void save_session_for_updates(StoredMap stored, SessionRecord session, const Vocabulary& vocabulary,
                              const fs::path& path) {
  stored.notes["software"] = "byre " BYRE_VERSION;
  add_words(stored, vocabulary);
  save_map(stored, {{}, std::move(session)}, path);
}

MapVersion load_version(const fs::path& path, const Vocabulary& vocabulary) {
  const std::vector<std::byte> bytes = read_file(path);
  MapUpkeep upkeep = read_upkeep(bytes, path.string());
  if (upkeep.session) {
    throw InputError(path.string(), "is a session, not a map", "give the map first, then the sessions");
  }
  return {map_id(bytes, path.string()), made_ready(read_map(bytes, path.string()), path, vocabulary),
          std::move(upkeep.survival)};
}

StoredSession load_session(const fs::path& path, const Vocabulary& vocabulary) {
  const std::vector<std::byte> bytes = read_file(path);
  MapUpkeep upkeep = read_upkeep(bytes, path.string());
  if (!upkeep.session) {
    throw InputError(path.string(), "is a map, not a session", "save a session with byre run --save-session");
  }
  return {printable(path.stem().string()), made_ready(read_map(bytes, path.string()), path, vocabulary),
          *std::move(upkeep.session)};
}

void save_child(MapUpdate update, const Vocabulary& vocabulary, const fs::path& path) {
  update.child->notes["software"] = "byre " BYRE_VERSION;
  add_words(*update.child, vocabulary);
  save_map(*update.child, {std::move(update.survival), {}}, path);
}

MapUpdateResult update_map_file(const fs::path& map, std::span<const fs::path> sessions, const fs::path& output,
                                const std::optional<fs::path>& vocabulary) {
  std::error_code error;
  if (fs::equivalent(map, output, error)) {
    throw InputError(output.string(), "is the map to be updated, which stays as it is", "choose another output");
  }
  require_writable(output, FileContent::map);
  const Vocabulary words = open_vocabulary(vocabulary);
  const MapVersion parent = load_version(map, words);
  std::vector<StoredSession> stored;
  for (const fs::path& session : sessions) stored.push_back(load_session(session, words));
  MapUpdate update = update_map(parent, stored, words);
  MapUpdateResult result{.refusal = update.refusal, .points_retired = update.points_retired};
  for (const SessionUse& use : update.sessions) {
    result.keyframes_added += use.keyframes_added;
    result.points_added += use.points_added;
    if (!update.child && !use.place.fault.empty()) result.refusal += "; " + use.name + ": " + use.place.fault;
  }
  if (update.child) save_child(std::move(update), words, output);
  return result;
}

void save_for_missions_and_reload(StoredMap& stored, const Vocabulary& vocabulary, const std::string& site,
                                  const fs::path& path) {
  stored.notes["software"] = "byre " BYRE_VERSION;
  if (!site.empty()) stored.notes["site"] = site;
  add_words(stored, vocabulary);
  save_and_reread(stored, path);
}

}  // namespace byre
