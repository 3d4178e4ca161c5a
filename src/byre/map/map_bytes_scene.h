#pragma once

#include "byre/base/byte_stream.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre {

// Access to the bytes of a map file, for tests that damage them. Independent of byre's reader and writer, so that tests
// detect changes of the format. See docs/reference/map_format.md.

using MapBytes = std::vector<std::byte>;

inline constexpr std::size_t kFormatAt = 8;
inline constexpr std::size_t kSectionCountAt = 12;
inline constexpr std::size_t kFileSizeAt = 16;
inline constexpr std::size_t kTableAt = 24;
inline constexpr std::size_t kTableEntrySize = 40;
inline constexpr std::size_t kSections = 16;  // without the optional sections `pictures` and `upkeep`
inline constexpr std::size_t kHeaderChecksumAt = kTableAt + kSections * kTableEntrySize;
inline constexpr std::size_t kHeaderSize = kHeaderChecksumAt + 8;

// Precondition: the value lies within the bytes.
template <PlainNumber T>
T value_at(const MapBytes& bytes, std::size_t place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof(T));
  return value;
}
template <PlainNumber T>
void put_at(MapBytes& bytes, std::size_t place, T value) {
  std::memcpy(bytes.data() + place, &value, sizeof(T));
}

inline std::size_t sections_in(const MapBytes& bytes) {
  const std::size_t count = value_at<std::uint32_t>(bytes, kSectionCountAt);
  return count == kSections + 1 || count == kSections + 2 ? count : kSections;
}
inline std::size_t header_checksum_at(const MapBytes& bytes) {
  return kTableAt + sections_in(bytes) * kTableEntrySize;
}

struct TableEntry {
  std::size_t at = 0;  // byte offset of the entry
  std::string name;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
};

// Precondition: the bytes contain a header, which may be damaged.
inline TableEntry table_entry(const MapBytes& bytes, std::size_t index) {
  const std::size_t at = kTableAt + index * kTableEntrySize;
  std::string name(reinterpret_cast<const char*>(bytes.data() + at), 16);
  name.resize(std::min(name.find('\0'), name.size()));
  return {at, name, value_at<std::uint64_t>(bytes, at + 16), value_at<std::uint64_t>(bytes, at + 24)};
}

inline void write_entry(MapBytes& bytes, const TableEntry& entry) {
  put_at(bytes, entry.at + 16, entry.offset);
  put_at(bytes, entry.at + 24, entry.size);
}

inline TableEntry section_of(const MapBytes& bytes, std::string_view name) {
  TableEntry entry;
  for (std::size_t i = 0; i < sections_in(bytes) && entry.name != name; ++i) entry = table_entry(bytes, i);
  return entry;
}

// A section of a valid table, or an empty span.
inline std::span<std::byte> section_bytes(MapBytes& bytes, std::string_view name) {
  const TableEntry entry = section_of(bytes, name);
  if (entry.name != name || entry.offset > bytes.size() || entry.size > bytes.size() - entry.offset) return {};
  return std::span(bytes).subspan(entry.offset, entry.size);
}

// Takes the next part of each section. Returns whether all of them are complete.
inline bool take_parts(std::vector<std::span<std::byte>>& sections, const std::byte* sizes, MapBytes& parts) {
  parts.clear();
  for (std::span<std::byte>& section : sections) {
    std::uint32_t size = 0;
    std::memcpy(&size, sizes, sizeof(size));
    sizes += sizeof(size);
    if (size > section.size()) return false;
    parts.insert(parts.end(), section.begin(), section.begin() + size);
    section = section.subspan(size);
  }
  return true;
}

// Recomputes the checksums in the section lookup as far as its sizes are valid. Precondition: as for section_bytes().
inline void refresh_part_checksums(MapBytes& bytes) {
  constexpr std::size_t kKeyframeSize = 36, kBlockSize = 16, kPointsOfBlock = 32;
  const auto sections_from = [&](std::initializer_list<std::pair<const char*, std::size_t>> names) {
    std::vector<std::span<std::byte>> sections;
    for (const auto& [name, head] : names) {
      const std::span<std::byte> section = section_bytes(bytes, name);
      sections.push_back(section.subspan(std::min(head, section.size())));
    }
    return sections;
  };
  const auto count_in = [&](const char* name) {
    const std::span<std::byte> section = section_bytes(bytes, name);
    std::uint32_t count = 0;
    if (section.size() >= sizeof(count)) std::memcpy(&count, section.data(), sizeof(count));
    return std::size_t{count};
  };
  std::span<std::byte> lookup = section_bytes(bytes, "lookup");
  MapBytes parts;
  const auto refresh = [&](std::vector<std::span<std::byte>> sections, std::size_t count, std::size_t size,
                           std::size_t sizes_at) {
    for (; count > 0 && lookup.size() >= size; --count, lookup = lookup.subspan(size)) {
      if (!take_parts(sections, lookup.data() + sizes_at, parts)) return false;
      const std::uint64_t sum = checksum(parts);
      std::memcpy(lookup.data() + size - sizeof(sum), &sum, sizeof(sum));
    }
    return count == 0;
  };
  const auto views =
      sections_from({{"features", 0}, {"patches", 0}, {"observations", 0}, {"descriptors", 0}, {"words", 9}});
  if (!refresh(views, count_in("keyframes"), kKeyframeSize, 4)) return;
  const std::size_t blocks = (count_in("points") + kPointsOfBlock - 1) / kPointsOfBlock;
  refresh(sections_from({{"points", 4}, {"observers", 0}}), blocks, kBlockSize, 0);
}

// Recomputes the checksums in the section pictures as far as its sizes are valid. Precondition: as for section_bytes().
inline void refresh_picture_checksums(MapBytes& bytes) {
  constexpr std::size_t kEntrySize = 12;
  const std::span<std::byte> keyframes = section_bytes(bytes, "keyframes"), section = section_bytes(bytes, "pictures");
  std::uint32_t count = 0;
  if (keyframes.size() >= sizeof(count)) std::memcpy(&count, keyframes.data(), sizeof(count));
  if (section.size() / kEntrySize < count) return;
  std::span<std::byte> pictures = section.subspan(count * kEntrySize);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t size = 0;
    std::memcpy(&size, section.data() + i * kEntrySize, sizeof(size));
    if (size > pictures.size()) return;
    const std::uint64_t sum = size == 0 ? 0 : checksum(pictures.first(size));
    std::memcpy(section.data() + i * kEntrySize + sizeof(size), &sum, sizeof(sum));
    pictures = pictures.subspan(size);
  }
}

// Recomputes all checksums, so that they do not reveal a change. Skips sections that the table places outside the
// bytes. Does nothing without a complete header.
inline void refresh_checksums(MapBytes& bytes) {
  if (bytes.size() < kHeaderSize || bytes.size() < header_checksum_at(bytes) + 8) return;
  refresh_part_checksums(bytes);
  refresh_picture_checksums(bytes);
  for (std::size_t i = 0; i < sections_in(bytes); ++i) {
    const TableEntry entry = table_entry(bytes, i);
    if (entry.offset > bytes.size() || entry.size > bytes.size() - entry.offset) continue;
    put_at(bytes, entry.at + 32, checksum(std::span(bytes).subspan(entry.offset, entry.size)));
  }
  const std::size_t end = header_checksum_at(bytes);
  put_at(bytes, end, checksum(std::span(bytes).first(end)));
}

// Replaces bytes of a section and updates sizes and offsets. Preconditions: a valid table; bytes within the section.
inline void replace_in_section(MapBytes& bytes, std::size_t index, std::size_t begin, std::size_t count,
                               const MapBytes& replacement) {
  TableEntry changed = table_entry(bytes, index);
  const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(changed.offset + begin);
  const auto rest = bytes.erase(first, first + static_cast<std::ptrdiff_t>(count));
  bytes.insert(rest, replacement.begin(), replacement.end());
  const std::uint64_t growth = replacement.size() - count;  // may wrap around, and does so again below
  changed.size += growth;
  write_entry(bytes, changed);
  for (std::size_t i = index + 1; i < sections_in(bytes); ++i) {
    TableEntry later = table_entry(bytes, i);
    later.offset += growth;
    write_entry(bytes, later);
  }
  put_at(bytes, kFileSizeAt, std::uint64_t{bytes.size()});
}

}  // namespace byre
