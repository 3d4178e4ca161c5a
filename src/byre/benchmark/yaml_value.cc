#include "byre/benchmark/yaml_value.h"

#include "byre/base/regular_file.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <fmt/core.h>

namespace byre {

namespace fs = std::filesystem;

YamlValue YamlValue::load(const fs::path& path) {
  refuse_pipe(path);
  std::ifstream file(path);
  if (!file || fs::is_directory(path)) {
    throw InputError(path.string(), "cannot be opened", "check that it exists and is readable");
  }
  try {
    const YamlValue root(path, YAML::Load(file));
    if (!root.node_.IsMap()) throw InputError(path.string(), "is not a YAML mapping");
    return root;
  } catch (const YAML::Exception& error) {
    throw InputError(path.string() + ":" + std::to_string(error.mark.line + 1), error.msg, "correct the YAML");
  }
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty()) fail("is not a text", "give a word or a quoted text");
  return node_.Scalar();
}

double YamlValue::number(double min_value, double max_value) const {
  const std::optional<double> value = node_.IsScalar() ? parse_number(node_.Scalar()) : std::nullopt;
  if (value && *value >= min_value && *value <= max_value) return *value;
  fail(fmt::format("is not a number from {:g} to {:g}", min_value, max_value), "give a number in this range");
}

int YamlValue::whole_number(int min_value, int max_value) const {
  const double value = number(min_value, max_value);
  if (value != std::floor(value)) fail("is not an integer", "give a number without fraction");
  return static_cast<int>(value);
}

std::vector<YamlValue> YamlValue::entries() const {
  if (!node_.IsSequence() || node_.size() == 0) fail("is not a list, or is empty", "give at least one entry");
  std::vector<YamlValue> entries;
  for (const YAML::Node& entry : node_) entries.push_back({path_, entry});
  return entries;
}

std::vector<std::pair<YamlValue, YamlValue>> YamlValue::fields() const {
  if (!node_.IsMap()) fail("is not a mapping", "give fields as \"name: value\"");
  std::vector<std::pair<YamlValue, YamlValue>> fields;
  for (const auto& field : node_) fields.push_back({YamlValue(path_, field.first), YamlValue(path_, field.second)});
  return fields;
}

YamlValue YamlValue::operator[](const std::string& name) const {
  const std::optional<YamlValue> value = find(name);
  if (!value) fail("\"" + name + "\" is missing", "add it");
  return *value;
}

std::optional<YamlValue> YamlValue::find(const std::string& name) const {
  const YAML::Node value = node_[name];
  if (!value) return std::nullopt;
  return YamlValue(path_, value);
}

void YamlValue::require_fields(std::initializer_list<std::string_view> names) const {
  std::set<std::string> seen;
  for (const auto& [name, value] : fields()) {
    const std::string text = name.text();
    if (std::ranges::find(names, text) == names.end()) {
      std::string known;
      for (const std::string_view candidate : names) known += (known.empty() ? "" : ", ") + std::string(candidate);
      name.fail("unknown field \"" + text + "\"", "fields: " + known);
    }
    if (!seen.insert(text).second) name.fail("\"" + text + "\" is given twice", "give it once");
  }
}

void YamlValue::fail(const std::string& reason, const std::string& remedy) const {
  throw InputError(path_.string() + ":" + std::to_string(node_.Mark().line + 1), reason, remedy);
}

}  // namespace byre
