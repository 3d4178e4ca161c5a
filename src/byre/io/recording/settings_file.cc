#include "byre/io/recording/settings_file.h"

#include "byre/input_error.h"
#include "byre/io/calibration/yaml_mapping.h"

#include <algorithm>

#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::string place_of_line(const fs::path& path, int line) {
  return path.string() + ":" + std::to_string(line);
}

int line_of(const YAML::Node& node) {
  return node.Mark().line + 1;
}

// depth: number of enclosing groups. With YAML's aliases a group may contain itself.
void append_settings(const YAML::Node& group, const std::string& prefix, int depth, const fs::path& path,
                     std::vector<Setting>& settings) {
  constexpr int kDeepest = 8;
  for (const auto& entry : group) {
    const int line = line_of(entry.first);
    if (!entry.first.IsScalar()) throw InputError(place_of_line(path, line), "has no name", "write NAME: VALUE");
    const std::string name = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      if (depth == kDeepest) throw InputError(place_of_line(path, line), "is nested too deeply", "use fewer groups");
      append_settings(entry.second, name + ".", depth + 1, path, settings);
    } else if (entry.second.IsSequence()) {
      throw InputError(place_of_line(path, line), name + " is a list", "give one value");
    } else if (std::ranges::find(settings, name, &Setting::name) != settings.end()) {
      throw InputError(place_of_line(path, line), name + " is given twice", "give it once");
    } else {
      settings.push_back({name, entry.second.IsNull() ? "" : entry.second.Scalar(), line});
    }
  }
}

}  // namespace

std::vector<Setting> read_settings(const fs::path& path) {
  const YAML::Node root = load_yaml(path);
  std::vector<Setting> settings;
  if (root.IsNull()) return settings;
  if (!root.IsMap()) throw InputError(path.string(), "is not a YAML mapping of named fields", "write NAME: VALUE");
  append_settings(root, "", 0, path, settings);
  return settings;
}

}  // namespace byre
