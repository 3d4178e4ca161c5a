#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/input/byte_stream.h"
#include "byre/map/map.h"
#include "byre/map/plan_registration.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// A recording that keyframes of a map come from.
struct SourceRecording {
  std::string name;         // name that the user gave it
  Calibration calibration;  // cameras that took its images, as given, before rectification
  Timestamp first_time{};   // time of the first frame, keyframe or not
  Timestamp last_time{};    // time of the last frame, keyframe or not
  // Refined calibration that its images are rectified by, where there is one.
  std::optional<RefinedCalibration> refined = {};

  const Calibration& present_calibration() const { return refined ? refined->calibration : calibration; }
};

// What recordings of a map have told of a calibration, the newest of those that were given the same for these cameras;
// empty when there is none. The left camera may be the only one.
std::optional<RefinedCalibration> known_calibration(const std::vector<SourceRecording>& recordings,
                                                    const Calibration& given);

// Whether one of the recordings was taken by these cameras on this body, as given; the left one may be the only one.
bool is_by_cameras_of(const std::vector<SourceRecording>& recordings, const Calibration& given);

// The body of the newest recording by these cameras, from theirs: what one camera maps is of the camera, a mission of
// the body that carries it. Empty where none is by these cameras.
std::optional<Pose> known_body_from_body(const std::vector<SourceRecording>& recordings, const Calibration& given);

// What the positions of a map are measured in.
enum class MapScale : std::uint8_t {
  metric,   // metres, from a stereo baseline or a given scale
  unknown,  // the model's own unit: one camera alone does not tell
};

// Where the poses of a map's keyframes come from.
enum class PoseSource : std::uint8_t {
  slam,     // byre's own tracking and mapping
  given,    // a trajectory from elsewhere, such as a ground truth
  imported  // a structure-from-motion model
};

// A map and all that is kept with it between missions. Its ids are of the origin offline and without gaps.
struct StoredMap {
  Map map{Origin::offline};
  std::vector<SourceRecording> recordings;  // Keyframe::recording is an index
  MapScale scale = MapScale::metric;
  PoseSource pose_source = PoseSource::slam;
  std::uint64_t vocabulary_checksum = 0;     // checksum of the vocabulary that the words are of; 0 without words
  std::map<std::string, std::string> notes;  // free text by key, such as site and software
  std::optional<PlanRegistration> plan;      // place on a floor plan, once somebody has found it
};

// A copy of a session's map for keeping: ids become offline and lose their gaps, removed keyframes and sightings of
// another map's points are forgotten, and so are features that see no point, and patches that define none.
// Precondition: a map without faults, whose features were made for an image of their rig's size.
Map offline_copy(const Map& online);
// The same of a map that is used up, keyframe by keyframe: the two are never there at once. Leaves it empty.
Map offline_copy(Map&& online);

// A copy with all lengths that images tell so many times as long: ways of cameras, points and baselines, so that
// each image has every point where it was, disparity included. Arms to a body stay, as they were measured.
// Precondition: ids without gaps, and a factor that is positive.
Map scaled_copy(const Map& map, double factor);

// All faults of find_faults(Map), and what a stored map must hold beyond them.
std::vector<std::string> find_faults(const StoredMap& stored);

// The bytes of a section of a map file, or of its header, as `byre inspect` lists them.
struct SectionSize {
  std::string name;
  std::size_t bytes = 0;
};

// The layout is described in docs/map_format.md. Equal maps give equal bytes. Values are rounded, far below their
// noise; a map that was read from its bytes is written as the same bytes. Throws InputError for a map with a damaged
// source. Preconditions: ids without gaps, and keyframes whose rigs exist.
std::vector<std::byte> write_map(const StoredMap& stored);

// All or nothing: throws InputError naming section and byte for any damage, any broken invariant, and a format that is
// newer than this program's. name: of the file, for messages.
StoredMap read_map(std::span<const std::byte> bytes, const std::string& name);
std::vector<SectionSize> section_sizes(std::span<const std::byte> bytes, const std::string& name);

// The same on files. Saving reads the bytes back and then replaces the file as a whole (write_whole). A map that cannot
// be loaded again is an InputError, and the old file stays.
StoredMap load_map(const std::filesystem::path& path);
// As read_map and load_map, but for what keyframes see and points: these are read, and checked, when they are first
// looked at (see Map), from a file that stays open. Nothing is checked of what is never looked at, but that all
// checksums of a file of up to 32 MB, some thousand keyframes, are right. A file of a format before 6 is read as a
// whole. read_at fills in the bytes of a file from a place on, for several threads at once; nothing is checked of these
// beforehand.
StoredMap open_map(const ReadAt& read_at, std::size_t size, const std::string& name);
StoredMap open_map(const std::filesystem::path& path);

// Where the map of a file lies on a floor plan, without reading the rest of it.
std::optional<PlanRegistration> load_plan_registration(const std::filesystem::path& path);

void save_map(const StoredMap& stored, const std::filesystem::path& path);
// The same, after which the map is as it was read again from what is written: the two are never there at once.
void save_and_reread(StoredMap& stored, const std::filesystem::path& path);

}  // namespace byre
