#include "byre/viewer/legend.h"

#include "byre/viewer/picture_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;

const std::vector<LegendEntry> kThree = {
    {"one", {1, 1, 1}, Symbol::disc}, {"two", {2, 2, 2}, Symbol::cross}, {"three", {3, 3, 3}, {}, Stroke::dashed}};

std::string svg_of(std::vector<PictureMark> marks) {
  return to_svg({100, 100, {{0, 0, 100, 100, {}, std::move(marks)}}});
}

TEST(Legend, UsesMoreRowsIfNarrow) {
  const int row_height = legend(kThree, "", 100).height - legend(kThree, "", 1000).height;
  EXPECT_EQ(row_height, 48);
  EXPECT_EQ(legend(kThree, "a note", 1000).height - legend(kThree, "", 1000).height, 24);
}

TEST(Legend, NamesEverySymbol) {
  const std::string svg = svg_of(legend(kThree, "a note", 400).marks);
  for (const char* const text : {">one<", ">two<", ">three<", ">a note<"}) EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray"));
}

TEST(ScaleBar, HasARoundLength) {
  EXPECT_DOUBLE_EQ(round_length(10.0, 140.0), 10.0);
  EXPECT_DOUBLE_EQ(round_length(20.0, 140.0), 5.0);
  EXPECT_DOUBLE_EQ(round_length(1000.0, 140.0), 0.1);
  EXPECT_DOUBLE_EQ(round_length(0.3, 140.0), 200.0);
}

TEST(ScaleBar, NamesItsUnit) {
  EXPECT_THAT(svg_of(scale_bar({390.0, 20.0}, 20.0, true)), HasSubstr(">5 m<"));
  EXPECT_THAT(svg_of(scale_bar({390.0, 20.0}, 1000.0, true)), HasSubstr(">0.1 m<"));
  EXPECT_THAT(svg_of(scale_bar({390.0, 20.0}, 20.0, false)), HasSubstr(">5 map units<"));
}

}  // namespace
}  // namespace byre
