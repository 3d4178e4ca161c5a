// Locations of keyframes and points in other sections, and covisibility of keyframes.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

namespace byre {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kKeyframePartsBytes = (1 + kViewSections + 1) * sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::size_t kPointBlockBytes = 2 * sizeof(std::uint32_t) + sizeof(std::uint64_t);
constexpr std::size_t kPointsHeadBytes = sizeof(std::uint32_t);
constexpr std::size_t kWordsHeadBytes = sizeof(std::uint64_t) + 1;

std::size_t block_count(std::size_t points) {
  return (points + kPointsOfBlock - 1) / kPointsOfBlock;
}

// Ascending numbers: the first one, then the gap between each and its predecessor.
class AscendingWriter {
 public:
  explicit AscendingWriter(ByteWriter& writer) : writer_(writer) {}

  void write(std::uint32_t number) {
    writer_.write_varint(number - next_);
    next_ = number + 1;
  }

 private:
  ByteWriter& writer_;
  std::uint32_t next_ = 0;
};

class AscendingReader {
 public:
  AscendingReader(ByteReader& reader, std::size_t count) : reader_(reader), count_(count) {}

  // Fails for a number that is not below the count.
  std::uint32_t read() {
    const std::uint32_t skipped = reader_.read_varint();
    if (skipped >= count_ - next_) {
      reader_.fail("refers to a keyframe beyond the last of " + std::to_string(count_));
    }
    const std::size_t number = next_ + skipped;
    next_ = number + 1;
    return static_cast<std::uint32_t>(number);
  }

 private:
  ByteReader& reader_;
  std::size_t count_;
  std::size_t next_ = 0;
};

void write_observers(const std::vector<Observation>& observations, ByteWriter& writer) {
  writer.write_varint(static_cast<std::uint32_t>(observations.size()));
  AscendingWriter keyframes(writer);
  for (const Observation& seen : observations) {
    keyframes.write(seen.keyframe.number);
    writer.write_varint(static_cast<std::uint32_t>(seen.feature));
  }
}

void write_covisible(const MapGraph& map, KeyframeId id, ByteWriter& writer) {
  ScratchVector<Covisible> all = map.covisible_keyframes(id, std::numeric_limits<int>::max());
  std::ranges::sort(all, {}, &Covisible::keyframe);
  writer.write_varint(static_cast<std::uint32_t>(all.size()));
  AscendingWriter keyframes(writer);
  for (const Covisible& covisible : all) {
    keyframes.write(covisible.keyframe.number);
    writer.write_varint(static_cast<std::uint32_t>(covisible.shared_points));
  }
}

// Takes consecutive parts of a section.
class PartTaker {
 public:
  explicit PartTaker(Bytes section) : rest_(section) {}

  Bytes take(std::size_t size) {
    const Bytes part = rest_.first(size);
    rest_ = rest_.subspan(size);
    return part;
  }

 private:
  Bytes rest_;
};

void write_keyframe_parts(const MapGraph& map, const PartSizes& sizes, const PartSections& sections, ByteWriter& lookup,
                          ByteWriter& covisible) {
  std::vector<PartTaker> takers(sections.views.begin(), sections.views.end());
  takers[kWordsOfView].take(kWordsHeadBytes);
  for (std::uint32_t number = 0; number < sizes.views.size(); ++number) {
    std::array<Bytes, kViewSections> parts;
    const KeyframeId id{map.origin(), number};
    lookup.write(static_cast<std::uint32_t>(map.find_keyframe(id)->sightings.size()));
    for (std::size_t i = 0; i < kViewSections; ++i) {
      parts[i] = takers[i].take(sizes.views[number][i]);
      lookup.write(sizes.views[number][i]);
    }
    const std::size_t begin = covisible.size();
    write_covisible(map, id, covisible);
    lookup.write(static_cast<std::uint32_t>(covisible.size() - begin));
    lookup.write(checksum_of_pieces(parts));
  }
}

void write_point_blocks(const MapGraph& map, const PartSizes& sizes, const PartSections& sections, ByteWriter& lookup,
                        ByteWriter& observers) {
  const auto point_count = static_cast<std::uint32_t>(map.point_count());
  PartTaker points(sections.points);
  points.take(kPointsHeadBytes);
  for (std::uint32_t block = 0; block < sizes.points.size(); ++block) {
    ByteWriter seen;
    const std::uint32_t first = block * kPointsOfBlock;
    for (std::uint32_t point = first; point < std::min(first + kPointsOfBlock, point_count); ++point) {
      write_observers(map.observations({map.origin(), point}), seen);
    }
    lookup.write(sizes.points[block]);
    lookup.write(static_cast<std::uint32_t>(seen.size()));
    lookup.write(checksum_of_pieces(std::array{points.take(sizes.points[block]), Bytes(seen.bytes())}));
    observers.write_bytes(seen.bytes());
  }
}

// Reads the size of the next of consecutive parts; end: end of the previous part, updated.
ByteRange read_byte_range(ByteReader& reader, std::size_t& end) {
  const ByteRange place{end, reader.read<std::uint32_t>()};
  end += place.size;
  return place;
}

void require_bytes(ByteReader reader, Bytes expected, std::string_view fault) {
  if (!std::ranges::equal(reader.take(expected.size()), expected)) reader.fail(fault);
  reader.require_end();
}

}  // namespace

void write_lookup(const MapGraph& map, const PartSizes& sizes, const PartSections& sections, ByteWriter& observers,
                  ByteWriter& lookup) {
  ByteWriter covisible;
  write_keyframe_parts(map, sizes, sections, lookup, covisible);
  write_point_blocks(map, sizes, sections, lookup, observers);
  lookup.write_bytes(covisible.bytes());
}

void require_lookup(const MapGraph& map, const PartSizes& sizes, const PartSections& sections, ByteReader observers,
                    ByteReader lookup) {
  ByteWriter expected_observers, expected_lookup;
  write_lookup(map, sizes, sections, expected_observers, expected_lookup);
  require_bytes(std::move(observers), expected_observers.bytes(), "does not match the observations of the points");
  require_bytes(std::move(lookup), expected_lookup.bytes(), "does not match the layout of other sections");
}

Lookup read_lookup(ByteReader reader, const MapSummary& summary, const PartSectionSizes& sizes) {
  const std::size_t blocks = block_count(summary.points);
  if (summary.keyframes > reader.remaining() / kKeyframePartsBytes || blocks > reader.remaining() / kPointBlockBytes) {
    reader.fail("does not have one entry for each keyframe and point");
  }
  Lookup lookup;
  lookup.keyframes.resize(summary.keyframes);
  lookup.blocks.resize(blocks);
  PartSectionSizes ends;
  ends.views[kWordsOfView] = kWordsHeadBytes;
  ends.points = kPointsHeadBytes;
  std::size_t features = 0, end_of_covisible = 0;
  for (KeyframeParts& parts : lookup.keyframes) {
    parts.features = reader.read<std::uint32_t>();
    features += parts.features;
    for (std::size_t i = 0; i < kViewSections; ++i) parts.views[i] = read_byte_range(reader, ends.views[i]);
    parts.covisible = read_byte_range(reader, end_of_covisible);
    parts.checksum = reader.read<std::uint64_t>();
  }
  for (PointBlock& block : lookup.blocks) {
    block.points = read_byte_range(reader, ends.points);
    block.observers = read_byte_range(reader, ends.observers);
    block.checksum = reader.read<std::uint64_t>();
  }
  const bool is_used_up = ends.views == sizes.views && ends.points == sizes.points && ends.observers == sizes.observers;
  if (!is_used_up || features != summary.features || end_of_covisible != reader.remaining()) {
    reader.fail("does not match the layout of other sections");
  }
  lookup.first_byte_of_covisible = kKeyframePartsBytes * summary.keyframes + kPointBlockBytes * blocks;
  lookup.covisible.assign(reader.rest().begin(), reader.rest().end());
  return lookup;
}

ScratchVector<Covisible> read_covisible(ByteReader reader, std::uint32_t keyframe, std::size_t keyframe_count) {
  const std::uint32_t count = reader.read_varint();
  if (count > reader.remaining()) reader.fail("has more covisible keyframes than its bytes can hold");
  ScratchVector<Covisible> all;
  all.reserve(count);
  AscendingReader numbers(reader, keyframe_count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t number = numbers.read();
    const std::uint32_t shared = reader.read_varint();
    if (number == keyframe || shared == 0 || shared > std::numeric_limits<int>::max()) {
      require_no_fault(reader, "has an invalid covisible keyframe", "keyframe", keyframe);
    }
    all.push_back({{Origin::offline, number}, static_cast<int>(shared)});
  }
  reader.require_end();
  return all;
}

std::vector<Observation> read_observers(ByteReader& reader, const std::vector<KeyframeParts>& keyframes) {
  const std::uint32_t count = reader.read_varint();
  if (count == 0 || count > reader.remaining()) reader.fail("has a point with no or too many observations");
  std::vector<Observation> observations;
  observations.reserve(count);
  AscendingReader numbers(reader, keyframes.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t number = numbers.read();
    const std::uint32_t feature = reader.read_varint();
    if (feature >= keyframes[number].features) reader.fail("refers to a feature that its keyframe does not have");
    observations.push_back({{Origin::offline, number}, static_cast<int>(feature)});
  }
  return observations;
}

}  // namespace byre
