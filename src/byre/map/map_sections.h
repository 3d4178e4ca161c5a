#pragma once

#include "byre/base/byte_stream.h"
#include "byre/map/map_upkeep.h"

#include <array>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Sections of a map file in their order (docs/reference/map_format.md). Readers consume the whole section. They throw
// InputError for invalid values and for bytes that no writer produces, so that reading and writing reproduces the file.

using Keyframes = std::vector<const Keyframe*>;  // all keyframes of a map, by number
Keyframes keyframes_of(const MapGraph& map);

// Features of a keyframe; empty features for a keyframe without any.
const Features& features_of(const Keyframe& keyframe);

// Counts that detect sections of different maps in one file.
struct MapSummary {
  std::uint64_t keyframes = 0;
  std::uint64_t points = 0;
  std::uint64_t features = 0;
  std::uint64_t observations = 0;
  std::uint64_t patches = 0;
  bool operator==(const MapSummary&) const = default;
};
MapSummary summarise(const MapGraph& map);
void write_summary(const MapSummary& summary, ByteWriter& writer);
MapSummary read_summary(ByteReader reader);

void write_notes(const std::map<std::string, std::string>& notes, ByteWriter& writer);
std::map<std::string, std::string> read_notes(ByteReader reader);

struct Provenance {
  MapScale scale = MapScale::metric;
  PoseSource pose_source = PoseSource::slam;
  std::vector<SourceRecording> recordings;
};
void write_provenance(const StoredMap& stored, ByteWriter& writer);
Provenance read_provenance(ByteReader reader);

void write_rigs(const std::vector<Rig>& rigs, ByteWriter& writer);
std::vector<Rig> read_rigs(ByteReader reader);

// Times, rigs, parents, poses and their covariances.
void write_keyframes(const Keyframes& keyframes, ByteWriter& writer);
std::vector<Keyframe> read_keyframes(ByteReader reader, std::size_t rig_count, std::size_t recording_count);

// Sections with one part per keyframe, in the order of the lookup.
enum ViewSection : std::size_t {
  kFeaturesOfView,
  kPatchesOfView,
  kObservationsOfView,
  kDescriptorsOfView,
  kWordsOfView,
  kViewSections
};
inline constexpr std::uint32_t kPointsOfBlock = 32;

// Sizes of the parts of sections in bytes, filled in while they are read or written.
struct PartSizes {
  std::vector<std::array<std::uint32_t, kViewSections>> views;  // per keyframe
  std::vector<std::uint32_t> points;                            // per block of kPointsOfBlock points
};

// Rounded to quanta. Of the calls that fill in sizes, points come first and words last.
void write_points(const MapGraph& map, ByteWriter& writer, PartSizes& sizes);
struct RoundedPoints {
  std::vector<MapPoint> points;           // without references
  std::vector<std::uint32_t> references;  // per point: which of its observations is the reference, from 0
};
RoundedPoints read_points(ByteReader reader, PartSizes& sizes);
// Reads the next point without its reference. Returns which of its observations is the reference.
std::uint32_t read_point(ByteReader& reader, std::uint32_t number, MapPoint& point);

// Keyframes' features and sightings; all sections have one part per keyframe.
struct ViewWriters {
  ByteWriter features, patches, observations, descriptors;
};
struct ViewSections {
  ByteReader features, patches, observations, descriptors;
};
void write_views(const MapGraph& map, const Keyframes& keyframes, ViewWriters& sections, PartSizes& sizes);
// Sets the features and sightings of the keyframes, and the references of the points.
void read_views(const ViewSections& sections, RoundedPoints& points, const std::vector<Rig>& rigs,
                std::vector<Keyframe>& keyframes, PartSizes& sizes);
// Sets features and sightings of one keyframe, from its parts. find_point is called with numbers below point_count and
// returns the point with its observations, which must contain the keyframe.
void read_view(ViewSections parts, std::uint32_t number, const Rig& rig, std::size_t point_count,
               const std::function<const ObservedPoint&(std::uint32_t)>& find_point, Keyframe& keyframe);

void write_words(const Keyframes& keyframes, std::uint64_t vocabulary_checksum, ByteWriter& writer, PartSizes& sizes);
struct WordsHead {
  std::uint64_t vocabulary_checksum = 0;
  std::size_t bytes_each = 1;
};
WordsHead read_words_head(ByteReader& reader);
// Reads the words of one keyframe at the reader's position.
std::vector<Word> read_words_of(ByteReader& reader, const WordsHead& head, std::size_t features);
// Sets the words of the keyframes and returns the checksum of their vocabulary.
std::uint64_t read_words(ByteReader reader, std::vector<Keyframe>& keyframes, PartSizes& sizes);

// Locations of parts in other sections, observations of points, and covisibility of keyframes, for separate access to
// keyframes and points.
struct PartSections {
  std::array<std::span<const std::byte>, kViewSections> views;
  std::span<const std::byte> points;
};
void write_lookup(const MapGraph& map, const PartSizes& sizes, const PartSections& sections, ByteWriter& observers,
                  ByteWriter& lookup);
// Fails if the sections do not match the contents of the others.
void require_lookup(const MapGraph& map, const PartSizes& sizes, const PartSections& sections, ByteReader observers,
                    ByteReader lookup);

// Location of a part in its section, bytes.
struct ByteRange {
  std::size_t begin = 0;
  std::size_t size = 0;
};
struct KeyframeParts {
  std::uint32_t features = 0;  // number of features
  std::array<ByteRange, kViewSections> views;
  ByteRange covisible;         // in Lookup::covisible
  std::uint64_t checksum = 0;  // XXH3 of its parts in the order of sections, without covisibility
};
struct PointBlock {
  ByteRange points, observers;
  std::uint64_t checksum = 0;  // XXH3 of both
};
struct Lookup {
  std::vector<KeyframeParts> keyframes;
  std::vector<PointBlock> blocks;
  std::vector<std::byte> covisible;
  std::size_t first_byte_of_covisible = 0;  // offset in its section
};
// Sizes of the sections that a lookup divides into parts, bytes; the parts must cover them exactly.
struct PartSectionSizes {
  std::array<std::size_t, kViewSections> views{};
  std::size_t points = 0, observers = 0;
};
Lookup read_lookup(ByteReader reader, const MapSummary& summary, const PartSectionSizes& sizes);
ScratchVector<Covisible> read_covisible(ByteReader reader, std::uint32_t keyframe, std::size_t keyframe_count);
// Reads the observations of the next point, with features within those of their keyframes.
std::vector<Observation> read_observers(ByteReader& reader, const std::vector<KeyframeParts>& keyframes);

// Whether more pairs of keyframes share points than a section of this size can plausibly describe.
bool has_too_many_covisible_keyframes(const std::vector<Keyframe>& keyframes, std::size_t point_count,
                                      std::size_t section_bytes);

void write_refined_calibrations(const std::vector<SourceRecording>& recordings, ByteWriter& writer);
// Sets those of the recordings.
void read_refined_calibrations(ByteReader reader, std::vector<SourceRecording>& recordings);

// Readout times of rolling shutters, as given and as refined.
void write_readout_times(const std::vector<SourceRecording>& recordings, ByteWriter& writer);
// Sets those of the recordings and of their refined calibrations.
void read_readout_times(ByteReader reader, std::vector<SourceRecording>& recordings);

void write_plan(const PlanRegistration& registration, ByteWriter& writer);
PlanRegistration read_plan(ByteReader reader);

// Precondition: a keyframe has a picture.
void write_pictures(const Keyframes& keyframes, ByteWriter& writer);
// Sets those of the keyframes.
void read_pictures(ByteReader reader, std::vector<Keyframe>& keyframes);
// Same, but each picture is read and checked on access. table: the first bytes of the section.
struct PictureSection {
  ReadAt read_at;
  std::string place;       // for messages
  std::size_t offset = 0;  // in the file
  std::size_t size = 0;    // bytes
};
std::size_t bytes_of_picture_table(std::size_t keyframes);
void open_pictures(ByteReader table, const PictureSection& section, std::vector<Keyframe>& keyframes);

void write_upkeep(const MapUpkeep& upkeep, ByteWriter& writer);
// points: number of points of the map.
MapUpkeep read_upkeep(ByteReader reader, std::size_t points);

}  // namespace byre
