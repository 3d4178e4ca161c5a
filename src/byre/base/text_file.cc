#include "byre/base/text_file.h"

#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace byre {
namespace {

constexpr std::string_view kWhiteSpace = " \t\r\v\f";
constexpr int kNanosecondDigits = 9;
constexpr int kMaxExponent = 30;

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kWhiteSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kWhiteSpace) - begin + 1);
}

// std::from_chars rejects a leading plus sign.
std::string_view without_plus(std::string_view text) {
  return text.starts_with('+') && !text.starts_with("+-") ? text.substr(1) : text;
}

// The value of one digit at a decimal place, 0 for units; empty if it overflows 64 bits.
std::optional<std::int64_t> value_of_digit(char digit, int place) {
  if (digit < '0' || digit > '9') return std::nullopt;
  std::int64_t value = digit - '0';
  if (place > 18 || (place == 18 && value > 8)) return value == 0 ? std::optional<std::int64_t>(0) : std::nullopt;
  if (place < 0) return place == -1 && value >= 5 ? 1 : 0;  // rounds half away from zero
  for (int i = 0; i < place; ++i) value *= 10;
  return value;
}

// Splits "1.5e-3" into "1.5" and -3; the exponent is 0 if there is none.
std::optional<std::pair<std::string, int>> split_exponent(std::string_view text) {
  const std::size_t e = text.find_first_of("eE");
  if (e == std::string_view::npos) return std::pair(std::string(text), 0);
  const std::optional<int> exponent = parse_whole<int>(without_plus(text.substr(e + 1)));
  if (!exponent || std::abs(*exponent) > kMaxExponent) return std::nullopt;
  return std::pair(std::string(text.substr(0, e)), *exponent);
}

}  // namespace

std::ifstream open_text_file(const std::filesystem::path& path) {
  refuse_pipe(path);
  if (std::filesystem::is_directory(path)) throw InputError(path.string(), "is a folder", "give a file");
  std::ifstream file(path);
  if (!file) throw InputError(path.string(), "cannot be opened", "check that it exists and is readable");
  return file;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char letter) { return std::tolower(letter); });
  return lower;
}

std::vector<TextLine> read_lines(const std::filesystem::path& path) {
  std::ifstream file = open_text_file(path);
  std::vector<TextLine> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (number == 1) skip_byte_order_mark(text);
    const std::string_view content = trimmed(text);
    if (!content.empty() && content.front() != '#') lines.push_back({number, std::string(content)});
  }
  if (file.bad()) throw InputError(path.string(), "cannot be read", "check the disk");
  return lines;
}

void skip_byte_order_mark(std::string& first_line) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (first_line.starts_with(kByteOrderMark)) first_line.erase(0, kByteOrderMark.size());
}

std::string place_of(const std::filesystem::path& path, const TextLine& line) {
  return path.string() + ":" + std::to_string(line.number);
}

std::vector<std::string_view> split_fields(std::string_view text) {
  const bool has_commas = text.find(',') != std::string_view::npos;
  const std::string_view separators = has_commas ? "," : kWhiteSpace;
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = text.find_first_of(separators);
    const std::string_view field = trimmed(text.substr(0, end));
    if (has_commas || !field.empty()) fields.push_back(field);
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(without_plus(text));
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::chrono::nanoseconds> parse_seconds(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  std::optional<std::pair<std::string, int>> number = split_exponent(text);
  if (!number) return std::nullopt;
  auto& [digits, exponent] = *number;
  const std::size_t point = std::min(digits.find('.'), digits.size());
  if (point < digits.size()) digits.erase(point, 1);
  if (digits.empty()) return std::nullopt;

  int place = static_cast<int>(point) - 1 + exponent + kNanosecondDigits;
  std::int64_t nanoseconds = 0;
  for (const char digit : digits) {
    const std::optional<std::int64_t> value = value_of_digit(digit, place--);
    if (!value) return std::nullopt;
    nanoseconds += *value;
  }
  return std::chrono::nanoseconds(negative ? -nanoseconds : nanoseconds);
}

std::optional<std::chrono::nanoseconds> parse_nanoseconds(std::string_view text) {
  const std::optional<std::int64_t> count = parse_whole<std::int64_t>(without_plus(text));
  if (!count) return std::nullopt;
  return std::chrono::nanoseconds(*count);
}

}  // namespace byre
