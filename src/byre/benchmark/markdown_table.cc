#include "byre/benchmark/markdown_table.h"

#include <algorithm>
#include <string_view>

namespace byre {
namespace {

// Number of UTF-8 characters.
std::size_t shown_length(std::string_view text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xc0U) != 0x80U; }));
}

}  // namespace

std::string MarkdownTable::text() const {
  if (rows_.empty()) return "";
  std::string separator = "|";
  for (std::size_t i = 0; i < titles_.size(); ++i) {
    if (is_used(i)) separator += std::string(width(i) + 2, '-') + "|";
  }
  std::string text = line(titles_) + separator + "\n";
  for (const std::vector<std::string>& row : rows_) text += line(row);
  return text;
}

bool MarkdownTable::is_used(std::size_t column) const {
  return std::ranges::any_of(rows_, [column](const auto& row) { return row[column] != kEmptyCell; });
}

std::size_t MarkdownTable::width(std::size_t column) const {
  std::size_t most = shown_length(titles_[column]);
  for (const std::vector<std::string>& row : rows_) most = std::max(most, shown_length(row[column]));
  return most;
}

std::string MarkdownTable::line(const std::vector<std::string>& cells) const {
  std::string text = "|";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (is_used(i)) text += " " + cells[i] + std::string(width(i) - shown_length(cells[i]), ' ') + " |";
  }
  return text + "\n";
}

}  // namespace byre
