#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace byre {

// What a file holds, as its first bytes tell.
enum class FileContent : std::uint8_t {
  nothing,
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
  table,  // table of comma-separated values
  text,   // text of any other kind
  other,
};

// Empty for what is no regular file, or cannot be read.
std::optional<FileContent> content_of(const std::filesystem::path& file);

}  // namespace byre
