// Files of every format that byre ever wrote stay readable, and are saved in the newest. Files here never change; each
// new format adds one.

#include "byre/base/binary_file.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/map_file.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path kFormats = std::filesystem::path(BYRE_SOURCE_DIR) / "tests/robustness/formats";

// Checks that saving gives the newest format, and that saving again gives the same bytes.
void expect_to_be_written_in_the_newest(const StoredMap& stored) {
  const MapBytes written = write_map(stored);
  EXPECT_EQ(value_at<std::uint32_t>(written, kFormatAt), kNewestFormat);
  const StoredMap read = read_map(written, "written.byre");
  EXPECT_THAT(find_faults(read), IsEmpty());
  EXPECT_EQ(read.map.keyframe_count(), stored.map.keyframe_count());
  EXPECT_EQ(read.map.point_count(), stored.map.point_count());
  EXPECT_EQ(write_map(read), written);
}

std::string refusal_with(const char* section_name, std::size_t place, std::uint32_t value) {
  MapBytes bytes = read_file(kFormats / "format_1.byre");
  put_at(bytes, section_of(bytes, section_name).offset + place, value);
  refresh_checksums(bytes);
  return refusal_of(bytes);
}

// Offsets follow docs/reference/map_format.md.
TEST(OldFormats, RejectInvalidValues) {
  constexpr std::uint32_t kHuge = 0xfffffff0;
  EXPECT_THAT(refusal_with("patches", 0, kHuge), HasSubstr("declares 4294967280 entries"));
  EXPECT_THAT(refusal_with("patches", 4 + 268, 0), HasSubstr("has unsorted features"));
  EXPECT_THAT(refusal_with("points", 4 + 128, kHuge), HasSubstr("refers to feature 4294967280"));
  EXPECT_THAT(refusal_with("observations", 4 + 20, 0), HasSubstr("has unsorted features"));
  EXPECT_THAT(refusal_with("observations", 8, kHuge), HasSubstr("refers to point 4294967280 of"));
  EXPECT_THAT(refusal_with("observations", 8 + 20, 0), HasSubstr("point 0 is observed twice by a keyframe"));
  EXPECT_THAT(refusal_with("features", 4 + 16, 0x7fc00000), HasSubstr("keypoint with invalid values"));
}

TEST(OldFormats, ConvertTheFirst) {
  const StoredMap stored = load_map(kFormats / "format_1.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.notes.at("site"), "barn 3");
  EXPECT_EQ(stored.recordings.at(1).name, "barn_evening");
  EXPECT_EQ(stored.map.keyframe_count(), 5);
  EXPECT_EQ(stored.map.point_count(), 6);
  expect_to_be_written_in_the_newest(stored);
}

TEST(OldFormats, ConvertTheSecond) {
  const StoredMap stored = load_map(kFormats / "format_2.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.map.keyframe_count(), 5);
  ASSERT_TRUE(stored.plan.has_value());
  EXPECT_EQ(stored.plan->plan, "barn 3, ground floor");
  EXPECT_EQ(stored.plan->plan_from_map.scale, 1.25);
  expect_to_be_written_in_the_newest(stored);
}

TEST(OldFormats, ConvertTheThird) {
  const StoredMap stored = load_map(kFormats / "format_3.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  ASSERT_TRUE(stored.recordings.at(0).refined.has_value());
  EXPECT_EQ(stored.recordings.at(0).refined->keyframes, 41);
  EXPECT_EQ(stored.recordings.at(0).refined->shift, 0.25);
  expect_to_be_written_in_the_newest(stored);
}

TEST(OldFormats, ConvertTheFourth) {
  const StoredMap stored = load_map(kFormats / "format_4.byre");
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.recordings.at(0).calibration.readout_time, 0.0);
  EXPECT_EQ(stored.recordings.at(0).present_calibration().readout_time, 0.021);
  expect_to_be_written_in_the_newest(stored);
}

void expect_the_barn(const StoredMap& stored) {
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.map.keyframe_count(), 5);
  EXPECT_EQ(stored.map.point_count(), 6);
  EXPECT_EQ(stored.plan.value().plan, "barn 3, ground floor");
}

TEST(OldFormats, ConvertTheFifth) {
  const StoredMap stored = load_map(kFormats / "format_5.byre");
  expect_the_barn(stored);
  expect_to_be_written_in_the_newest(stored);
}

TEST(OldFormats, ConvertTheSixth) {
  const StoredMap stored = load_map(kFormats / "format_6.byre");
  expect_the_barn(stored);
  expect_to_be_written_in_the_newest(stored);
}

TEST(OldFormats, ReadAndWriteTheSeventhUnchanged) {
  const StoredMap stored = load_map(kFormats / "format_7.byre");
  expect_the_barn(stored);
  EXPECT_EQ(write_map(stored), read_file(kFormats / "format_7.byre"));
}

TEST(OldFormats, AreReadCompletelyOnOpening) {
  for (const int format : {1, 2, 3, 4, 5, 6, 7}) {
    const auto file = kFormats / ("format_" + std::to_string(format) + ".byre");
    EXPECT_EQ(write_map(open_map(file)), write_map(load_map(file)));
  }
}

}  // namespace
}  // namespace byre
