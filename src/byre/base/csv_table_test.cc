#include "byre/base/csv_table.h"

#include "byre/input_error.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

class CsvTables : public testing::Test {
 protected:
  ~CsvTables() override { std::filesystem::remove(path_); }

  CsvTable read(const std::string& content) const {
    std::ofstream(path_, std::ios::binary) << content;
    return read_csv_table(path_, {"name", "x", "y"});
  }

  std::string refusal_of(const std::string& content) const {
    try {
      read(content);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("csv_table_" + std::to_string(getpid()) + ".csv");
};

TEST_F(CsvTables, ReturnCellsByColumnName) {
  const CsvTable table = read("x,name\n1.5,north gate\n-2,\n");
  ASSERT_THAT(table.rows, SizeIs(2));
  EXPECT_EQ(table.find(table.rows[0], "x"), "1.5");
  EXPECT_EQ(table.find(table.rows[0], "name"), "north gate");
  EXPECT_EQ(table.find(table.rows[1], "name"), std::nullopt);
  EXPECT_EQ(table.find(table.rows[1], "y"), std::nullopt);
  EXPECT_EQ(table.place_of(table.rows[1]), path_.string() + ":3");
}

TEST_F(CsvTables, AcceptSpreadsheetFormats) {
  const CsvTable table = read("\xef\xbb\xbf# x, y\r\n\r\n# the first two\r\n1, 2\r\n3,4\r\n");
  EXPECT_THAT(table.columns, ElementsAre("x", "y"));
  ASSERT_THAT(table.rows, SizeIs(2));
  EXPECT_THAT(table.rows[0].cells, ElementsAre("1", "2"));
  EXPECT_THAT(table.rows[1].cells, ElementsAre("3", "4"));
}

TEST_F(CsvTables, ReportPlaceAndRemedyOfErrors) {
  EXPECT_THAT(refusal_of(""), HasSubstr("is empty (write the column names in the first line)"));
  EXPECT_THAT(refusal_of("x,z\n"), HasSubstr(":1: contains the unknown column \"z\" (the columns are name, x, y)"));
  EXPECT_THAT(refusal_of("x,x\n"), HasSubstr(":1: contains the column x twice"));
  EXPECT_THAT(refusal_of("x,name\n1,gate\n2,post, left\n"), HasSubstr(":3: has 3 cells for 2 columns"));
  EXPECT_THROW(read_csv_table("/absent.csv", {"x"}), InputError);
}

}  // namespace
}  // namespace byre
