// Missions that start all along a barn, on a map of another visit: despite perceptual aliasing no frame may be wrongly
// trusted, and the robot must be localised soon when mapped points are in view.

#include "start_cases.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// Share of starts. The target is 0; with images of 320x240 at dusk 8 of 20 starts are late. Six of these face a gate
// that is open, but was closed in the map: most mapped points in view are on it, or on things that it hid.
constexpr double kMaxLocalisedLate = 0.4;

class Starts : public testing::TestWithParam<StartCase> {
 protected:
  void SetUp() override {
    if (const auto missing = what_is_missing(GetParam())) GTEST_SKIP() << *missing;
  }

  static MapCache& maps() {
    static MapCache aligned;
    return aligned;
  }
};

TEST_P(Starts, AreNeverWronglyTrustedAndLocaliseSoon) {
  const StartCase& start_case = GetParam();
  const StartTotals totals = run(start_case, maps().get(start_case.map), {});
  EXPECT_GE(totals.starts, 5);
  EXPECT_EQ(totals.wrongly_trusted, 0) << "in " << totals.starts_wrongly_trusted << " starts, by up to "
                                       << totals.worst_trusted_error << " m";
  EXPECT_LE(totals.localised_late, kMaxLocalisedLate * totals.starts);
  RecordProperty("trusted_right", totals.correctly_trusted);
}

std::string name_of_start(const testing::TestParamInfo<StartCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Barn, Starts, testing::ValuesIn(select_cases(start_cases(), false)), name_of_start);
INSTANTIATE_TEST_SUITE_P(LongRunBarn, Starts, testing::ValuesIn(select_cases(start_cases(), true)), name_of_start);

}  // namespace
}  // namespace byre
