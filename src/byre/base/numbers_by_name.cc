#include "byre/base/numbers_by_name.h"

#include "byre/base/text_file.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace byre {
namespace {

std::string text_of(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace

NumbersByName::NumbersByName(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find(';');
    take(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
}

void NumbersByName::add(const std::string& name, std::span<const double> values) {
  text_ += (text_.empty() ? "" : "; ") + name;
  for (const double value : values) text_ += " " + text_of(value);
}

bool NumbersByName::get(const std::string& name, std::span<double> values) const {
  const auto found = numbers_.find(name);
  if (found == numbers_.end() || found->second.size() != values.size()) return false;
  std::ranges::copy(found->second, values.begin());
  return true;
}

void NumbersByName::take(std::string_view part) {
  const std::vector<std::string_view> fields = split_fields(part);
  if (fields.empty()) return;
  std::vector<double>& numbers = numbers_[std::string(fields.front())];
  for (std::size_t i = 1; i < fields.size(); ++i) {
    if (const auto number = parse_number(fields[i])) numbers.push_back(*number);
  }
}

}  // namespace byre
