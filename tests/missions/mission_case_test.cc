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

  static MapCache& maps() {
    static MapCache cache;
    return cache;
  }
};

std::string name_of_case(const testing::TestParamInfo<MissionCase>& info) {
  return info.param.name;
}

TEST_P(MissionHealth, IsHonestAndRecovers) {
  const MissionRun mission_run = run_mission(GetParam(), maps());
  EXPECT_GE(mission_run.score.frames, 25);
  EXPECT_THAT(unmet_requirements(GetParam(), mission_run.score), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Real, MissionHealth, testing::ValuesIn(select_cases(real_mission_cases(), false)),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(SensorFaults, MissionHealth, testing::ValuesIn(select_cases(sensor_fault_cases(), false)),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Twin, MissionHealth, testing::ValuesIn(select_cases(twin_mission_cases(), false)),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(LongRunReal, MissionHealth, testing::ValuesIn(select_cases(real_mission_cases(), true)),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(LongRunSensorFaults, MissionHealth,
                         testing::ValuesIn(select_cases(sensor_fault_cases(), true)), name_of_case);
INSTANTIATE_TEST_SUITE_P(LongRunTwin, MissionHealth, testing::ValuesIn(select_cases(twin_mission_cases(), true)),
                         name_of_case);

}  // namespace
}  // namespace byre
