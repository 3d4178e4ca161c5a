#pragma once

#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Lines and values of text files, such as trajectories, time stamps and calibrations.

struct TextLine {
  int number = 0;    // from 1
  std::string text;  // text of the line without white space at its ends
};

// The lines without blank ones and comments ("#..."). Line ends may be LF or CRLF; a byte order mark is skipped. Throws
// InputError if the file cannot be read.
std::vector<TextLine> read_lines(const std::filesystem::path& path);

// Removes the byte order mark with which Windows editors and spreadsheets begin UTF-8 files. first_line: of a file.
void skip_byte_order_mark(std::string& first_line);

// Throws InputError for a folder, a pipe and a file that cannot be opened.
std::ifstream open_text_file(const std::filesystem::path& path);

// Place for an InputError: "file:line".
std::string place_of(const std::filesystem::path& path, const TextLine& line);

// The text with ASCII letters in lower case.
std::string lower_case(std::string_view text);

// The fields of a line, separated by a comma or by white space. Views into the text.
std::vector<std::string_view> split_fields(std::string_view text);

// Empty unless the whole text is one number in the notation of std::from_chars.
template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

// Empty unless the whole text is one finite number.
std::optional<double> parse_number(std::string_view text);

// Seconds as a decimal number ("1403636584.763555584", "1.037e-01"), exact to the nanosecond, unlike a double.
std::optional<std::chrono::nanoseconds> parse_seconds(std::string_view text);
std::optional<std::chrono::nanoseconds> parse_nanoseconds(std::string_view text);  // a whole number

}  // namespace byre
