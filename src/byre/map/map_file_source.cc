#include "byre/map/map_file_source.h"

#include "byre/map/map_numbers.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::array<std::string_view, kViewSections> kViewNames = {"features", "patches", "observations",
                                                                    "descriptors", "words"};

// A keyframe without sightings. It has the number of features to which readable points may refer.
Keyframe blank_keyframe(const Keyframe& header, const Rig& rig, std::uint32_t features) {
  const Keypoint anywhere{.pixel = Eigen::Vector2f::Zero()};
  Keyframe keyframe = header;
  keyframe.frame.features =
      std::make_shared<const Features>(rig.width, rig.height, std::vector<Keypoint>(features, anywhere),
                                       std::vector<Descriptor>(features), std::vector<Patch>());
  keyframe.sightings.resize(features);
  return keyframe;
}

ObservedPoint blank_point() {
  ObservedPoint unseen;
  unseen.point.reference.keyframe = {Origin::offline, 0};
  return unseen;
}

}  // namespace

MapFileSource::MapFileSource(File file, Lookup lookup)
    : file_(std::move(file)),
      lookup_(std::move(lookup)),
      keyframes_(lookup_.keyframes.size()),
      blocks_(lookup_.blocks.size()) {}

template <typename Read, typename Substitute>
auto MapFileSource::read_or(Read read, Substitute substitute) const {
  try {
    return read();
  } catch (const InputError& error) {
    damage_.get(0, [&error] { return error; });
    return substitute();
  }
}

const Keyframe& MapFileSource::keyframe(std::uint32_t number, const Keyframe& header) const {
  const std::uint32_t features = lookup_.keyframes[number].features;
  return keyframes_.get(number, [&] {
    return read_or([&] { return read_keyframe(number, header); },
                   [&] { return blank_keyframe(header, file_.rigs[static_cast<std::size_t>(header.rig)], features); });
  });
}

const ObservedPoint& MapFileSource::point(std::uint32_t number) const {
  const std::uint32_t block = number / kPointsOfBlock;
  const std::uint32_t size = std::min(kPointsOfBlock, file_.point_count - block * kPointsOfBlock);
  return blocks_.get(block, [&] {
    return read_or([&] { return read_block(block); }, [&] { return Block(size, blank_point()); });
  })[number % kPointsOfBlock];
}

ScratchVector<Covisible> MapFileSource::covisible(std::uint32_t number) const {
  const ByteRange& place = lookup_.keyframes[number].covisible;
  const std::size_t first_byte = file_.lookup + lookup_.first_byte_of_covisible + place.begin;
  const ByteReader reader(Bytes(lookup_.covisible).subspan(place.begin, place.size), place_of("lookup"), first_byte);
  return read_or([&] { return read_covisible(reader, number, lookup_.keyframes.size()); },
                 [] { return ScratchVector<Covisible>(); });
}

void MapFileSource::visit_words(const WordVisitor& visit) const {
  std::vector<std::byte> section(file_.words_size);
  file_.read_at(file_.views[kWordsOfView], section);
  ByteReader reader(section, place_of("words"), file_.views[kWordsOfView]);
  if (checksum(section) != file_.words_checksum) reader.fail("has a wrong checksum");
  read_words_head(reader);
  for (std::uint32_t number = 0; number < lookup_.keyframes.size(); ++number) {
    visit({Origin::offline, number}, read_words_of(reader, file_.words, lookup_.keyframes[number].features));
  }
  reader.require_end();
}

std::string MapFileSource::place_of(std::string_view section) const {
  return file_.name + ": section " + std::string(section);
}

ScratchVector<std::byte> MapFileSource::read_parts(std::span<const Part> parts, std::uint64_t expected) const {
  std::size_t size = 0;
  for (const Part& part : parts) size += part.place.size;
  ScratchVector<std::byte> bytes(size);
  std::size_t begin = 0;
  for (const Part& part : parts) {
    if (part.place.size == 0) continue;
    file_.read_at(part.section + part.place.begin, std::span(bytes).subspan(begin, part.place.size));
    begin += part.place.size;
  }
  if (checksum(bytes) != expected) {
    ByteReader({}, place_of(parts.front().name), parts.front().section + parts.front().place.begin)
        .fail("has a part with a wrong checksum, here or in the matching part of a later section");
  }
  return bytes;
}

Keyframe MapFileSource::read_keyframe(std::uint32_t number, const Keyframe& header) const {
  const KeyframeParts& known = lookup_.keyframes[number];
  std::array<Part, kViewSections> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = {file_.views[i], known.views[i], kViewNames[i]};
  const ScratchVector<std::byte> bytes = read_parts(parts, known.checksum);
  std::size_t begin = 0;
  std::vector<ByteReader> readers;
  readers.reserve(parts.size());
  for (const auto& [section, place, name] : parts) {
    readers.emplace_back(Bytes(bytes).subspan(begin, place.size), place_of(name), section + place.begin);
    begin += place.size;
  }
  Keyframe keyframe = header;
  read_view(
      {readers[kFeaturesOfView], readers[kPatchesOfView], readers[kObservationsOfView], readers[kDescriptorsOfView]},
      number, file_.rigs[static_cast<std::size_t>(header.rig)], file_.point_count,
      [this](std::uint32_t point_number) -> const ObservedPoint& { return point(point_number); }, keyframe);
  if (keyframe.sightings.size() != known.features) {
    readers[kFeaturesOfView].fail("has a number of features other than in the section lookup");
  }
  keyframe.words = read_words_of(readers[kWordsOfView], file_.words, known.features);
  readers[kWordsOfView].require_end();
  return keyframe;
}

MapFileSource::Block MapFileSource::read_block(std::uint32_t number) const {
  const PointBlock& known = lookup_.blocks[number];
  const std::array<Part, 2> parts = {
      {{file_.points, known.points, "points"}, {file_.observers, known.observers, "observers"}}};
  const ScratchVector<std::byte> bytes = read_parts(parts, known.checksum);
  ByteReader points(Bytes(bytes).first(known.points.size), place_of("points"), file_.points + known.points.begin);
  ByteReader observers(Bytes(bytes).subspan(known.points.size), place_of("observers"),
                       file_.observers + known.observers.begin);
  const std::uint32_t first = number * kPointsOfBlock;
  Block block(std::min(kPointsOfBlock, file_.point_count - first));
  for (std::uint32_t i = 0; i < block.size(); ++i) {
    auto& [point, observations] = block[i];
    const std::uint32_t reference = read_point(points, first + i, point);
    observations = read_observers(observers, lookup_.keyframes);
    if (reference >= observations.size()) {
      require_no_fault(points, "has a reference keyframe that does not observe it", "point", first + i);
    }
    point.reference = observations[reference];
  }
  points.require_end();
  observers.require_end();
  return block;
}

}  // namespace byre
