#include "byre/io/bag/rosbag2_metadata.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <system_error>

#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sibling_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unreadable;
    if (has_rosbag2_name(entry->path()) && entry->is_regular_file(unreadable)) files.push_back(entry->path());
  }
  // Recorders number the files; "bag_10" sorts after "bag_9".
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    const std::string name = a.filename().string(), other = b.filename().string();
    return name.size() != other.size() ? name.size() < other.size() : name < other;
  });
  return files;
}

// Path relative to the folder; the first versions prefix the folder's own name.
fs::path resolve_file(const fs::path& folder, const fs::path& named) {
  const std::array<fs::path, 2> places = {folder / named, folder / named.filename()};
  std::error_code error;
  return fs::exists(places[0], error) || !fs::exists(places[1], error) ? places[0] : places[1];
}

// The files of metadata.yaml without duplicates, with a warning about these.
Rosbag2Files listed_files(const fs::path& metadata) {
  const YAML::Node bag = YAML::LoadFile(metadata.string())[kRosbag2Key];
  Rosbag2Files named;
  std::set<fs::path> known;
  int repeated = 0;
  for (const YAML::Node& file : bag["relative_file_paths"]) {
    fs::path path = resolve_file(metadata.parent_path(), file.as<std::string>());
    std::error_code error;
    const bool is_new = known.insert(fs::weakly_canonical(path, error)).second;
    if (is_new || error) {
      named.files.push_back(std::move(path));
    } else {
      ++repeated;
    }
  }
  if (repeated > 0) {
    named.warnings.push_back(metadata.string() + ": has " + std::to_string(repeated) +
                             " duplicate file names; each file is read once");
  }
  return named;
}

}  // namespace

bool has_rosbag2_name(const fs::path& file) {
  constexpr std::array<std::string_view, 4> kEndings = {".mcap", ".db3", ".mcap.zstd", ".db3.zstd"};
  const std::string name = file.filename().string();
  return std::ranges::any_of(kEndings, [&](std::string_view ending) { return name.ends_with(ending); });
}

Rosbag2Files rosbag2_files(const fs::path& folder) {
  const fs::path metadata = folder / kRosbag2Metadata;
  std::error_code error;
  std::string why;
  if (!fs::is_regular_file(metadata, error)) {
    why = "is missing, as after a killed recorder";
  } else {
    try {
      Rosbag2Files named = listed_files(metadata);
      if (!named.files.empty()) return named;
      why = "lists no files";
    } catch (const YAML::Exception& exception) {
      why = std::string("cannot be parsed (") + exception.what() + ")";
    }
  }
  return {sibling_files(folder), {metadata.string() + ": " + why + "; bag files in its folder are used"}};
}

}  // namespace byre
