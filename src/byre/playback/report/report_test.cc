#include "byre/playback/report/report.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Eq;
using testing::Optional;
using Json = nlohmann::ordered_json;

const Json kFigures = {{"frames", 200},          {"coverage", 0.125},
                       {"camera", "left"},       {"is_late", false},
                       {"error", nullptr},       {"off_by_0.2m", 3},
                       {"drifts", {7.25, 12.0}}, {"doubts", {{"no pose", 3}, {"blinded", 1}}},
                       {"none", Json::array()},  {"mission", {{"losses", 2}}}};

TEST(Expand, FormatsFigures) {
  EXPECT_THAT(expand("{frames} frames of {camera}", kFigures), Optional(Eq("200 frames of left")));
  EXPECT_THAT(expand("{frames:5} {frames:.1f} {camera:6}.", kFigures), Optional(Eq("  200 200.0 left  .")));
  EXPECT_THAT(expand("{coverage*100:.1f} %, {is_late}", kFigures), Optional(Eq("12.5 %, false")));
}

TEST(Expand, FindsPartsAndElements) {
  EXPECT_THAT(expand("{mission.losses}, {drifts.1:.1f}, {off_by_0.2m}", kFigures), Optional(Eq("2, 12.0, 3")));
  EXPECT_THAT(expand("{#drifts}: {drifts:.1f}; {doubts}", kFigures),
              Optional(Eq("2: 7.2, 12.0; no pose 3, blinded 1")));
}

TEST(Expand, LeavesOutPartsWithoutTheirFigures) {
  EXPECT_THAT(expand("{frames}[, error {error}][, {none.0}][, {missing.part}].", kFigures), Optional(Eq("200.")));
  EXPECT_THAT(expand("{frames}[ of {coverage}[ or {error}]]", kFigures), Optional(Eq("200 of 0.125")));
  EXPECT_THAT(expand("error {error}", kFigures), Eq(std::nullopt));
}

TEST(Expand, ChecksConditions) {
  EXPECT_THAT(expand("[{?frames}some][{?is_late} late][{?none} more][{?error} off]", kFigures), Optional(Eq("some")));
  EXPECT_THAT(expand("[{!frames}none][{!is_late}in time]", kFigures), Optional(Eq("in time")));
}

TEST(Expand, ChoosesTheFirstAlternative) {
  EXPECT_THAT(expand("[{?is_late}late|{?frames}{frames}|none] frames", kFigures), Optional(Eq("200 frames")));
  EXPECT_THAT(expand("{error}|none", kFigures), Optional(Eq("none")));
}

TEST(Expand, PrefersFurtherFigures) {
  EXPECT_THAT(expand("{frames} {camera}", kFigures, {{"frames", 7}}), Optional(Eq("7 left")));
}

TEST(Expand, TakesNoTemplatesFromFigures) {
  EXPECT_THAT(expand("{name}", {{"name", "{frames} [a|b]"}}), Optional(Eq("{frames} [a|b]")));
}

TEST(Report, ContainsRowsLinesAndJson) {
  Report report{{{"frames", 3}, {"name", "barn\x1b[2J"}}};
  report.row("frames", "{frames}");
  report.row("error", "{error}");
  report.row("of", "{name}");
  report.line("{frames:4}[ {error}]");
  EXPECT_EQ(report.text, "frames       3\nof           barn\\x1b[2J\n   3\n");
  EXPECT_EQ(to_json(report, 1), "{\n \"frames\": 3,\n \"name\": \"barn\\u001b[2J\"\n}\n");
}

TEST(Report, EndsWithItsConclusion) {
  Report report{{{"frames", 3}}};
  report.detail("memory", "{frames} MB");
  report.row("frames", "{frames}");
  report.conclude("Complete[, {error}]. Next: byre run");
  EXPECT_EQ(to_text(report, false), "frames       3\n\nComplete. Next: byre run\n");
  EXPECT_EQ(to_text(report, true), "frames       3\nmemory       3 MB\n\nComplete. Next: byre run\n");
  EXPECT_EQ(report.figures["conclusion"], "Complete. Next: byre run");
}

}  // namespace
}  // namespace byre
