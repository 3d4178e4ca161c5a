#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace byre {

inline constexpr const char* kEmptyCell = "–";  // cell without a figure

// A Markdown table with padded columns, readable as plain text. Empty columns are left out.
class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> titles) : titles_(std::move(titles)) {}

  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  std::string text() const;  // empty without rows

 private:
  bool is_used(std::size_t column) const;
  std::size_t width(std::size_t column) const;
  std::string line(const std::vector<std::string>& cells) const;

  std::vector<std::string> titles_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace byre
