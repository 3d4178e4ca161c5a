#include "byre/benchmark/demo/table.h"

#include "byre/benchmark/demo/findings_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

class DemoTable : public testing::Test {
 protected:
  DemoArm& arm(Arm wanted) { return *std::ranges::find(arms, wanted, &DemoArm::arm); }

  DemoRow row(const std::string& begin) const {
    for (const DemoRow& row : demo_table(arms)) {
      if (row.measure.starts_with(begin)) return row;
    }
    ADD_FAILURE() << "no row begins with " << begin;
    return {"", std::vector<DemoCell>(arms.size())};
  }

  std::vector<DemoArm> arms = small_findings().arms;
};

TEST_F(DemoTable, MarksTheBestArm) {
  for (std::size_t i = 0; i < 5; ++i) arm(Arm::localise_only).moments[i].error.reset();
  arm(Arm::hybrid).moments[0].error.reset();
  const DemoRow coverage = row("Frames with a position on the plan");
  EXPECT_EQ(coverage.cells[0].text, "0.0") << "no map, so no position on the plan";
  EXPECT_EQ(coverage.cells[1].text, "50.0");
  EXPECT_EQ(coverage.cells[2].text, "90.0");
  EXPECT_TRUE(coverage.cells[2].is_best);
  EXPECT_FALSE(coverage.cells[1].is_best);
}

TEST_F(DemoTable, MarksTheSmallestErrorAndEqualTexts) {
  for (DemoArm& each : arms) each.measures.causal_poses.map_error_max = 0.1;
  arm(Arm::no_map).measures.causal_poses.map_error = 0.01001;
  arm(Arm::localise_only).measures.causal_poses.map_error = 5.0;
  arm(Arm::hybrid).measures.causal_poses.map_error = 0.01;
  const DemoRow error = row("Error of published");
  EXPECT_EQ(error.cells[2].text, "1.0, max 10.0");
  EXPECT_EQ(error.cells[1].text, "500, max 10.0");
  EXPECT_TRUE(error.cells[0].is_best);
  EXPECT_FALSE(error.cells[1].is_best);
  EXPECT_TRUE(error.cells[2].is_best);
}

TEST_F(DemoTable, ShowsADashForAMissingFigure) {
  for (DemoMoment& moment : arm(Arm::localise_only).moments) moment.verdict = Verdict::untrusted;
  const DemoRow found = row("First trusted position");
  EXPECT_EQ(found.cells[1].text, "-");
  EXPECT_FALSE(found.cells[1].is_best);
  EXPECT_EQ(found.cells[2].text, "0.0");
}

TEST_F(DemoTable, OmitsTrustOfARunWithoutAMap) {
  arm(Arm::localise_only).moments[3].verdict = Verdict::degraded;
  const DemoRow trusted = row("Frames reported as trusted");
  EXPECT_EQ(trusted.cells[0].text, "-");
  EXPECT_EQ(trusted.cells[1].text, "90.0");
}

TEST_F(DemoTable, MarksNothingInARowWithoutFigures) {
  for (const DemoCell& cell : row("Time per frame").cells) EXPECT_FALSE(cell.is_best);
}

TEST_F(DemoTable, PrintsOneLinePerRow) {
  const std::vector<DemoRow> rows = demo_table(arms);
  const std::string text = to_text(rows, arms);
  EXPECT_EQ(std::ranges::count(text, '\n'), static_cast<std::ptrdiff_t>(rows.size() + 1));
  EXPECT_THAT(text, HasSubstr("Localise only"));
  EXPECT_THAT(text, HasSubstr("Frames with a position within 10 cm of the truth, %"));
}

}  // namespace
}  // namespace byre
