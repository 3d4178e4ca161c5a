#include "byre/map/map_file.h"

#include "byre/input/binary_file.h"
#include "byre/input_error.h"
#include "byre/map/map_sections.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <string_view>

namespace byre {
namespace {

// As PNG's: a byte that is no text, and line ends that transfers as text would change.
constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'B', 'Y', 'R', 'E', '\r', '\n', 0x1a};
constexpr std::uint32_t kFormat = 5;              // the newest that is read, and the one that is written
constexpr std::uint32_t kFirstFormat = 1;         // the oldest that is read
constexpr std::uint32_t kFirstRoundedFormat = 5;  // from here on, what keyframes see and points are rounded to quanta

enum Section : std::size_t {
  kSummary,
  kNotes,
  kProvenance,
  kRigs,
  kKeyframes,
  kFeatures,
  kPatches,
  kPoints,
  kObservations,
  kWords,
  kPlan,                 // from format 2 on; later formats have it empty without a plan
  kRefinedCalibrations,  // from format 3 on; later formats have it empty where nothing was refined
  kReadoutTimes,         // from format 4 on
  kDescriptors,          // from format 5 on
  kSectionCount
};
constexpr std::array<std::string_view, kSectionCount> kSectionNames = {
    "summary", "notes",        "provenance", "rigs", "keyframes",    "features", "patches",
    "points",  "observations", "words",      "plan", "calibrations", "shutters", "descriptors"};

constexpr std::size_t kNameBytes = 16;
constexpr std::size_t kFixedHeaderBytes = kSignature.size() + 2 * sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::size_t kTableEntryBytes = kNameBytes + 3 * sizeof(std::uint64_t);

// Each format has a section more than the one before.
constexpr std::size_t section_count(std::uint32_t format) {
  return kPlan + format - kFirstFormat;
}
static_assert(section_count(kFormat) == kSectionCount);

// With its own checksum.
constexpr std::size_t header_bytes(std::size_t sections) {
  return kFixedHeaderBytes + sections * kTableEntryBytes + sizeof(std::uint64_t);
}

using Bytes = std::span<const std::byte>;

// The places where sections end that lie one after the other.
using SectionEnds = std::vector<std::size_t>;

bool is_refined(const StoredMap& stored) {
  return std::ranges::any_of(stored.recordings,
                             [](const SourceRecording& recording) { return recording.refined.has_value(); });
}

void write_section(std::size_t section, const StoredMap& stored, const Keyframes& all, ByteWriter& writer) {
  switch (section) {
    case kSummary:
      return write_summary(summarise(stored.map), writer);
    case kNotes:
      return write_notes(stored.notes, writer);
    case kProvenance:
      return write_provenance(stored, writer);
    case kRigs:
      return write_rigs(stored.map.rigs(), writer);
    case kKeyframes:
      return write_keyframes(all, writer);
    case kPoints:
      return write_rounded_points(stored.map, writer);
    case kWords:
      return write_narrow_words(all, stored.vocabulary_checksum, writer);
    case kPlan:
      if (stored.plan) write_plan(*stored.plan, writer);
      return;
    case kRefinedCalibrations:
      if (is_refined(stored)) write_refined_calibrations(stored.recordings, writer);
      return;
    case kReadoutTimes:
      return write_readout_times(stored.recordings, writer);
    default:
      assert(false);
  }
}

// What keyframes see is written to several sections at once.
ByteWriter* view_section(std::size_t section, ViewWriters& views) {
  switch (section) {
    case kFeatures:
      return &views.features;
    case kPatches:
      return &views.patches;
    case kObservations:
      return &views.observations;
    case kDescriptors:
      return &views.descriptors;
    default:
      return nullptr;
  }
}

// Behind what is in the file already.
SectionEnds write_sections(const StoredMap& stored, std::vector<std::byte>& file) {
  const Keyframes all = keyframes_of(stored.map);
  ViewWriters views;
  write_views(stored.map, all, views);
  const std::size_t begin = file.size();
  SectionEnds ends;
  for (std::size_t section = 0; section < kSectionCount; ++section) {
    ByteWriter writer;
    if (ByteWriter* const view = view_section(section, views)) {
      std::swap(writer, *view);
    } else {
      write_section(section, stored, all, writer);
    }
    file.insert(file.end(), writer.bytes().begin(), writer.bytes().end());
    ends.push_back(file.size() - begin);
  }
  return ends;
}

void write_name(std::string_view name, ByteWriter& writer) {
  std::array<char, kNameBytes> padded{};
  std::ranges::copy(name, padded.begin());
  writer.write_all<char>(padded);
}

void write_header(Bytes content, const SectionEnds& ends, ByteWriter& writer) {
  writer.write_all<std::uint8_t>(kSignature);
  const std::size_t header_size = header_bytes(ends.size());
  writer.write(kFormat);
  writer.write(static_cast<std::uint32_t>(ends.size()));
  writer.write(std::uint64_t{header_size + content.size()});
  std::size_t begin = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const Bytes section = content.subspan(begin, ends[i] - begin);
    write_name(kSectionNames[i], writer);
    writer.write(std::uint64_t{header_size + begin});
    writer.write(std::uint64_t{section.size()});
    writer.write(checksum(section));
    begin = ends[i];
  }
  writer.write(checksum(writer.bytes()));
}

// A section as the header describes it, whose bytes are not looked at yet.
struct SectionPlace {
  std::size_t offset = 0;
  std::size_t size = 0;
  std::uint64_t checksum = 0;
};
using SectionTable = std::vector<SectionPlace>;  // all sections of the file's format

std::uint32_t read_format(ByteReader& header, const std::string& name) {
  const auto format = header.read<std::uint32_t>();
  if (format == 0) header.fail("has the format 0, which never was");
  if (format > kFormat) {
    throw InputError(
        name + ": header",
        "has format " + std::to_string(format) + ", this program knows formats up to " + std::to_string(kFormat),
        "use the version of byre that wrote it, or a newer one");
  }
  return format;
}

SectionPlace read_place(ByteReader& header, std::string_view expected_name, std::size_t expected_offset,
                        std::size_t file_size) {
  std::array<char, kNameBytes> padded{};
  std::ranges::copy(expected_name, padded.begin());
  std::array<char, kNameBytes> found;
  header.read_all<char>(found);
  if (found != padded) header.fail("does not list the section " + std::string(expected_name) + " in its place");
  SectionPlace place;
  place.offset = header.read<std::uint64_t>();
  place.size = header.read<std::uint64_t>();
  place.checksum = header.read<std::uint64_t>();
  if (place.offset != expected_offset || place.size > file_size - place.offset) {
    header.fail("places the section " + std::string(expected_name) + " wrong");
  }
  return place;
}

SectionTable read_table(Bytes bytes, const std::string& name) {
  if (bytes.size() < kSignature.size() ||
      !std::ranges::equal(bytes.first(kSignature.size()), std::as_bytes(std::span(kSignature)))) {
    throw InputError(name, "is no map of byre: it does not begin as one", "name a file that byre has saved a map in");
  }
  ByteReader header(bytes, name + ": header", 0);
  header.take(kSignature.size());
  const std::size_t sections = section_count(read_format(header, name));
  const std::size_t header_size = header_bytes(sections);
  if (header.read<std::uint32_t>() != sections) header.fail("has not the sections of its format");
  if (header.read<std::uint64_t>() != bytes.size()) {
    header.fail("is of a file of another length than its " + std::to_string(bytes.size()) + " bytes");
  }
  SectionTable table;
  std::size_t offset = header_size;
  for (std::size_t i = 0; i < sections; ++i) {
    table.push_back(read_place(header, kSectionNames[i], offset, bytes.size()));
    offset += table[i].size;
  }
  const std::uint64_t expected = checksum(bytes.first(header_size - sizeof(std::uint64_t)));
  if (header.read<std::uint64_t>() != expected) header.fail("has a wrong checksum");
  if (offset != bytes.size()) header.fail("leaves bytes to no section");
  return table;
}

// Opens sections of a file whose table is known.
class SectionOpener {
 public:
  SectionOpener(Bytes bytes, const std::string& name) : bytes_(bytes), name_(name), table_(read_table(bytes, name)) {}

  bool is_rounded() const { return table_.size() >= section_count(kFirstRoundedFormat); }
  bool has(Section section) const { return section < table_.size() && !is_left_empty(section); }

  ByteReader operator()(Section section) const {
    const auto& [offset, size, expected_checksum] = table_[section];
    const Bytes content = bytes_.subspan(offset, size);
    ByteReader reader(content, name_ + ": section " + std::string(kSectionNames[section]), offset);
    if (checksum(content) != expected_checksum) reader.fail("has a wrong checksum");
    return reader;
  }

 private:
  // Sections that not every map has, where others follow them.
  bool is_left_empty(Section section) const {
    return (section == kPlan || section == kRefinedCalibrations) && section + 1 < table_.size() &&
           table_[section].size == 0;
  }

  Bytes bytes_;
  const std::string& name_;
  SectionTable table_;
};

// Points, and what keyframes see of them. Precondition: the keyframes are there without it.
void read_exact_parts(const SectionOpener& open, MapParts& parts) {
  read_features(open(kFeatures), open(kPatches), parts.rigs, parts.keyframes);
  parts.points = read_points(open(kPoints));
  read_observations(open(kObservations), parts.points, parts.keyframes);
}
void read_rounded_parts(const SectionOpener& open, MapParts& parts) {
  RoundedPoints points = read_rounded_points(open(kPoints));
  read_views({open(kFeatures), open(kPatches), open(kObservations), open(kDescriptors)}, points, parts.rigs,
             parts.keyframes);
  parts.points = std::move(points.points);
}

}  // namespace

std::vector<std::byte> write_map(const StoredMap& stored) {
  std::vector<std::byte> file(header_bytes(kSectionCount));
  const SectionEnds ends = write_sections(stored, file);
  ByteWriter header;
  write_header(Bytes(file).subspan(file.size() - ends.back()), ends, header);
  std::ranges::copy(header.bytes(), file.begin());
  return file;
}

StoredMap read_map(std::span<const std::byte> bytes, const std::string& name) {
  const SectionOpener open(bytes, name);
  StoredMap stored;
  stored.notes = read_notes(open(kNotes));
  Provenance provenance = read_provenance(open(kProvenance));
  stored.scale = provenance.scale;
  stored.pose_source = provenance.pose_source;
  stored.recordings = std::move(provenance.recordings);

  MapParts parts;
  parts.rigs = read_rigs(open(kRigs));
  parts.keyframes = read_keyframes(open(kKeyframes), parts.rigs.size(), stored.recordings.size());
  if (open.is_rounded()) {
    read_rounded_parts(open, parts);
    stored.vocabulary_checksum = read_narrow_words(open(kWords), parts.keyframes);
  } else {
    read_exact_parts(open, parts);
    stored.vocabulary_checksum = read_words(open(kWords), parts.keyframes);
  }
  stored.map = Map(Origin::offline, std::move(parts));
  if (open.has(kPlan)) stored.plan = read_plan(open(kPlan));
  if (open.has(kRefinedCalibrations)) read_refined_calibrations(open(kRefinedCalibrations), stored.recordings);
  if (open.has(kReadoutTimes)) read_readout_times(open(kReadoutTimes), stored.recordings);

  ByteReader summary = open(kSummary);
  if (read_summary(summary) != summarise(stored.map)) summary.fail("does not tell what the other sections hold");
  return stored;
}

std::vector<SectionSize> section_sizes(std::span<const std::byte> bytes, const std::string& name) {
  const SectionTable table = read_table(bytes, name);
  std::vector<SectionSize> sizes = {{"header", header_bytes(table.size())}};
  for (std::size_t i = 0; i < table.size(); ++i) sizes.push_back({std::string(kSectionNames[i]), table[i].size});
  return sizes;
}

StoredMap load_map(const std::filesystem::path& path) {
  return read_map(read_file(path), path.string());
}

std::optional<PlanRegistration> load_plan_registration(const std::filesystem::path& path) {
  const MappedFile file(path);
  const std::string name = path.string();
  const SectionOpener open(file.bytes(), name);
  return open.has(kPlan) ? std::optional(read_plan(open(kPlan))) : std::nullopt;
}

void save_map(const StoredMap& stored, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = write_map(stored);
  try {
    read_map(bytes, path.string());
  } catch (const InputError& error) {
    throw InputError(path.string(), "is not written: the map is unsound: " + error.reason(), "");
  }
  replace_file(path, bytes);
}

}  // namespace byre
