#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// A table as spreadsheets write them: a line that names the columns, then a line for each row, separated by commas.
// Cells hold no commas themselves.
struct CsvTable {
  struct Row {
    int line = 0;  // number of the line as an editor counts, from 1
    std::vector<std::string> cells;
  };

  std::filesystem::path path;
  std::vector<std::string> columns;
  std::vector<Row> rows;

  // Empty where there is no such column, or nothing in it.
  std::optional<std::string_view> find(const Row& row, std::string_view column) const;

  // "file:line", as InputError names a place.
  std::string place_of(const Row& row) const;
};

// The first line that is not blank names the columns, with or without a "#" before it; later lines that begin with "#"
// are comments. Throws InputError when the file cannot be read, a column is not among those known or comes twice, or a
// row has another number of cells than there are columns.
CsvTable read_csv_table(const std::filesystem::path& path, const std::vector<std::string_view>& known_columns);

}  // namespace byre
