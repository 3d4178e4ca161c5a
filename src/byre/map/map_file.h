#pragma once

#include "byre/base/byte_stream.h"
#include "byre/geometry/calibration_change.h"
#include "byre/map/map_graph.h"
#include "byre/plan_registration.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

struct SourceRecording {
  std::string name;         // given by the user
  Calibration calibration;  // as given, before rectification
  Timestamp first_time{};   // time of the first frame, keyframe or not
  Timestamp last_time{};    // time of the last frame, keyframe or not
  // Refined calibration by which its images are rectified, if any.
  std::optional<RefinedCalibration> refined = {};

  const Calibration& present_calibration() const { return refined ? refined->calibration : calibration; }
};

// The newest refined calibration of recordings with this given calibration, if any. `given` may be the left camera
// alone.
std::optional<RefinedCalibration> stored_calibration(const std::vector<SourceRecording>& recordings,
                                                     const Calibration& given);

// Whether a recording has these cameras on this body, as given. `given` may be the left camera alone.
bool has_same_cameras(const std::vector<SourceRecording>& recordings, const Calibration& given);

// Body frame of the newest recording by these cameras, from the body frame of `given`: a monocular map may have the
// camera as its body, a mission the robot. Empty if no recording is by these cameras.
std::optional<Pose> stored_body_from_body(const std::vector<SourceRecording>& recordings, const Calibration& given);

// Unit of the positions in a map.
enum class MapScale : std::uint8_t {
  metric,   // metres, by a stereo baseline or a given scale
  unknown,  // arbitrary unit of a monocular map
};

// Source of the keyframe poses of a map.
enum class PoseSource : std::uint8_t {
  slam,     // byre's own tracking and mapping
  given,    // an external trajectory, such as ground truth
  imported  // a structure-from-motion model
};

// A map and the data stored with it. Its ids have origin offline and no gaps.
struct StoredMap {
  MapGraph map{Origin::offline};
  std::vector<SourceRecording> recordings;  // indexed by Keyframe::recording
  MapScale scale = MapScale::metric;
  PoseSource pose_source = PoseSource::slam;
  std::uint64_t vocabulary_checksum = 0;     // checksum of the vocabulary of the words; 0 without words
  std::map<std::string, std::string> notes;  // free text by key, such as site and software
  std::optional<PlanRegistration> plan;      // registration on a floor plan, if any
};

// Copy of a session's map for storage: ids become offline without gaps. Omits removed keyframes, sightings of another
// map's points, features without a point, and patches that are no point's reference. Encodes the rest of the pictures.
// Precondition: a map without
// faults, with features for images of its rigs' size.
MapGraph offline_copy(const MapGraph& online);
// Consumes the map keyframe by keyframe, so that the two are never in memory together. Leaves it empty.
MapGraph offline_copy(MapGraph&& online);

// Copy with scaled camera poses, points and baselines: image positions and disparities of the points are unchanged. The
// measured camera poses on the body are not scaled. Preconditions: ids without gaps, and a positive factor.
MapGraph scaled_copy(const MapGraph& map, double factor);

// Faults of find_faults(MapGraph) and of the other stored data.
std::vector<std::string> find_faults(const StoredMap& stored);

// Size of a section of a map file, or of its header, as listed by `byre inspect`.
struct SectionSize {
  std::string name;
  std::size_t bytes = 0;
};

// Format: docs/reference/map_format.md. Equal maps give equal bytes, also after reading. Values are rounded far below
// their noise. Throws InputError for a map with a damaged source. Preconditions: ids without gaps, and keyframes with
// existing rigs.
std::vector<std::byte> write_map(const StoredMap& stored);

// Throws InputError naming section and byte for damage, a violated invariant or another format. name: in messages.
StoredMap read_map(std::span<const std::byte> bytes, const std::string& name);
std::vector<SectionSize> section_sizes(std::span<const std::byte> bytes, const std::string& name);

// Versions for files. Saving reads the bytes back before it replaces the file as a whole (write_atomically). A map that
// cannot be read back throws InputError and leaves the old file.
StoredMap load_map(const std::filesystem::path& path);
// Like read_map and load_map, but keyframes' features and sightings, and points, are read and checked on first access
// (see MapGraph), from a file that stays open. Checks all checksums at once only for files up to 32 MB, some thousand
// keyframes. read_at fills in bytes of the file from an offset, for several threads at once; its file is not checked
// beforehand.
StoredMap open_map(const ReadAt& read_at, std::size_t size, const std::string& name);
StoredMap open_map(const std::filesystem::path& path);

// Registration of a stored map on a floor plan, without reading the rest of the file.
std::optional<PlanRegistration> load_plan_registration(const std::filesystem::path& path);

void save_map(const StoredMap& stored, const std::filesystem::path& path);
// Saves the map and replaces it by the one read back. The two are never in memory together.
void save_and_reread(StoredMap& stored, const std::filesystem::path& path);

}  // namespace byre
