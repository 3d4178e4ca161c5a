#pragma once

#include "imperfection.h"

#include "byre/alignment.h"
#include "byre/recording.h"
#include "byre/slam/offline_map.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace byre {

// Real recordings are looked for in $BYRE_DATA, or in ../shared/data beside the project's folder; rendered ones in
// $BYRE_TWIN, or in ~/.cache/byre/twin; those of render_barns.sh in $BYRE_BARNS, or in ~/.cache/byre/barns.
enum class Source : std::uint8_t { real, twin, barn };

struct RecordingName {
  Source source = Source::real;
  std::string name;
  Timestamp truth_offset{0};  // added to the truth's time stamps, for truth with a known clock error
};

// Empty when it is not there, or not rendered to its end yet.
std::optional<std::filesystem::path> find(const RecordingName& name);

// Why a mission without its recording is left out, and how to have it flown.
std::string why_missing(const RecordingName& name);

// world_from_body, its clock corrected. Throws InputError when the recording or its truth is missing or damaged.
Trajectory truth_of(const RecordingName& name);

// What an offline map is made of.
struct MapRecipe {
  RecordingName recording;
  FrameRange range{};
  bool from_true_poses = false;  // frames at their true poses, where they are too far apart for tracking
  Imperfection imperfection{};   // imperfection of the camera that saw the recording
};

std::string name_of(const MapRecipe& recipe);  // different for different recipes of these tests

struct KnownMap {
  std::shared_ptr<const OfflineMap> map;
  Similarity truth_from_map;  // by the map's own keyframes
};

// As "byre map" makes it. Kept in the temporary folder, in byre_mission_maps, since making it takes minutes: delete
// that folder when mapping has changed. Throws InputError when the recording is not there.
KnownMap make_known_map(const MapRecipe& recipe);

// Without this share of its points, chosen by the seed.
KnownMap without_points(const KnownMap& known, double share, std::uint64_t seed);

// Without what was mapped between two times, counted from the first keyframe: those keyframes, and points that mostly
// they see.
KnownMap without_stretch(const KnownMap& known, Timestamp from, Timestamp to);

const Vocabulary& mission_vocabulary();

}  // namespace byre
