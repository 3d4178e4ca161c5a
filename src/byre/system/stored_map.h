#pragma once

#include "byre/floor_plan.h"
#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"
#include "byre/slam/offline_map.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// The vocabulary of a file, or the one that comes with byre. Throws InputError when it cannot be loaded.
Vocabulary open_vocabulary(const std::optional<std::filesystem::path>& path);

// A map that a recording may be tracked in: its keyframes have words of this vocabulary. Throws InputError when it
// cannot be loaded, or has no metric scale, without which stereo and loops cannot be compared with it.
StoredMap load_for_mapping(const std::filesystem::path& path, const Vocabulary& vocabulary);

// The same as the offline map of missions. plan: the floor plan that it lies on, whose walls then bound where the robot
// can be; empty for none. Throws InputError also where the map does not lie on that plan.
std::shared_ptr<const OfflineMap> load_offline_map(const std::filesystem::path& path, const Vocabulary& vocabulary,
                                                   const std::optional<DrawnFloorPlan>& plan = {});

// How many keyframes are of each of so many recordings.
std::vector<int> keyframes_of_recordings(const Map& map, std::size_t recordings);

// Saves the map with what later missions need beside it: words of the vocabulary, the site's name unless it is empty,
// and the version of byre.
void save_for_use(StoredMap stored, const Vocabulary& vocabulary, const std::string& site,
                  const std::filesystem::path& path);
// The same, after which the map is as it was read again from what is written.
void save_for_use_and_reread(StoredMap& stored, const Vocabulary& vocabulary, const std::string& site,
                             const std::filesystem::path& path);

}  // namespace byre
