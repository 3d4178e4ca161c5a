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

// A YAML value with its position, so that errors in it are InputErrors at "FILE:LINE".
class YamlValue {
 public:
  // Loads a file of named fields. Throws InputError if it cannot be read or is not of this form.
  static YamlValue load(const std::filesystem::path& path);

  // Each throws InputError if the value is of another kind or outside the inclusive limits.
  std::string text() const;
  double number(double min_value, double max_value) const;
  int whole_number(int min_value, int max_value) const;
  std::vector<YamlValue> entries() const;                       // entries of a list, not empty
  std::vector<std::pair<YamlValue, YamlValue>> fields() const;  // names and values in file order
  YamlValue operator[](const std::string& name) const;          // value of a required field
  std::optional<YamlValue> find(const std::string& name) const;

  // Throws InputError for a field not among names, or given twice.
  void require_fields(std::initializer_list<std::string_view> names) const;

  [[noreturn]] void fail(const std::string& reason, const std::string& remedy) const;

 private:
  YamlValue(std::filesystem::path path, YAML::Node node) : path_(std::move(path)), node_(std::move(node)) {}

  std::filesystem::path path_;
  YAML::Node node_;
};

}  // namespace byre
