#include "byre/dataset/file_content.h"

#include "byre/input/text_file.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>
#include <string_view>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::string first_bytes(std::ifstream& file) {
  constexpr std::size_t kEnough = 4096;
  std::string bytes(kEnough, '\0');
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

// The first line that says something, or the comment above it where there is nothing else.
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

// In TUM's, EuRoC's or KITTI's format.
bool is_pose(std::string_view line) {
  if (line.starts_with("# timestamp tx ty tz") || line.starts_with("#timestamp [ns],p_RS_R_x"))
    return true;  // no poses
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

FileContent content_of_text(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return FileContent::text;
  text.remove_prefix(begin);
  if (text.front() == '<' && text.find("<svg") != std::string_view::npos) return FileContent::svg;
  if (text.front() == '{' || text.front() == '[') return FileContent::json;
  const std::string_view entry = first_entry(text);
  if (is_pose(entry)) return FileContent::trajectory;
  if (is_field(entry)) return FileContent::yaml;
  return entry.find(',') == std::string_view::npos ? FileContent::text : FileContent::table;
}

}  // namespace

std::optional<FileContent> content_of(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  const std::string bytes = first_bytes(file);
  if (bytes.empty()) return FileContent::nothing;
  if (bytes.starts_with("\x89"
                        "BYRE\r\n"))
    return FileContent::map;
  if (bytes.starts_with("byrevoc\n")) return FileContent::vocabulary;
  if (bytes.starts_with("\x89PNG\r\n")) return FileContent::png;
  if (bytes.starts_with("\x89MCAP0\r\n")) return FileContent::mcap;
  if (bytes.starts_with("ply\n")) return FileContent::point_cloud;
  if (std::string_view(bytes).substr(std::min<std::size_t>(4, bytes.size())).starts_with("ftyp"))
    return FileContent::video;
  return is_text(bytes) ? content_of_text(bytes) : FileContent::other;
}

}  // namespace byre
