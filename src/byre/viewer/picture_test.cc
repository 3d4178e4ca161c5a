#include "byre/viewer/picture.h"

#include "byre/viewer/picture_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr Colour kWhite{255, 255, 255}, kRed{200, 0, 0}, kBlue{0, 0, 200};

Picture picture_of(std::vector<PictureMark> marks, int width = 100, int height = 80) {
  Picture picture{width, height, {}};
  picture.panes.push_back({0, 0, width, height, kWhite, std::move(marks)});
  return picture;
}

cv::Mat drawn(const std::vector<PictureMark>& marks) {
  return decoded(to_png(picture_of(marks)));
}

PictureSymbols symbols(Symbol symbol, std::vector<Eigen::Vector2d> centres) {
  PictureSymbols result;
  result.name = "things";
  result.symbol = symbol;
  result.centres = std::move(centres);
  result.size = 12.0;
  result.colour = kRed;
  return result;
}

TEST(Picture, HasItsSizeAndBackground) {
  const cv::Mat empty = drawn({});
  EXPECT_EQ(empty.size(), cv::Size(100, 80));
  EXPECT_EQ(colour_at(empty, 50, 40), kWhite);
}

TEST(Picture, FillsOnlyTheAreaOfASymbol) {
  for (const Symbol symbol : {Symbol::disc, Symbol::square, Symbol::diamond, Symbol::triangle}) {
    const cv::Mat filled = drawn({symbols(symbol, {{30.5, 20.5}})});
    EXPECT_EQ(colour_at(filled, 30, 20), kRed) << static_cast<int>(symbol);
    EXPECT_EQ(colour_at(filled, 30, 31), kWhite);
    EXPECT_EQ(colour_at(filled, 20, 30), kWhite);
  }
}

TEST(Picture, DrawsCrossesAlongDiagonals) {
  const cv::Mat crossed = drawn({symbols(Symbol::cross, {{30.5, 20.5}})});
  EXPECT_EQ(colour_at(crossed, 33, 23), kRed);
  EXPECT_EQ(colour_at(crossed, 27, 23), kRed);
  EXPECT_EQ(colour_at(crossed, 35, 20), kWhite);
  const cv::Mat plus = drawn({symbols(Symbol::plus, {{30.5, 20.5}})});
  EXPECT_EQ(colour_at(plus, 35, 20), kRed);
  EXPECT_EQ(colour_at(plus, 34, 24), kWhite);
}

TEST(Picture, DrawsARimAroundASymbol) {
  PictureSymbols mark = symbols(Symbol::disc, {{30.5, 20.5}});
  mark.rim = kBlue;
  const cv::Mat rimmed = drawn({mark});
  EXPECT_EQ(colour_at(rimmed, 30, 20), kRed);
  EXPECT_GT(colour_at(rimmed, 30, 27).blue, 100);
  EXPECT_LT(colour_at(rimmed, 30, 27).red, 160);
}

TEST(Picture, BlendsTransparentMarks) {
  const PictureArea area{{{10.0, 10.0}, {60.0, 10.0}, {60.0, 60.0}, {10.0, 60.0}}, {0, 0, 0}, 0.5};
  EXPECT_NEAR(colour_at(drawn({area}), 30, 30).green, 128, 1);
  EXPECT_EQ(colour_at(drawn({area}), 70, 30), kWhite);
}

TEST(Picture, LeavesGapsInDashedAndDottedLines) {
  const auto red_columns = [](Stroke stroke) {
    const cv::Mat line = drawn({PictureLine{{{5.0, 40.5}, {95.0, 40.5}}, kRed, 3.0, stroke}});
    int count = 0;
    for (int x = 5; x < 95; ++x) count += colour_at(line, x, 40).green < 128 ? 1 : 0;
    return count;
  };
  EXPECT_EQ(red_columns(Stroke::solid), 90);
  EXPECT_NEAR(red_columns(Stroke::dashed), 90.0 * 2.5 / 4.5, 10.0);
  EXPECT_NEAR(red_columns(Stroke::dotted), 50, 15);
}

TEST(Picture, DrawsLinesWithTheirWidth) {
  for (const double width : {1.0, 2.5, 4.0}) {
    const cv::Mat line = drawn({PictureLine{{{5.0, 40.0}, {95.0, 40.0}}, {0, 0, 0}, width}});
    double ink = 0.0;
    for (int y = 0; y < 80; ++y) ink += (255.0 - colour_at(line, 50, y).red) / 255.0;
    EXPECT_NEAR(ink, width, 0.4);
  }
}

TEST(Picture, ShowsAnImagePixelByPixel) {
  auto image = std::make_shared<Image>(Image{40, 30, std::vector<std::uint8_t>(1200)});
  for (std::size_t i = 0; i < image->pixels.size(); ++i) image->pixels[i] = static_cast<std::uint8_t>(i * 37);
  PictureImage mark{image, Eigen::Matrix<double, 2, 3>::Zero()};
  mark.pane_from_image << 1.0, 0.0, 10.5, 0.0, 1.0, 20.5;  // first centre on the centre of pixel (10, 20)
  const cv::Mat shown = drawn({mark});
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      ASSERT_EQ(colour_at(shown, x + 10, y + 20).green, image->pixels[static_cast<std::size_t>(y * 40 + x)]);
    }
  }
  EXPECT_EQ(colour_at(shown, 9, 20), kWhite);
}

TEST(Picture, ShowsAThinWallOfALargePlan) {
  auto plan = std::make_shared<Image>(Image{1000, 800, std::vector<std::uint8_t>(800000, 255)});
  for (std::size_t y = 0; y < 800; ++y) std::fill_n(plan->pixels.begin() + static_cast<long>(y * 1000 + 500), 6, 0);
  PictureImage mark{plan, Eigen::Matrix<double, 2, 3>::Zero()};
  mark.pane_from_image << 0.1, 0.0, 0.05, 0.0, 0.1, 0.05;
  EXPECT_NEAR(colour_at(drawn({mark}), 50, 40).green, 255 * 0.4, 40);
  EXPECT_EQ(colour_at(drawn({mark}), 30, 40), kWhite);
}

TEST(Picture, KeepsMarksInsideTheirPane) {
  Picture picture{100, 80, {}};
  picture.panes.push_back({50, 0, 50, 80, kWhite, {PictureLine{{{-100.0, 40.0}, {200.0, 40.0}}, kRed, 4.0}}});
  const cv::Mat clipped = decoded(to_png(picture));
  EXPECT_EQ(colour_at(clipped, 75, 40), kRed);
  EXPECT_EQ(colour_at(clipped, 40, 40), kWhite);
}

TEST(Picture, WritesText) {
  const cv::Mat written = drawn({PictureText{{10.0, 40.0}, "H", 20.0, kRed}});
  cv::Mat ink;
  cv::inRange(written, cv::Scalar(0, 0, 190), cv::Scalar(60, 60, 210), ink);
  EXPECT_GT(cv::countNonZero(ink), 10);
}

TEST(Picture, FitsTwoPanes) {
  const Picture wide = hconcat(picture_of({}, 100, 80), picture_of({}, 50, 120));
  EXPECT_EQ(wide.width, 150);
  EXPECT_EQ(wide.height, 120);
  EXPECT_EQ(wide.panes[1].left, 100);
  const Picture high = vconcat(picture_of({}, 100, 80), picture_of({}, 50, 120));
  EXPECT_EQ(high.width, 100);
  EXPECT_EQ(high.height, 200);
  EXPECT_EQ(high.panes[1].top, 80);
}

TEST(Picture, IsAnimatedAsPng) {
  const PictureLine line{{{10.0, 40.0}, {60.0, 40.0}}, kRed, 4.0};
  const std::vector<std::byte> png = to_animated_png({picture_of({line}, 100, 80), picture_of({}, 100, 80)}, 10.0, 2.0);
  const cv::Mat first = decoded(png);
  EXPECT_EQ(first.cols, 100);
  EXPECT_EQ(colour_at(first, 30, 40), kRed);
  EXPECT_EQ(colour_at(first, 30, 20), kWhite);
  const std::string_view bytes(reinterpret_cast<const char*>(png.data()), png.size());
  EXPECT_NE(bytes.find("fdAT"), std::string_view::npos);
}

TEST(PictureSvg, IsWellFormed) {
  auto image = std::make_shared<Image>(Image{2, 2, {0, 100, 200, 255}});
  const std::string svg = to_svg(picture_of({
      PictureImage{image, Eigen::Matrix<double, 2, 3>::Identity()},
      PictureArea{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, kRed, 0.3},
      PictureLine{{{0.0, 0.0}, {9.0, 9.0}}, kRed, 1.0, Stroke::dotted},
      symbols(Symbol::cross, {{3.0, 3.0}}),
      PictureText{{5.0, 5.0}, "a < b & \"c\"", 12.0, kRed, Align::right, true},
  }));
  EXPECT_TRUE(is_well_formed(svg)) << svg;
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; &quot;c&quot;</text>"));
  EXPECT_THAT(svg, HasSubstr("href=\"data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(svg, HasSubstr("fill=\"#c80000\""));
}

TEST(PictureSvg, ContainsEverySymbol) {
  const std::vector<Eigen::Vector2d> centres = {{1.0, 2.0}, {3.0, 4.0}, {50.0, 60.0}};
  EXPECT_EQ(moves_in_class(to_svg(picture_of({symbols(Symbol::disc, centres)})), "things"), 3);
  EXPECT_EQ(moves_in_class(to_svg(picture_of({symbols(Symbol::diamond, centres)})), "things"), 3);
  EXPECT_EQ(moves_in_class(to_svg(picture_of({symbols(Symbol::cross, centres)})), "things"), 6);
  EXPECT_THAT(to_svg(picture_of({symbols(Symbol::disc, {})})), Not(HasSubstr("things")));
}

TEST(PictureSvg, PlacesPanes) {
  Picture picture{100, 80, {}};
  picture.panes.push_back({50, 7, 20, 30, kWhite, {}});
  EXPECT_THAT(to_svg(picture), HasSubstr("<svg x=\"50\" y=\"7\" width=\"20\" height=\"30\">"));
  EXPECT_THAT(to_svg(picture), HasSubstr("viewBox=\"0 0 100 80\""));
}

}  // namespace
}  // namespace byre
