// Files of every format that byre ever wrote stay readable. A file here is never changed; a new format adds one.

#include "byre/input/binary_file.h"
#include "byre/map/map_file.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

const std::filesystem::path kFormats = std::filesystem::path(BYRE_SOURCE_DIR) / "tests/robustness/formats";

TEST(OldFormats, FirstIsReadAndWrittenTheSame) {
  const StoredMap stored = load_map(kFormats / "format_1.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.notes.at("site"), "barn 3");
  EXPECT_EQ(stored.recordings.at(1).name, "barn_evening");
  EXPECT_EQ(stored.map.keyframe_count(), 5);
  EXPECT_EQ(stored.map.point_count(), 6);
  EXPECT_EQ(write_map(stored), read_file(kFormats / "format_1.byre"));
}

TEST(OldFormats, SecondIsReadAndWrittenTheSame) {
  const StoredMap stored = load_map(kFormats / "format_2.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.map.keyframe_count(), 5);
  ASSERT_TRUE(stored.plan.has_value());
  EXPECT_EQ(stored.plan->plan, "barn 3, ground floor");
  EXPECT_EQ(stored.plan->plan_from_map.scale, 1.25);
  EXPECT_EQ(write_map(stored), read_file(kFormats / "format_2.byre"));
}

TEST(OldFormats, ThirdIsReadAndWrittenTheSame) {
  const StoredMap stored = load_map(kFormats / "format_3.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  ASSERT_TRUE(stored.recordings.at(0).refined.has_value());
  EXPECT_EQ(stored.recordings.at(0).refined->keyframes, 41);
  EXPECT_EQ(stored.recordings.at(0).refined->shift, 0.25);
  EXPECT_EQ(write_map(stored), read_file(kFormats / "format_3.byre"));
}

TEST(OldFormats, FourthIsReadAndWrittenTheSame) {
  const StoredMap stored = load_map(kFormats / "format_4.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.recordings.at(0).calibration.readout_time, 0.0);
  EXPECT_EQ(stored.recordings.at(0).present_calibration().readout_time, 0.021);
  EXPECT_EQ(write_map(stored), read_file(kFormats / "format_4.byre"));
}

}  // namespace
}  // namespace byre
