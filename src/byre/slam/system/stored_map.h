#pragma once

#include "byre/floor_plan.h"
#include "byre/map/map_upkeep.h"
#include "byre/place/vocabulary.h"
#include "byre/slam/places/offline_map.h"
#include "byre/slam/upkeep/update_map.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Vocabulary from a file, or the installed one. Throws InputError if it cannot be loaded.
Vocabulary open_vocabulary(const std::optional<std::filesystem::path>& path);

// Loads a map for tracking; its keyframes get words of the vocabulary. Throws InputError if it cannot be loaded, or has
// no metric scale, which stereo tracking and loop closing need.
StoredMap load_for_mapping(const std::filesystem::path& path, const Vocabulary& vocabulary);

// Loads the offline map of missions, with the same requirements. plan: floor plan on which the map is registered, whose
// walls limit relocalisation; may be empty. Throws InputError also if the map is not registered on that plan.
std::shared_ptr<const OfflineMap> load_offline_map(const std::filesystem::path& path, const Vocabulary& vocabulary,
                                                   const std::optional<DrawnFloorPlan>& plan = {});

// Number of keyframes per recording.
std::vector<int> keyframes_of_recordings(const MapGraph& map, std::size_t recordings);

// Saves the map with the data that missions need: words of the vocabulary, site name unless empty, version of byre.
void save_for_missions(StoredMap stored, const Vocabulary& vocabulary, const std::string& site,
                       const std::filesystem::path& path);
// Also updates `stored` to the map as read back from the file.
void save_for_missions_and_reload(StoredMap& stored, const Vocabulary& vocabulary, const std::string& site,
                                  const std::filesystem::path& path);

// Saves what a mission learned. stored: its online map.
void save_session_for_updates(StoredMap stored, SessionRecord session, const Vocabulary& vocabulary,
                              const std::filesystem::path& path);

// Load a map and a session for update_map, as load_for_mapping() does. Throw InputError also if given one for the
// other.
MapVersion load_version(const std::filesystem::path& path, const Vocabulary& vocabulary);
StoredSession load_session(const std::filesystem::path& path, const Vocabulary& vocabulary);
// Saves the child of an update. Precondition: there is one.
void save_child(MapUpdate update, const Vocabulary& vocabulary, const std::filesystem::path& path);

}  // namespace byre
