#pragma once

#include "byre/features/extract.h"
#include "byre/map/map_file.h"
#include "byre/place/place_index.h"
#include "byre/recording.h"
#include "byre/slam/localisation.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// One frame looked for in a map, without a thought of the others.
struct LocalisedFrame {
  std::string name;                     // its image file, or its time stamp in seconds
  Timestamp time{};                     // time in an image's name, else as many seconds as its place in the list
  std::optional<Pose> world_from_body;  // empty when it was not found
  Localisation localisation;
  double extract_seconds = 0.0;
  double localise_seconds = 0.0;
};

struct LocaliseRun {
  std::vector<LocalisedFrame> frames;  // unreadable ones are left out
  std::vector<std::string> warnings;
};

struct LocaliseHooks {
  std::function<bool()> should_stop;  // asked before each frame
  std::function<void(int done, const LocalisedFrame& frame)> after_frame;
};

// A map ready for queries. Borrows the map.
struct SearchableMap {
  SearchableMap(const StoredMap& stored, const Vocabulary& vocabulary)
      : is_metric(stored.scale == MapScale::metric),
        map(stored.map),
        recordings(stored.recordings),
        index(index_of(stored.map, vocabulary)) {}

  bool is_metric;  // whether disparities, which are metric, can be compared with the map
  const Map& map;
  const std::vector<SourceRecording>& recordings;
  Map nothing_online{Origin::online};
  PlaceIndex index;

  MapView view() const { return {&map, nothing_online}; }
};

// Every frame of a recording. Throws InputError when its calibration cannot be rectified.
LocaliseRun localise_recording(const SearchableMap& map, Recording& recording, const LocaliseHooks& hooks);

// Images taken by the camera: of another size, they are scaled to its own, with a warning.
LocaliseRun localise_images(const SearchableMap& map, const std::vector<std::filesystem::path>& images,
                            const Calibration& camera, const LocaliseHooks& hooks);

}  // namespace byre
