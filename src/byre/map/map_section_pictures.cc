// Small pictures of keyframes.

#include "byre/input_error.h"
#include "byre/map/map_sections.h"

#include <algorithm>

namespace byre {
namespace {

constexpr std::size_t kEntryBytes = sizeof(std::uint32_t) + sizeof(std::uint64_t);

// Size and checksum of a picture.
struct Entry {
  std::uint32_t size = 0;
  std::uint64_t checksum = 0;
};

std::vector<Entry> read_entries(ByteReader& reader, std::size_t keyframes) {
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < keyframes; ++i) {
    Entry& entry = entries.emplace_back();
    entry.size = reader.read<std::uint32_t>();
    entry.checksum = reader.read<std::uint64_t>();
    if (entry.size > StoredPicture::kMaxBytes) reader.fail("has a picture of more than 64 kB");
    if (entry.size == 0 && entry.checksum != 0) reader.fail("has a checksum of a missing picture");
  }
  return entries;
}

bool has_picture(const std::vector<Entry>& entries) {
  return std::ranges::any_of(entries, [](const Entry& entry) { return entry.size > 0; });
}

}  // namespace

std::size_t bytes_of_picture_table(std::size_t keyframes) {
  return keyframes * kEntryBytes;
}

void write_pictures(const Keyframes& keyframes, ByteWriter& writer) {
  for (const Keyframe* const keyframe : keyframes) {
    const std::vector<std::byte> jpeg = keyframe->picture.jpeg();
    writer.write(static_cast<std::uint32_t>(jpeg.size()));
    writer.write(jpeg.empty() ? std::uint64_t{0} : checksum(jpeg));
  }
  for (const Keyframe* const keyframe : keyframes) writer.write_bytes(keyframe->picture.jpeg());
}

void read_pictures(ByteReader reader, std::vector<Keyframe>& keyframes) {
  const std::vector<Entry> entries = read_entries(reader, keyframes.size());
  if (!has_picture(entries)) reader.fail("has no picture");
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const std::span<const std::byte> jpeg = reader.take(entries[i].size);
    if (!jpeg.empty() && checksum(jpeg) != entries[i].checksum) reader.fail("has a picture with a wrong checksum");
    keyframes[i].picture = StoredPicture(std::vector(jpeg.begin(), jpeg.end()));
  }
  reader.require_end();
}

void open_pictures(ByteReader table, const PictureSection& section, std::vector<Keyframe>& keyframes) {
  const std::vector<Entry> entries = read_entries(table, keyframes.size());
  std::size_t offset = section.offset + bytes_of_picture_table(keyframes.size());
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Entry& entry = entries[i];
    if (entry.size > 0) {
      keyframes[i].picture =
          StoredPicture(entry.size, [read_at = section.read_at, place = section.place, offset, entry] {
            std::vector<std::byte> jpeg(entry.size);
            read_at(offset, jpeg);
            if (checksum(jpeg) != entry.checksum)
              ByteReader({}, place, offset).fail("has a picture with a wrong checksum");
            return jpeg;
          });
    }
    offset += entry.size;
  }
  if (offset != section.offset + section.size) table.fail("has sizes of pictures that do not match its size");
}

}  // namespace byre
