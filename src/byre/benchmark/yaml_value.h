#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace byre {

// A value in a YAML file that knows where it stands, so that whatever is wrong with it is an InputError with the place
// "FILE:LINE".
class YamlValue {
 public:
  // The whole file: named fields. Throws InputError when it cannot be read, is no YAML, or is something else.
  static YamlValue load(const std::filesystem::path& path);

  // Each throws InputError when the value is of another kind, or outside the limits, which are included.
  std::string text() const;
  double number(double least, double most) const;
  int whole_number(int least, int most) const;
  std::vector<YamlValue> entries() const;                        // entries of a list that is not empty
  std::vector<std::pair<YamlValue, YamlValue>> fields() const;   // names and values, as they stand in the file
  YamlValue operator[](const std::string& name) const;           // value of a field that must be there
  std::optional<YamlValue> find(const std::string& name) const;  // value of a field that may be missing

  // Throws InputError for a field that is none of these, and for one that is given twice.
  void require_fields(std::initializer_list<std::string_view> names) const;

  [[noreturn]] void fail(const std::string& reason, const std::string& remedy) const;

 private:
  YamlValue(std::filesystem::path path, YAML::Node node) : path_(std::move(path)), node_(std::move(node)) {}

  std::filesystem::path path_;
  YAML::Node node_;
};

}  // namespace byre
