#pragma once

#include "imperfection.h"

#include "byre/alignment.h"
#include "byre/recording.h"
#include "byre/slam/places/offline_map.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace byre {

// Folders of recordings: real ones in $BYRE_DATA, or ../shared/data next to the project's folder; rendered ones in
// $BYRE_TWIN, or ~/.cache/byre/twin; those of render_barns.sh in $BYRE_BARNS, or ~/.cache/byre/barns.
enum class Source : std::uint8_t { real, twin, barn };

struct RecordingName {
  Source source = Source::real;
  std::string name;
  Timestamp truth_offset{0};  // added to the truth's time stamps, to correct a clock error
};

// Empty when the recording is missing or incompletely rendered.
std::optional<std::filesystem::path> find(const RecordingName& name);

// Reason for a skipped mission, with the remedy.
std::string why_missing(const RecordingName& name);

// world_from_body with corrected clock. Throws InputError when the recording or its truth is missing or damaged.
Trajectory truth_of(const RecordingName& name);

// Input of an offline map.
struct MapRecipe {
  RecordingName recording;
  FrameRange range{};
  bool from_true_poses = false;  // maps frames at their true poses, if they are too far apart for tracking
  Imperfection imperfection{};   // imperfection of the mapping camera
};

std::string name_of(const MapRecipe& recipe);  // unique among the recipes of these tests

struct AlignedMap {
  std::shared_ptr<const OfflineMap> map;
  Similarity truth_from_map;  // from the map's own keyframes
};

// Maps as "byre map" does. Takes minutes, so maps are cached in byre_mission_maps in the temporary folder: delete it
// after changes to mapping. Throws InputError when the recording is missing.
AlignedMap make_aligned_map(const MapRecipe& recipe);

// The map with this share of its points removed, chosen by the seed.
AlignedMap without_points(const AlignedMap& aligned, double share, std::uint64_t seed);

// The map without the keyframes between two times, counted from the first keyframe, and without points observed mostly
// by them.
AlignedMap without_stretch(const AlignedMap& aligned, Timestamp from, Timestamp to);

const Vocabulary& mission_vocabulary();

}  // namespace byre
