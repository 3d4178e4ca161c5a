#include "byre/map/map_upkeep.h"

#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

MapBytes session_bytes() {
  const StoredMap stored = StoredMapScene().stored();
  return write_map(stored, upkeep_of_session(stored));
}

std::string refusal_of(const MapBytes& bytes) {
  try {
    read_map(bytes, "barn.byre");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(MapUpkeep, IsReadAsWritten) {
  const StoredMap stored = StoredMapScene().stored();
  const MapUpkeep written = upkeep_of_session(stored), read = read_upkeep(session_bytes(), "file");
  EXPECT_EQ(read.survival, written.survival);
  ASSERT_TRUE(read.session);
  EXPECT_EQ(read.session->map_id, written.session->map_id);
  EXPECT_EQ(read.session->frames, 400u);
  EXPECT_EQ(read.session->trusted, 380u);
  EXPECT_EQ(read.session->copied_points, 2u);
  EXPECT_EQ(read.session->points, written.session->points);
  ASSERT_EQ(read.session->poses.size(), 1u);
  const PoseRecord &pose = read.session->poses[0], &expected = written.session->poses[0];
  EXPECT_EQ(pose.time, expected.time);
  EXPECT_EQ(pose.map_from_body.translation, expected.map_from_body.translation);
  EXPECT_EQ(pose.covariance, expected.covariance);
  EXPECT_EQ(pose.verdict, expected.verdict);
  EXPECT_EQ(pose.image.sharpness, expected.image.sharpness);
  EXPECT_EQ(write_map(read_map(session_bytes(), "file"), read), session_bytes());
}

TEST(MapUpkeep, IsEmptyInOtherMaps) {
  const MapUpkeep upkeep = read_upkeep(write_map(StoredMapScene().stored()), "file");
  EXPECT_TRUE(upkeep.survival.empty());
  EXPECT_FALSE(upkeep.session);
}

TEST(MapUpkeep, LeavesTheMapAsItIs) {
  const StoredMap stored = StoredMapScene().stored();
  EXPECT_EQ(write_map(read_map(session_bytes(), "file")), write_map(stored));
}

TEST(MapUpkeep, IsProtectedByChecksums) {
  MapBytes bytes = session_bytes();
  const TableEntry section = section_of(bytes, "upkeep");
  ASSERT_EQ(section.name, "upkeep");
  for (std::size_t i = 0; i < section.size; ++i) {
    bytes[section.offset + i] ^= std::byte{1};
    EXPECT_THAT(refusal_of(bytes), HasSubstr("section upkeep at byte ")) << i;
    bytes[section.offset + i] ^= std::byte{1};
  }
}

TEST(MapUpkeep, IsRejectedIfItContradictsTheMapOrItself) {
  const StoredMap stored = StoredMapScene().stored();
  const auto refusal_with = [&](auto change) {
    MapUpkeep upkeep = upkeep_of_session(stored);
    change(upkeep);
    return refusal_of(write_map(stored, upkeep));
  };
  EXPECT_EQ(refusal_with([](MapUpkeep&) {}), "");
  EXPECT_THAT(refusal_with([](MapUpkeep& upkeep) { upkeep.survival.pop_back(); }),
              HasSubstr("has a number of points other than in the summary"));
  EXPECT_THAT(refusal_with([](MapUpkeep& upkeep) { upkeep.session->copied_points = 1000; }),
              HasSubstr("has more copied points than the map has points"));
  EXPECT_THAT(refusal_with([](MapUpkeep& upkeep) { upkeep.session->trusted = 401; }),
              HasSubstr("has more trusted frames than frames"));
  EXPECT_THAT(refusal_with([](MapUpkeep& upkeep) { upkeep.session->points[0].seen = 201; }),
              HasSubstr("has more sightings of a point than frames"));
  EXPECT_THAT(refusal_with([](MapUpkeep& upkeep) { upkeep.session->poses[0].map_from_body.translation.x() = NAN; }),
              HasSubstr("pose 0 "));
  EXPECT_THAT(refusal_with([](MapUpkeep& upkeep) { upkeep.session->poses[0].verdict = 3; }),
              HasSubstr("has the invalid value 3"));
}

TEST(MapId, DependsOnEveryPartOfTheFile) {
  const StoredMap stored = StoredMapScene().stored();
  StoredMap renamed = stored;
  renamed.notes["site"] = "barn 4";
  const auto id_of = [](const MapBytes& bytes) { return map_id(bytes, "file"); };
  EXPECT_EQ(id_of(write_map(stored)), id_of(write_map(stored)));
  EXPECT_NE(id_of(write_map(stored)), id_of(write_map(renamed)));
  EXPECT_NE(id_of(write_map(stored)), id_of(session_bytes()));
  EXPECT_EQ(to_text(0x0123456789abcdefULL), "0123456789abcdef");
}

}  // namespace
}  // namespace byre
