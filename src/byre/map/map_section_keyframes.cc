// Keyframes without their features: times, poses and words.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace byre {
namespace {

constexpr std::size_t kKeyframeBytes =
    sizeof(std::int64_t) + 3 * sizeof(std::uint32_t) + kPoseBytes + kSymmetricBytes<6>;
constexpr auto kNoParent = std::numeric_limits<std::uint32_t>::max();

void write_keyframe(const Keyframe& keyframe, ByteWriter& writer) {
  writer.write(std::int64_t{keyframe.frame.time.count()});
  writer.write(static_cast<std::uint32_t>(keyframe.rig));
  writer.write(static_cast<std::uint32_t>(keyframe.recording));
  writer.write(keyframe.parent ? keyframe.parent->number : kNoParent);
  write_pose(keyframe.camera_from_world, writer);
  write_symmetric(keyframe.covariance, writer);
}

std::optional<KeyframeId> read_parent(ByteReader& reader, std::uint32_t child) {
  const auto parent = reader.read<std::uint32_t>();
  if (parent == kNoParent) return std::nullopt;
  if (parent >= child) {
    reader.fail("keyframe " + std::to_string(child) + " has the younger parent " + std::to_string(parent));
  }
  return KeyframeId{Origin::offline, parent};
}

Keyframe read_keyframe(ByteReader& reader, std::uint32_t number, std::size_t rig_count, std::size_t recording_count) {
  Keyframe keyframe;
  keyframe.frame.time = Timestamp(reader.read<std::int64_t>());
  keyframe.rig = static_cast<int>(read_index(reader, rig_count, "rig"));
  keyframe.recording = static_cast<int>(read_index(reader, recording_count, "recording"));
  keyframe.parent = read_parent(reader, number);
  keyframe.camera_from_world = read_pose(reader);
  keyframe.covariance = read_symmetric<6>(reader);
  require_no_fault(reader, fault_in(keyframe.camera_from_world), "keyframe", number);
  if (!keyframe.covariance.allFinite())
    require_no_fault(reader, "has a covariance that is not finite", "keyframe", number);
  return keyframe;
}

void require_word_flag(const ByteReader& reader, std::size_t features, std::uint64_t vocabulary_checksum) {
  if (features == 0) reader.fail("has words for a keyframe without features");
  if (vocabulary_checksum == 0) reader.fail("has words without a vocabulary");
}

std::size_t bytes_for_word(Word greatest) {
  return greatest < 256 ? 1 : (static_cast<std::size_t>(std::bit_width(greatest)) + 7) / 8;
}

}  // namespace

void write_keyframes(const Keyframes& keyframes, ByteWriter& writer) {
  writer.write(static_cast<std::uint32_t>(keyframes.size()));
  for (const Keyframe* const keyframe : keyframes) write_keyframe(*keyframe, writer);
}

std::vector<Keyframe> read_keyframes(ByteReader reader, std::size_t rig_count, std::size_t recording_count) {
  const std::uint32_t count = reader.read_count(kKeyframeBytes);
  std::vector<Keyframe> keyframes;
  keyframes.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    keyframes.push_back(read_keyframe(reader, i, rig_count, recording_count));
  }
  reader.require_end();
  return keyframes;
}

void write_words(const Keyframes& keyframes, std::uint64_t vocabulary_checksum, ByteWriter& writer, PartSizes& sizes) {
  Word greatest = 0;
  for (const Keyframe* const keyframe : keyframes) {
    for (const Word word : keyframe->words) greatest = std::max(greatest, word);
  }
  const std::size_t bytes_each = bytes_for_word(greatest);
  writer.write(vocabulary_checksum);
  writer.write(static_cast<std::uint8_t>(bytes_each));
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const std::size_t begin = writer.size();
    writer.write(!keyframes[i]->words.empty());
    for (const Word word : keyframes[i]->words) writer.write_low_bytes(word, bytes_each);
    sizes.views[i][kWordsOfView] = static_cast<std::uint32_t>(writer.size() - begin);
  }
}

WordsHead read_words_head(ByteReader& reader) {
  WordsHead head;
  head.vocabulary_checksum = reader.read<std::uint64_t>();
  head.bytes_each = reader.read<std::uint8_t>();
  if (head.bytes_each < 1 || head.bytes_each > sizeof(Word)) {
    reader.fail("has words of " + std::to_string(head.bytes_each) + " bytes");
  }
  return head;
}

std::vector<Word> read_words_of(ByteReader& reader, const WordsHead& head, std::size_t features) {
  std::vector<Word> words;
  if (!read_bool(reader)) return words;
  require_word_flag(reader, features, head.vocabulary_checksum);
  ByteReader part(reader.take(features * head.bytes_each), "", 0);
  words.reserve(features);
  for (std::size_t i = 0; i < features; ++i) words.push_back(static_cast<Word>(part.read_low_bytes(head.bytes_each)));
  return words;
}

std::uint64_t read_words(ByteReader reader, std::vector<Keyframe>& keyframes, PartSizes& sizes) {
  const WordsHead head = read_words_head(reader);
  Word greatest = 0;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const std::size_t before = reader.remaining();
    keyframes[i].words = read_words_of(reader, head, keyframes[i].sightings.size());
    for (const Word word : keyframes[i].words) greatest = std::max(greatest, word);
    sizes.views[i][kWordsOfView] = static_cast<std::uint32_t>(before - reader.remaining());
  }
  if (bytes_for_word(greatest) != head.bytes_each) reader.fail("has words with more bytes than necessary");
  reader.require_end();
  return head.vocabulary_checksum;
}

}  // namespace byre
