#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace byre {

// Kind of content of a file, by its first bytes, its size and the extension of its name.
enum class FileContent : std::uint8_t {
  nothing,  // empty file
  map,
  vocabulary,
  png,
  video,
  point_cloud,
  mcap,
  svg,
  json,
  trajectory,
  yaml,
  table,         // comma-separated values
  colmap_model,  // one file of a COLMAP model, text or binary
  page,          // HTML, or Markdown by extension
  text,          // text of another kind
  other,
};

// For messages: "map", "PNG picture".
std::string_view name_of(FileContent content);

// Content of a file with this name and these bytes.
FileContent content_of(std::span<const std::byte> bytes, const std::filesystem::path& name);

// Empty if it is not a regular file or cannot be read.
std::optional<FileContent> content_of(const std::filesystem::path& file);

// Whether a file may be replaced by one with other content: both of one kind, or nothing would be lost.
bool may_replace(FileContent there, FileContent written);

}  // namespace byre
