#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

namespace byre {

// Kind of content of a file, by its first bytes, size and extension.
enum class FileContent : std::uint8_t {
  nothing,  // empty file
  map,
  vocabulary,
  png,
  pgm,
  photograph,  // JPEG or TIFF
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
  text,          // other text
  other,
};

// Name in messages: "map", "PNG picture".
std::string_view name_of(FileContent content);

// Content of a file with this name and these bytes.
FileContent content_of(std::span<const std::byte> bytes, const std::filesystem::path& name);

// Content of a file; empty if it is not a regular file or cannot be read.
std::optional<FileContent> content_of(const std::filesystem::path& file);

// Whether a file may be replaced: both contents are of one known kind, or the present file is empty.
bool may_replace(FileContent there, FileContent written);

}  // namespace byre
