#include "byre/base/csv_table.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <fstream>

namespace byre {
namespace {

std::vector<std::string> cells_of(std::string_view line) {
  const std::vector<std::string_view> fields = split_fields(line);
  return {fields.begin(), fields.end()};
}

std::vector<std::string> names_of_columns(std::string_view line) {
  if (line.starts_with('#')) line.remove_prefix(1);
  return cells_of(line);
}

std::string listing(const std::vector<std::string_view>& names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

void require_known(const std::vector<std::string>& columns, const std::vector<std::string_view>& known,
                   const std::string& place) {
  for (const std::string& column : columns) {
    if (std::ranges::find(known, column) == known.end()) {
      throw InputError(place, "contains the unknown column \"" + column + "\"", "the columns are " + listing(known));
    }
    if (std::ranges::count(columns, column) > 1) throw InputError(place, "contains the column " + column + " twice");
  }
}

void require_cells(const CsvTable& table, const CsvTable::Row& row) {
  if (row.cells.size() == table.columns.size()) return;
  throw InputError(
      table.place_of(row),
      "has " + std::to_string(row.cells.size()) + " cells for " + std::to_string(table.columns.size()) + " columns",
      "separate cells by commas; names must not contain commas");
}

}  // namespace

std::optional<std::string_view> CsvTable::find(const Row& row, std::string_view column) const {
  const auto place = std::ranges::find(columns, column);
  if (place == columns.end()) return std::nullopt;
  const std::string& cell = row.cells[static_cast<std::size_t>(place - columns.begin())];
  return cell.empty() ? std::nullopt : std::optional<std::string_view>(cell);
}

std::string CsvTable::place_of(const Row& row) const {
  return path.string() + ":" + std::to_string(row.line);
}

CsvTable read_csv_table(const std::filesystem::path& path, const std::vector<std::string_view>& known_columns) {
  std::ifstream file = open_text_file(path);
  CsvTable table{path, {}, {}};
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (number == 1) skip_byte_order_mark(line);
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (table.columns.empty()) {
      table.columns = names_of_columns(line);
      require_known(table.columns, known_columns, path.string() + ":" + std::to_string(number));
    } else if (!line.starts_with('#')) {
      table.rows.push_back({number, cells_of(line)});
      require_cells(table, table.rows.back());
    }
  }
  if (file.bad()) throw InputError(path.string(), "cannot be read", "check the disk");
  if (table.columns.empty()) throw InputError(path.string(), "is empty", "write the column names in the first line");
  return table;
}

}  // namespace byre
