#include "byre/base/file_content.h"

#include "byre/base/enum_names.h"
#include "byre/base/text_file.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <string>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kProbeBytes = 4096;

std::string first_bytes(std::ifstream& file) {
  std::string bytes(kProbeBytes, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

bool is_text(std::string_view bytes) {
  return std::ranges::none_of(bytes, [](unsigned char c) { return c < ' ' && !std::isspace(c); });
}

std::string_view first_line(std::string_view text) {
  return text.substr(0, text.find('\n'));
}

// The first line that is neither blank nor a comment; without one, the first line.
std::string_view first_entry(std::string_view text) {
  const std::string_view comment = first_line(text);
  while (!text.empty()) {
    const std::string_view line = first_line(text);
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin != std::string_view::npos && line[begin] != '#') return line;
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return comment;
}

// Whether a line is a pose in TUM, EuRoC or KITTI format, or the header of such a file.
bool is_pose(std::string_view line) {
  if (line.starts_with("# timestamp tx ty tz") || line.starts_with("#timestamp [ns],p_RS_R_x"))
    return true;  // header of a file without poses
  const bool has_commas = line.find(',') != std::string_view::npos;
  std::string spaced(line);
  std::ranges::replace(spaced, ',', ' ');
  const std::vector<std::string_view> fields = split_fields(spaced);
  return (fields.size() == 8 || (fields.size() == 12 && !has_commas)) &&
         std::ranges::all_of(fields, [](std::string_view field) { return parse_number(field).has_value(); });
}

bool is_field(std::string_view line) {
  if (line.starts_with("%YAML") || line.starts_with("---")) return true;
  const std::string_view name = line.substr(0, line.find(':'));
  if (name.empty() || name.size() == line.size()) return false;
  return std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

bool begins_with_any(std::string_view text, std::initializer_list<std::string_view> beginnings) {
  return std::ranges::any_of(beginnings, [&](std::string_view beginning) { return text.starts_with(beginning); });
}

// Whether text begins like the text files of COLMAP or of byre's export.
bool is_colmap_text(std::string_view text) {
  return begins_with_any(text, {"# Camera list", "# Image list", "# 3D point list", "# CAMERA_ID MODEL",
                                "# IMAGE_ID QW QX", "# POINT3D_ID X Y"});
}

// Whether bytes begin with a count that fits records of 24 bytes or more. cameras.bin, images.bin and points3D.bin have
// no magic number.
bool is_colmap_binary(std::string_view bytes, std::uintmax_t size, const fs::path& name) {
  constexpr std::uint64_t kSmallestRecord = 24;
  std::uint64_t count = 0;
  if (name.extension() != ".bin" || bytes.size() < sizeof(count)) return false;
  std::memcpy(&count, bytes.data(), sizeof(count));
  return count <= (size - sizeof(count)) / kSmallestRecord;
}

FileContent content_of_text(std::string_view text, const fs::path& name) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return FileContent::text;
  text.remove_prefix(begin);
  if (begins_with_any(text, {"<!doctype html", "<!DOCTYPE html", "<html"})) return FileContent::page;
  if (name.extension() == ".md") return FileContent::page;
  if (text.front() == '<' && text.find("<svg") != std::string_view::npos) return FileContent::svg;
  if (text.front() == '{' || text.front() == '[') return FileContent::json;
  if (is_colmap_text(text)) return FileContent::colmap_model;
  const std::string_view entry = first_entry(text);
  if (is_pose(entry)) return FileContent::trajectory;
  if (is_field(entry)) return FileContent::yaml;
  return entry.find(',') == std::string_view::npos ? FileContent::text : FileContent::table;
}

// bytes: the first bytes. size: of the whole file.
FileContent content_of_beginning(std::string_view bytes, std::uintmax_t size, const fs::path& name) {
  if (bytes.empty()) return FileContent::nothing;
  if (bytes.starts_with("\x89"
                        "BYRE\r\n"))
    return FileContent::map;
  if (bytes.starts_with("byrevoc\n")) return FileContent::vocabulary;
  if (bytes.starts_with("\x89PNG\r\n")) return FileContent::png;
  if (bytes.starts_with("P5\n")) return FileContent::pgm;
  if (begins_with_any(bytes, {"\xff\xd8\xff", {"II*\0", 4}, {"MM\0*", 4}})) return FileContent::photograph;
  if (bytes.starts_with("\x89MCAP0\r\n")) return FileContent::mcap;
  if (bytes.starts_with("ply\n")) return FileContent::point_cloud;
  if (bytes.substr(std::min<std::size_t>(4, bytes.size())).starts_with("ftyp")) return FileContent::video;
  if (is_colmap_binary(bytes, size, name)) return FileContent::colmap_model;
  return is_text(bytes) ? content_of_text(bytes, name) : FileContent::other;
}

}  // namespace

std::string_view name_of(FileContent content) {
  return name_among<FileContent::other>(
      {"empty file", "map", "vocabulary", "PNG picture", "PGM picture", "JPEG or TIFF picture", "video", "point cloud",
       "MCAP file", "SVG picture", "JSON file", "trajectory", "YAML file", "table of comma-separated values",
       "file of a COLMAP model", "HTML or Markdown page", "text file", "file of this kind"},
      content);
}

FileContent content_of(std::span<const std::byte> bytes, const fs::path& name) {
  const auto* const begin = reinterpret_cast<const char*>(bytes.data());
  return content_of_beginning({begin, std::min(bytes.size(), kProbeBytes)}, bytes.size(), name);
}

std::optional<FileContent> content_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  const std::uintmax_t size = fs::file_size(path, error);
  return error ? std::nullopt : std::optional(content_of_beginning(first_bytes(file), size, path));
}

bool may_replace(FileContent there, FileContent written) {
  return there == FileContent::nothing || (there == written && written != FileContent::other);
}

}  // namespace byre
