#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Numbers with names, as text: "name number number; name number ...". Numbers are read back without rounding.
class NumbersByName {
 public:
  NumbersByName() = default;
  explicit NumbersByName(std::string_view text);

  void add(const std::string& name, std::span<const double> values);
  void add(const std::string& name, double value) { add(name, std::span(&value, 1)); }
  const std::string& text() const { return text_; }

  // Copies the numbers to values; false unless the counts match.
  bool get(const std::string& name, std::span<double> values) const;
  bool get(const std::string& name, double& value) const { return get(name, std::span(&value, 1)); }

 private:
  void take(std::string_view part);

  std::string text_;
  std::map<std::string, std::vector<double>> numbers_;
};

}  // namespace byre
