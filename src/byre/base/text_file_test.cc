#include "byre/base/text_file.h"

#include "byre/input_error.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono::nanoseconds;
using testing::ElementsAre;

std::filesystem::path written(const std::string& name, const std::string& content) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

TEST(ParseSeconds, KeepsNanosecondsOfEpochTimes) {
  EXPECT_EQ(parse_seconds("1403636584.763555584"), nanoseconds(1403636584763555584));
  EXPECT_EQ(parse_seconds("1.403636584763555584e+09"), nanoseconds(1403636584763555584));
}

TEST(ParseSeconds, AcceptsShortAndScientificNotation) {
  EXPECT_EQ(parse_seconds("2"), nanoseconds(2'000'000'000));
  EXPECT_EQ(parse_seconds("2."), nanoseconds(2'000'000'000));
  EXPECT_EQ(parse_seconds(".5"), nanoseconds(500'000'000));
  EXPECT_EQ(parse_seconds("1.037000e-01"), nanoseconds(103'700'000));
  EXPECT_EQ(parse_seconds("-0.0075"), nanoseconds(-7'500'000));
  EXPECT_EQ(parse_seconds("0.000000e+00"), nanoseconds(0));
}

TEST(ParseSeconds, RoundsToTheNanosecond) {
  EXPECT_EQ(parse_seconds("0.0000000014"), nanoseconds(1));
  EXPECT_EQ(parse_seconds("0.0000000015"), nanoseconds(2));
  EXPECT_EQ(parse_seconds("-0.0000000015"), nanoseconds(-2));
  EXPECT_EQ(parse_seconds("1e-20"), nanoseconds(0));
}

TEST(ParseSeconds, RejectsInvalidTimes) {
  for (const char* const text :
       {"", "-", ".", "1.2.3", "abc", "1e", "1e99", "nan", "inf", "99999999999", "1 2", "--1"}) {
    EXPECT_FALSE(parse_seconds(text).has_value()) << text;
  }
}

TEST(ParseNumber, RejectsTrailingTextAndNonFiniteNumbers) {
  EXPECT_EQ(parse_number("+1.5e-3"), 1.5e-3);
  for (const char* const text : {"", "1.5m", "nan", "inf", "1e999", "+-1", "0x10"}) {
    EXPECT_FALSE(parse_number(text).has_value()) << text;
  }
}

TEST(SplitFields, SplitsAtCommasOrWhiteSpace) {
  EXPECT_THAT(split_fields("1, 2 ,3"), ElementsAre("1", "2", "3"));
  EXPECT_THAT(split_fields("1  2\t3"), ElementsAre("1", "2", "3"));
  EXPECT_THAT(split_fields("1,,3"), ElementsAre("1", "", "3"));
}

TEST(ReadLines, SkipsCommentsAndBlankLinesButCountsThem) {
  const std::vector<TextLine> lines = read_lines(written("lines.txt", "# head\r\n\r\n  1 2 \r\n\n3"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].number, 3);
  EXPECT_EQ(lines[0].text, "1 2");
  EXPECT_EQ(lines[1].number, 5);
  EXPECT_EQ(lines[1].text, "3");
}

TEST(ReadLines, SkipsTheByteOrderMark) {
  EXPECT_EQ(read_lines(written("marked.txt",
                               "\xEF\xBB\xBF"
                               "1 2\n3\n"))
                .front()
                .text,
            "1 2");
  EXPECT_EQ(read_lines(written("marked.txt", "\xEF\xBB\xBF# head\n3\n")).front().text, "3");
}

TEST(ReadLines, ReportsAMissingFile) {
  try {
    read_lines("/nowhere/poses.txt");
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "/nowhere/poses.txt");
  }
  EXPECT_THROW(read_lines(testing::TempDir()), InputError);
}

}  // namespace
}  // namespace byre
