#include "byre/base/printable.h"

#include "byre/base/report_row.h"
#include "byre/input_error.h"

#include <string>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using std::string_literals::operator""s;

TEST(Printable, LeavesUtf8Unchanged) {
  for (const char* text : {"", "barn.byre", "Stall 3: Kühe, 牛 🐄", "back\\slash 'quoted'"}) {
    EXPECT_EQ(printable(text), text);
  }
}

TEST(Printable, EscapesControlCharacters) {
  EXPECT_EQ(printable("save\n<3>fake\r\t"), "save\\n<3>fake\\r\\t");
  EXPECT_EQ(printable("\x1b[31mred\x1b]0;title\a"), "\\x1b[31mred\\x1b]0;title\\x07");
  EXPECT_EQ(printable("a\0b\x7f"s), "a\\x00b\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J");  // U+009B, the eight-bit form of ESC [
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "gnp.exe"),
            "\\xe2\\x80\\xaegnp.exe");  // U+202E, right-to-left override
  EXPECT_EQ(printable("a\xe2\x80\xa8"
                      "b"),
            "a\\xe2\\x80\\xa8"
            "b");  // U+2028, line separator
}

TEST(Printable, EscapesInvalidUtf8) {
  EXPECT_EQ(printable("K\xfche"), "K\\xfche");                       // Latin 1
  EXPECT_EQ(printable("\xff\xfe\x41"), "\\xff\\xfeA");               // UTF-16
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");                    // overlong
  EXPECT_EQ(printable("\xe0\x80\xaf"), "\\xe0\\x80\\xaf");           // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(printable("\xe7\x89"), "\\xe7\\x89");                    // truncated
}

TEST(Printable, CutsLongText) {
  EXPECT_EQ(printable(std::string(1000, 'a'), 5), "aaaaa...");
  EXPECT_EQ(printable("aaaaa", 5), "aaaaa");
}

TEST(Printable, IsIdempotentForAnyByte) {
  for (int byte = 0; byte < 256; ++byte) {
    const std::string once = printable("a"s + static_cast<char>(byte) + "b");
    for (const char each : once) EXPECT_TRUE(each >= 0x20 && each < 0x7f) << byte;
    EXPECT_EQ(printable(once), once);
  }
}

// U+0080 to U+009F: terminals may read them as ESC and a letter.
std::vector<std::string> c1_controls() {
  std::vector<std::string> controls;
  for (int code = 0x80; code < 0xA0; ++code) controls.push_back("\xc2"s + static_cast<char>(code));
  return controls;
}

TEST(Printable, EscapesAllC1Controls) {
  for (const std::string& control : c1_controls()) {
    const auto number = static_cast<unsigned>(static_cast<unsigned char>(control[1]));
    EXPECT_EQ(printable("a" + control + "b"), fmt::format("a\\xc2\\x{:02x}b", number));
    EXPECT_EQ(printable_lines("a\n" + control + "b\n"), fmt::format("a\n\\xc2\\x{:02x}b\n", number));
    EXPECT_EQ(printable_json("{\"a\": \"" + control + "\"}\n"), fmt::format("{{\"a\": \"\\u{:04x}\"}}\n", number));
  }
}

TEST(PrintableLines, KeepsOnlyLineFeeds) {
  EXPECT_EQ(printable_lines("# Speed of Kühe\n\n\x1b[2J\r\xff\n"), "# Speed of Kühe\n\n\\x1b[2J\\r\\xff\n");
}

TEST(PrintableJson, EscapesLikeJson) {
  const std::string json = "{\n  \"topic\": \"/Kühe/牛 🐄 \\u001b\"\n}\n";
  EXPECT_EQ(printable_json(json), json);
  EXPECT_EQ(printable_json("[\"\x7f\xe2\x80\xae\xe2\x80\xa8\xef\xbb\xbf\"]"), R"(["\u007f\u202e\u2028\ufeff"])");
}

TEST(InputError, HasPrintablePlaceReasonAndRemedy) {
  const InputError error("walk\x1b[2J.bag", "has the topic '/a\n/b'", "rename\t\xff it");
  EXPECT_EQ(error.place(), "walk\\x1b[2J.bag");
  EXPECT_EQ(error.reason(), "has the topic '/a\\n/b'");
  EXPECT_EQ(error.remedy(), "rename\\t\\xff it");
  EXPECT_STREQ(error.what(), "walk\\x1b[2J.bag: has the topic '/a\\n/b' (rename\\t\\xff it)");
}

TEST(ReportRow, IsOneLineOfPrintableText) {
  EXPECT_EQ(row("map", "barn\n\x1b[2Jfake"), "map          barn\\n\\x1b[2Jfake\n");
}

}  // namespace
}  // namespace byre
