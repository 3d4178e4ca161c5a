#include "byre/map/map_file.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/input_error.h"
#include "byre/map/map_file_source.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_upkeep.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <functional>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

// Like PNG's: a non-text byte, and line ends that text-mode transfers would change.
constexpr std::array<std::uint8_t, 8> kSignature = {0x89, 'B', 'Y', 'R', 'E', '\r', '\n', 0x1a};
constexpr std::uint32_t kFormat = 7;
constexpr std::uint32_t kFormatWithPictures = 8;  // format 7 with a section more

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
  kPlan,                 // empty without a plan
  kRefinedCalibrations,  // empty without refined calibrations
  kReadoutTimes,
  kDescriptors,
  kObservers,
  kLookup,
  kPictures,  // in kFormatWithPictures
  kUpkeep,    // optional
  kSectionCount
};
constexpr std::size_t kMandatorySections = kPictures;

constexpr std::array<std::string_view, kSectionCount> kSectionNames = {
    "summary", "notes", "provenance",   "rigs",     "keyframes",   "features",  "patches", "points",   "observations",
    "words",   "plan",  "calibrations", "shutters", "descriptors", "observers", "lookup",  "pictures", "upkeep"};

constexpr std::size_t kNameBytes = 16;
constexpr std::size_t kFixedHeaderBytes = kSignature.size() + 2 * sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::size_t kTableEntryBytes = kNameBytes + 3 * sizeof(std::uint64_t);
constexpr std::size_t kMaxHeaderBytes = kFixedHeaderBytes + kSectionCount * kTableEntryBytes + sizeof(std::uint64_t);

// Bytes of the header of a file with this number of sections, with its own checksum.
constexpr std::size_t header_bytes(std::size_t sections) {
  return kFixedHeaderBytes + sections * kTableEntryBytes + sizeof(std::uint64_t);
}

using Bytes = std::span<const std::byte>;

// A section and its end offset after those before it.
struct WrittenSection {
  std::size_t section = 0;
  std::size_t end = 0;
};
using WrittenSections = std::vector<WrittenSection>;

bool has_pictures(const MapGraph& map) {
  return std::ranges::any_of(map.keyframe_ids(),
                             [&map](KeyframeId id) { return bool{map.keyframe_header(id)->picture}; });
}

bool is_refined(const StoredMap& stored) {
  return std::ranges::any_of(stored.recordings,
                             [](const SourceRecording& recording) { return recording.refined.has_value(); });
}

void write_section(std::size_t section, const StoredMap& stored, const Keyframes& all, ByteWriter& writer,
                   PartSizes& sizes) {
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
      return write_points(stored.map, writer, sizes);
    case kWords:
      return write_words(all, stored.vocabulary_checksum, writer, sizes);
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

// Keyframes' features and sightings are written to several sections at once.
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

constexpr std::array<Section, kViewSections> kSectionsOfViews = {kFeatures, kPatches, kObservations, kDescriptors,
                                                                 kWords};

// section(number) returns the bytes of a section.
template <typename SectionBytes>
PartSections part_sections(SectionBytes section) {
  PartSections sections;
  for (std::size_t i = 0; i < kViewSections; ++i) sections.views[i] = section(kSectionsOfViews[i]);
  sections.points = section(kPoints);
  return sections;
}

// Appends to the file. upkeep: nullptr for a file without that section.
WrittenSections write_sections(const StoredMap& stored, const MapUpkeep* upkeep, std::vector<std::byte>& file) {
  const Keyframes all = keyframes_of(stored.map);
  ViewWriters views;
  PartSizes sizes;
  write_views(stored.map, all, views, sizes);
  const std::size_t begin = file.size();
  WrittenSections sections;
  const auto append = [&](std::size_t section, const ByteWriter& writer) {
    file.insert(file.end(), writer.bytes().begin(), writer.bytes().end());
    sections.push_back({section, file.size() - begin});
  };
  for (std::size_t section = 0; section < kObservers; ++section) {
    ByteWriter writer;
    if (ByteWriter* const view = view_section(section, views)) {
      std::swap(writer, *view);
    } else {
      write_section(section, stored, all, writer, sizes);
    }
    append(section, writer);
  }
  ByteWriter observers, lookup;
  const auto written = [&](Section section) {
    const std::size_t previous = sections[section - 1].end;
    return Bytes(file).subspan(begin + previous, sections[section].end - previous);
  };
  write_lookup(stored.map, sizes, part_sections(written), observers, lookup);
  append(kObservers, observers);
  append(kLookup, lookup);
  if (has_pictures(stored.map)) {
    ByteWriter writer;
    write_pictures(all, writer);
    append(kPictures, writer);
  }
  if (upkeep != nullptr) {
    ByteWriter writer;
    write_upkeep(*upkeep, writer);
    append(kUpkeep, writer);
  }
  return sections;
}

void write_name(std::string_view name, ByteWriter& writer) {
  std::array<char, kNameBytes> padded{};
  std::ranges::copy(name, padded.begin());
  writer.write_all<char>(padded);
}

void write_header(Bytes content, const WrittenSections& sections, ByteWriter& writer) {
  writer.write_all<std::uint8_t>(kSignature);
  writer.write(sections.size() > kPictures && sections[kPictures].section == kPictures ? kFormatWithPictures : kFormat);
  const std::size_t header_size = header_bytes(sections.size());
  writer.write(static_cast<std::uint32_t>(sections.size()));
  writer.write(std::uint64_t{header_size + content.size()});
  std::size_t begin = 0;
  for (const WrittenSection& section : sections) {
    const Bytes bytes = content.subspan(begin, section.end - begin);
    write_name(kSectionNames[section.section], writer);
    writer.write(std::uint64_t{header_size + begin});
    writer.write(std::uint64_t{bytes.size()});
    writer.write(checksum(bytes));
    begin = section.end;
  }
  writer.write(checksum(writer.bytes()));
}

// A section as described by the header; its bytes are not yet read.
struct SectionPlace {
  std::size_t offset = 0;
  std::size_t size = 0;
  std::uint64_t checksum = 0;
};
struct SectionTable {
  std::array<std::optional<SectionPlace>, kSectionCount> places;  // empty for a missing optional section
  std::size_t header_bytes = 0;
  std::uint64_t checksum = 0;  // checksum of the header
};

void require_format(std::uint32_t format, const std::string& name) {
  if (format == kFormat || format == kFormatWithPictures) return;
  throw InputError(
      name + ": header",
      fmt::format("has format {}; this program reads formats {} and {}", format, kFormat, kFormatWithPictures),
      format < kFormat ? "map the recordings again with byre map"
                       : "use the version of byre that wrote the map, or a newer one");
}

SectionPlace read_place(ByteReader& header, std::string_view expected_name, std::size_t expected_offset,
                        std::size_t file_size) {
  std::array<char, kNameBytes> padded{};
  std::ranges::copy(expected_name, padded.begin());
  std::array<char, kNameBytes> found;
  header.read_all<char>(found);
  if (found != padded)
    header.fail("does not list the section " + std::string(expected_name) + " at the expected position");
  SectionPlace place;
  place.offset = header.read<std::uint64_t>();
  place.size = header.read<std::uint64_t>();
  place.checksum = header.read<std::uint64_t>();
  if (place.offset != expected_offset || place.size > file_size - place.offset) {
    header.fail("has a wrong offset of the section " + std::string(expected_name));
  }
  return place;
}

// bytes: the beginning of the file, with the complete header if the file has one.
SectionTable read_table(Bytes bytes, std::size_t file_size, const std::string& name) {
  if (bytes.size() < kSignature.size() ||
      !std::ranges::equal(bytes.first(kSignature.size()), std::as_bytes(std::span(kSignature)))) {
    throw InputError(name, "is not a map of byre: the signature is missing", "give a map file saved by byre");
  }
  ByteReader header(bytes, name + ": header", 0);
  header.take(kSignature.size());
  const auto format = header.read<std::uint32_t>();
  require_format(format, name);
  const auto sections = header.read<std::uint32_t>();
  const std::size_t least = format == kFormat ? kMandatorySections : kMandatorySections + 1;
  if (sections != least && sections != least + 1) header.fail("has a wrong number of sections for its format");
  if (header.read<std::uint64_t>() != file_size) {
    header.fail("has a file size other than the actual " + std::to_string(file_size) + " bytes");
  }
  SectionTable table;
  table.header_bytes = header_bytes(sections);
  std::size_t offset = table.header_bytes;
  for (std::size_t i = 0; i < kSectionCount; ++i) {
    if (i == kPictures && format == kFormat) continue;
    if (i == kUpkeep && sections == least) continue;
    table.places[i] = read_place(header, kSectionNames[i], offset, file_size);
    offset += table.places[i]->size;
  }
  table.checksum = header.read<std::uint64_t>();
  if (table.checksum != checksum(bytes.first(table.header_bytes - sizeof(std::uint64_t)))) {
    header.fail("has a wrong checksum");
  }
  if (offset != file_size) header.fail("leaves bytes outside of all sections");
  return table;
}

// Returns bytes of a file from an offset, valid during its own lifetime.
using Bring = std::function<Bytes(std::size_t offset, std::size_t size)>;

// Opens sections of a file by its table.
class SectionOpener {
 public:
  SectionOpener(const SectionTable& table, Bring bring, const std::string& name)
      : table_(table), bring_(std::move(bring)), name_(name) {}
  SectionOpener(Bytes bytes, const std::string& name)
      : SectionOpener(
            read_table(bytes, bytes.size(), name),
            [bytes](std::size_t offset, std::size_t size) { return bytes.subspan(offset, size); }, name) {}

  bool has(Section section) const { return table_.places[section].has_value(); }
  bool is_empty(Section section) const { return place_of(section).size == 0; }

  ByteReader operator()(Section section) const {
    const auto& [offset, size, expected_checksum] = place_of(section);
    const Bytes content = bring_(offset, size);
    ByteReader reader(content, name_ + ": section " + std::string(kSectionNames[section]), offset);
    if (checksum(content) != expected_checksum) reader.fail("has a wrong checksum");
    return reader;
  }

  // Unchecked.
  Bytes bytes_of(Section section) const { return bring_(place_of(section).offset, place_of(section).size); }
  const SectionPlace& place_of(Section section) const { return *table_.places[section]; }  // precondition: has(section)

 private:
  SectionTable table_;
  Bring bring_;
  const std::string& name_;
};

// Reads all except features, sightings, points, and the data of read_rest().
MapParts read_about(const SectionOpener& open, StoredMap& stored) {
  stored.notes = read_notes(open(kNotes));
  Provenance provenance = read_provenance(open(kProvenance));
  stored.scale = provenance.scale;
  stored.pose_source = provenance.pose_source;
  stored.recordings = std::move(provenance.recordings);
  MapParts parts;
  parts.rigs = read_rigs(open(kRigs));
  parts.keyframes = read_keyframes(open(kKeyframes), parts.rigs.size(), stored.recordings.size());
  return parts;
}

void read_rest(const SectionOpener& open, StoredMap& stored) {
  if (!open.is_empty(kPlan)) stored.plan = read_plan(open(kPlan));
  if (!open.is_empty(kRefinedCalibrations)) read_refined_calibrations(open(kRefinedCalibrations), stored.recordings);
  read_readout_times(open(kReadoutTimes), stored.recordings);
}

PartSectionSizes part_section_sizes(const SectionOpener& open) {
  PartSectionSizes sizes;
  for (std::size_t i = 0; i < kViewSections; ++i) sizes.views[i] = open.place_of(kSectionsOfViews[i]).size;
  sizes.points = open.place_of(kPoints).size;
  sizes.observers = open.place_of(kObservers).size;
  return sizes;
}

// Fails if the count at the beginning of section points differs from the summary. Reads no more of the section.
void require_points(const Bring& bring, const SectionPlace& section, const MapSummary& summary,
                    const std::string& name) {
  const std::size_t size = std::min(sizeof(std::uint32_t), section.size);
  ByteReader reader(bring(section.offset, size), name + ": section points", section.offset);
  if (reader.read<std::uint32_t>() != summary.points) reader.fail("has a number of points other than in the summary");
}

// Reads no more of the section; it is checked when it is read as a whole.
WordsHead words_head(const Bring& bring, const SectionPlace& section, const std::string& name) {
  const std::size_t size = std::min(sizeof(std::uint64_t) + 1, section.size);
  ByteReader reader(bring(section.offset, size), name + ": section words", section.offset);
  return read_words_head(reader);
}

void require_checksums(const ReadAt& read_at, std::size_t size, const std::string& name) {
  std::vector<std::byte> header(std::min(size, kMaxHeaderBytes));
  read_at(0, header);
  const SectionTable table = read_table(header, size, name);
  for (std::size_t i = 0; i < table.places.size(); ++i) {
    const std::optional<SectionPlace>& place = table.places[i];
    if (!place || i == kPictures) continue;  // each picture has its own checksum
    if (checksum_of_file(read_at, place->offset, place->size) == place->checksum) continue;
    ByteReader({}, name + ": section " + std::string(kSectionNames[i]), place->offset).fail("has a wrong checksum");
  }
}

MapFileSource::File file_of(const SectionOpener& open, ReadAt read_at, const std::string& name) {
  MapFileSource::File file;
  file.read_at = std::move(read_at);
  file.name = name;
  for (std::size_t i = 0; i < kViewSections; ++i) file.views[i] = open.place_of(kSectionsOfViews[i]).offset;
  file.words_size = open.place_of(kWords).size;
  file.words_checksum = open.place_of(kWords).checksum;
  file.points = open.place_of(kPoints).offset;
  file.observers = open.place_of(kObservers).offset;
  file.lookup = open.place_of(kLookup).offset;
  return file;
}

std::vector<std::byte> written(const StoredMap& stored, const MapUpkeep* upkeep) {
  const std::size_t optional = (upkeep != nullptr ? 1 : 0) + (has_pictures(stored.map) ? 1 : 0);
  std::vector<std::byte> file(header_bytes(kMandatorySections + optional));
  const WrittenSections sections = write_sections(stored, upkeep, file);
  if (const InputError* const fault = stored.map.damage()) throw InputError(*fault);
  ByteWriter header;
  write_header(Bytes(file).subspan(file.size() - sections.back().end), sections, header);
  std::ranges::copy(header.bytes(), file.begin());
  return file;
}

}  // namespace

std::vector<std::byte> write_map(const StoredMap& stored) {
  return written(stored, nullptr);
}

std::vector<std::byte> write_map(const StoredMap& stored, const MapUpkeep& upkeep) {
  return written(stored, &upkeep);
}

StoredMap read_map(std::span<const std::byte> bytes, const std::string& name) {
  const SectionOpener open(bytes, name);
  StoredMap stored;
  MapParts parts = read_about(open, stored);
  PartSizes sizes;
  RoundedPoints points = read_points(open(kPoints), sizes);
  read_views({open(kFeatures), open(kPatches), open(kObservations), open(kDescriptors)}, points, parts.rigs,
             parts.keyframes, sizes);
  parts.points = std::move(points.points);
  stored.vocabulary_checksum = read_words(open(kWords), parts.keyframes, sizes);
  if (open.has(kPictures)) read_pictures(open(kPictures), parts.keyframes);
  stored.map = MapGraph(Origin::offline, std::move(parts));
  read_rest(open, stored);

  ByteReader summary = open(kSummary);
  if (read_summary(summary) != summarise(stored.map)) summary.fail("does not match the other sections");
  const PartSections sections = part_sections([&open](Section section) { return open.bytes_of(section); });
  require_lookup(stored.map, sizes, sections, open(kObservers), open(kLookup));
  if (open.has(kUpkeep)) read_upkeep(open(kUpkeep), static_cast<std::size_t>(stored.map.point_count()));
  return stored;
}

MapUpkeep read_upkeep(std::span<const std::byte> bytes, const std::string& name) {
  const SectionOpener open(bytes, name);
  return open.has(kUpkeep) ? read_upkeep(open(kUpkeep), read_summary(open(kSummary)).points) : MapUpkeep{};
}

std::uint64_t map_id(std::span<const std::byte> bytes, const std::string& name) {
  return read_table(bytes, bytes.size(), name).checksum;
}

std::uint64_t map_id(const std::filesystem::path& path) {
  const MappedFile file(path);
  return map_id(file.bytes(), path.string());
}

std::string to_text(std::uint64_t map_id) {
  return fmt::format("{:016x}", map_id);
}

StoredMap open_map(const ReadAt& read_at, std::size_t size, const std::string& name) {
  std::vector<std::vector<std::byte>> pieces;
  const Bring bring = [&](std::size_t offset, std::size_t bytes) {
    read_at(offset, pieces.emplace_back(bytes));
    return Bytes(pieces.back());
  };
  const SectionOpener open(read_table(bring(0, std::min(size, kMaxHeaderBytes)), size, name), bring, name);
  StoredMap stored;
  MapParts parts = read_about(open, stored);
  const MapSummary summary = read_summary(open(kSummary));
  if (summary.keyframes != parts.keyframes.size() || summary.points > std::numeric_limits<int>::max()) {
    open(kSummary).fail("does not match the other sections");
  }
  require_points(bring, open.place_of(kPoints), summary, name);
  const WordsHead head = words_head(bring, open.place_of(kWords), name);
  stored.vocabulary_checksum = head.vocabulary_checksum;
  Lookup lookup = read_lookup(open(kLookup), summary, part_section_sizes(open));
  MapFileSource::File file = file_of(open, read_at, name);
  file.point_count = static_cast<std::uint32_t>(summary.points);
  file.rigs = parts.rigs;
  file.words = head;
  if (open.has(kPictures)) {
    const auto& [offset, bytes, unused] = open.place_of(kPictures);
    const std::string place = name + ": section pictures";
    const Bytes table = bring(offset, std::min(bytes, bytes_of_picture_table(parts.keyframes.size())));
    open_pictures(ByteReader(table, place, offset), {read_at, place, offset, bytes}, parts.keyframes);
  }
  stored.map = MapGraph(std::move(parts.rigs), std::move(parts.keyframes), static_cast<int>(summary.points),
                        std::make_shared<const MapFileSource>(std::move(file), std::move(lookup)));
  read_rest(open, stored);
  return stored;
}

std::vector<SectionSize> section_sizes(std::span<const std::byte> bytes, const std::string& name) {
  const SectionTable table = read_table(bytes, bytes.size(), name);
  std::vector<SectionSize> sizes = {{"header", table.header_bytes}};
  for (std::size_t i = 0; i < table.places.size(); ++i) {
    if (table.places[i]) sizes.push_back({std::string(kSectionNames[i]), table.places[i]->size});
  }
  return sizes;
}

StoredMap load_map(const std::filesystem::path& path) {
  return read_map(read_file(path), path.string());
}

StoredMap open_map(const std::filesystem::path& path) {
  constexpr std::size_t kCheckedAtOnce = 32 << 20;  // bytes, checked in 10 ms
  const auto file = std::make_shared<const RandomAccessFile>(path);
  const auto read_at = [file](std::size_t offset, std::span<std::byte> bytes) { file->read(offset, bytes); };
  if (file->size() <= kCheckedAtOnce) require_checksums(read_at, file->size(), path.string());
  return open_map(read_at, file->size(), path.string());
}

std::optional<PlanRegistration> load_plan_registration(const std::filesystem::path& path) {
  const MappedFile file(path);
  const std::string name = path.string();
  const SectionOpener open(file.bytes(), name);
  return open.is_empty(kPlan) ? std::nullopt : std::optional(read_plan(open(kPlan)));
}

namespace {

StoredMap reread(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  try {
    return read_map(bytes, path.string());
  } catch (const InputError& error) {
    throw InputError(path.string(), "is not written: the map is invalid: " + error.reason(), "");
  }
}

}  // namespace

void save_map(const StoredMap& stored, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = write_map(stored);
  reread(bytes, path);
  write_atomically(path, bytes);
}

void save_map(const StoredMap& stored, const MapUpkeep& upkeep, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = write_map(stored, upkeep);
  reread(bytes, path);
  write_atomically(path, bytes);
}

void save_and_reread(StoredMap& stored, const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = write_map(stored);
  stored = {};
  stored = reread(bytes, path);
  write_atomically(path, bytes);
}

}  // namespace byre
