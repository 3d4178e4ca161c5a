#pragma once

#include "byre/input/byte_stream.h"
#include "byre/map/map_file.h"

#include <array>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace byre {

// The sections of a map file, in their order; docs/map_format.md describes each. Readers take the whole section and
// throw InputError for every value that a sound map cannot hold. What equals nothing that a writer writes is refused
// too, so that a file that can be read is written again byte by byte.

using Keyframes = std::vector<const Keyframe*>;  // all of a map, by number
Keyframes keyframes_of(const Map& map);

// The features of a keyframe that may have none.
const Features& features_of(const Keyframe& keyframe);

// Numbers of things, kept to tell a file whose sections do not belong together.
struct MapSummary {
  std::uint64_t keyframes = 0;
  std::uint64_t points = 0;
  std::uint64_t features = 0;
  std::uint64_t observations = 0;
  std::uint64_t patches = 0;
  bool operator==(const MapSummary&) const = default;
};
MapSummary summarise(const Map& map);
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

// As formats 1 to 4 have them: keypoints and descriptors, and patches of some of them in a section of their own.
// Fills in the features of the keyframes.
void read_features(ByteReader features, ByteReader patches, const std::vector<Rig>& rigs,
                   std::vector<Keyframe>& keyframes);
std::vector<MapPoint> read_points(ByteReader reader);
// Fills in the sightings of the keyframes. Every point's reference must be one of them.
void read_observations(ByteReader reader, const std::vector<MapPoint>& points, std::vector<Keyframe>& keyframes);
// Fills in the words of the keyframes and gives the checksum of their vocabulary.
std::uint64_t read_words(ByteReader reader, std::vector<Keyframe>& keyframes);

// Sections that have a part for each keyframe, in the order in which they are told of.
enum ViewSection : std::size_t {
  kFeaturesOfView,
  kPatchesOfView,
  kObservationsOfView,
  kDescriptorsOfView,
  kWordsOfView,
  kViewSections
};
inline constexpr std::uint32_t kPointsOfBlock = 32;

// How long parts of sections are, bytes: what a reader learns by going through them.
struct PartSizes {
  std::vector<std::array<std::uint32_t, kViewSections>> views;  // by keyframe
  std::vector<std::uint32_t> points;                            // by block of kPointsOfBlock points
};

// As formats from 5 on have them, rounded to quanta. Points come first of what fills in the sizes, words last.
void write_rounded_points(const Map& map, ByteWriter& writer, PartSizes& sizes);
struct RoundedPoints {
  std::vector<MapPoint> points;           // without references
  std::vector<std::uint32_t> references;  // which of its observations is the point's reference, counted from 0
};
RoundedPoints read_rounded_points(ByteReader reader, PartSizes& sizes);
// The next point alone, but for its reference, which is given: which of its observations it is.
std::uint32_t read_rounded_point(ByteReader& reader, std::uint32_t number, MapPoint& point);

// What keyframes see of them; all sections have a part for each keyframe.
struct ViewWriters {
  ByteWriter features, patches, observations, descriptors;
};
struct ViewSections {
  ByteReader features, patches, observations, descriptors;
  bool has_packed_patches = true;  // from format 7 on
};
void write_views(const Map& map, const Keyframes& keyframes, ViewWriters& sections, PartSizes& sizes);
// Fills in the features and sightings of the keyframes, and the references of the points.
void read_views(const ViewSections& sections, RoundedPoints& points, const std::vector<Rig>& rigs,
                std::vector<Keyframe>& keyframes, PartSizes& sizes);
// Fills in the same of one keyframe, whose parts these are to the end. find_point: calls with a number below
// point_count are answered by the point and its observations; the keyframe must be one of these.
void read_view(ViewSections parts, std::uint32_t number, const Rig& rig, std::size_t point_count,
               const std::function<const ObservedPoint&(std::uint32_t)>& find_point, Keyframe& keyframe);

void write_narrow_words(const Keyframes& keyframes, std::uint64_t vocabulary_checksum, ByteWriter& writer,
                        PartSizes& sizes);
struct WordsHead {
  std::uint64_t vocabulary_checksum = 0;
  std::size_t bytes_each = 1;
};
WordsHead read_words_head(ByteReader& reader);
// The words of one keyframe, whose part follows.
std::vector<Word> read_narrow_words_of(ByteReader& reader, const WordsHead& head, std::size_t features);
// Fills in the words of the keyframes and gives the checksum of their vocabulary.
std::uint64_t read_narrow_words(ByteReader reader, std::vector<Keyframe>& keyframes, PartSizes& sizes);

// From format 6 on: where parts of other sections lie, and who sees each point and shares points with each keyframe, so
// that one keyframe or point can be read without the others.
struct PartSections {
  std::array<std::span<const std::byte>, kViewSections> views;
  std::span<const std::byte> points;
};
void write_lookup(const Map& map, const PartSizes& sizes, const PartSections& sections, ByteWriter& observers,
                  ByteWriter& lookup);
// Fails for sections that do not tell what the others hold.
void require_lookup(const Map& map, const PartSizes& sizes, const PartSections& sections, ByteReader observers,
                    ByteReader lookup);

// Where a part lies in its section.
struct PartPlace {
  std::size_t begin = 0;
  std::size_t size = 0;
};
struct KeyframeParts {
  std::uint32_t features = 0;  // their number
  std::array<PartPlace, kViewSections> views;
  PartPlace covisible;         // in Lookup::covisible
  std::uint64_t checksum = 0;  // XXH3 of its parts in the order of sections, but not of what is covisible
};
struct PointBlock {
  PartPlace points, observers;
  std::uint64_t checksum = 0;  // XXH3 of both
};
struct Lookup {
  std::vector<KeyframeParts> keyframes;
  std::vector<PointBlock> blocks;
  std::vector<std::byte> covisible;
  std::size_t first_byte_of_covisible = 0;  // in its section
};
// sizes: bytes of the sections whose parts it tells of, all of which must be used up.
struct PartSectionSizes {
  std::array<std::size_t, kViewSections> views{};
  std::size_t points = 0, observers = 0;
};
Lookup read_lookup(ByteReader reader, const MapSummary& summary, const PartSectionSizes& sizes);
ReusedVector<Covisible> read_covisible(ByteReader reader, std::uint32_t keyframe, std::size_t keyframe_count);
// The observations of one point, the next one. Their features are such as the keyframes have.
std::vector<Observation> read_observers(ByteReader& reader, const std::vector<KeyframeParts>& keyframes);

// Whether more pairs of keyframes share points than a section of so many bytes may describe.
bool has_too_many_covisible_keyframes(const std::vector<Keyframe>& keyframes, std::size_t point_count,
                                      std::size_t section_bytes);

void write_refined_calibrations(const std::vector<SourceRecording>& recordings, ByteWriter& writer);
// Fills in those of the recordings.
void read_refined_calibrations(ByteReader reader, std::vector<SourceRecording>& recordings);

// Readout times of rolling shutters, as given and as refined.
void write_readout_times(const std::vector<SourceRecording>& recordings, ByteWriter& writer);
// Fills in those of the recordings and of their refined calibrations.
void read_readout_times(ByteReader reader, std::vector<SourceRecording>& recordings);

void write_plan(const PlanRegistration& registration, ByteWriter& writer);
PlanRegistration read_plan(ByteReader reader);

}  // namespace byre
