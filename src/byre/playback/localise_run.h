#pragma once

#include "byre/features/extract.h"
#include "byre/map/map_file.h"
#include "byre/recording.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/places/offline_map.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Result of localising one frame independently.
struct LocalisedFrame {
  std::string name;                     // image file, or time stamp in seconds
  std::string map{};                    // SearchableMap::name; empty if not localised
  Timestamp time{};                     // time in the image's name, else its index in seconds
  std::optional<Pose> world_from_body;  // empty if not localised
  Localisation localisation;
  double extract_seconds = 0.0;
  double localise_seconds = 0.0;
};

struct LocaliseRun {
  std::vector<LocalisedFrame> frames;  // without unreadable ones
  std::vector<std::string> warnings;
};

struct LocaliseHooks {
  std::function<bool()> should_stop;  // called before each frame
  std::function<void(int done, const LocalisedFrame& frame)> after_frame;
};

struct SearchableMap {
  SearchableMap(const StoredMap& stored, const Vocabulary& vocabulary, std::string name_in_site = "")
      : name(std::move(name_in_site)),
        is_metric(stored.scale == MapScale::metric),
        map(stored.map, vocabulary, stored.recordings, {}, {}, stored_tags(stored.notes)) {}

  std::string name;  // in the site; empty without a site
  bool is_metric;    // whether disparities are comparable with the map
  OfflineMap map;
};

// Localises each frame of a recording in the maps of a site, or in one map. A frame that fits two maps is ambiguous.
// Throws InputError if its calibration cannot be rectified.
LocaliseRun localise_recording(std::span<const SearchableMap> maps, Recording& recording, const LocaliseHooks& hooks);

// Localises images of a camera. Images of another size are scaled, with a warning.
LocaliseRun localise_images(std::span<const SearchableMap> maps, const std::vector<std::filesystem::path>& images,
                            const Calibration& camera, const LocaliseHooks& hooks);

}  // namespace byre
