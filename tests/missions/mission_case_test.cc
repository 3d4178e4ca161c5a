// Missions with faults, on real and rendered recordings: health reports compared with the truth.

#include "mission_case.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

class MissionHealth : public testing::TestWithParam<MissionCase> {
 protected:
  void SetUp() override {
    if (const auto missing = missing_recording(GetParam())) GTEST_SKIP() << why_missing(*missing);
  }

  static KnownMaps& maps() {
    static KnownMaps known;
    return known;
  }
};

std::string name_of_case(const testing::TestParamInfo<MissionCase>& info) {
  return info.param.name;
}

TEST_P(MissionHealth, IsHonestAndRecovers) {
  const FlownMission flown = fly(GetParam(), maps());
  EXPECT_GE(flown.score.frames, 25);
  EXPECT_THAT(broken_demands(GetParam(), flown.score), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Real, MissionHealth, testing::ValuesIn(real_mission_cases()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Lies, MissionHealth, testing::ValuesIn(lying_mission_cases()), name_of_case);
INSTANTIATE_TEST_SUITE_P(Twin, MissionHealth, testing::ValuesIn(twin_mission_cases()), name_of_case);

}  // namespace
}  // namespace byre
