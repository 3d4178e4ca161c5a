#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// A table in the format of spreadsheets: one line of column names, then one line per row, separated by commas. Cells
// contain no commas.
struct CsvTable {
  struct Row {
    int line = 0;  // from 1
    std::vector<std::string> cells;
  };

  std::filesystem::path path;
  std::vector<std::string> columns;
  std::vector<Row> rows;

  // Empty if the column does not exist, or the cell is empty.
  std::optional<std::string_view> find(const Row& row, std::string_view column) const;

  // Place for an InputError: "file:line".
  std::string place_of(const Row& row) const;
};

// The first line that is not blank has the column names, optionally after a "#"; later lines that begin with "#" are
// comments. Throws InputError if the file cannot be read, a column is unknown or repeated, or a row has another number
// of cells than there are columns.
CsvTable read_csv_table(const std::filesystem::path& path, const std::vector<std::string_view>& known_columns);

}  // namespace byre
