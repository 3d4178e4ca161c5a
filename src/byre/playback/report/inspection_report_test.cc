#include "byre/playback/report/inspection_report.h"

#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

using Json = nlohmann::json;

TEST(InspectReport, IsReadable) {
  const StoredMap stored = StoredMapScene(4, 9).stored();
  MapInspection inspection = inspect(stored);
  const InspectedFile file{"barn.byre", 12345678, {{"header", 432}, {"points", 2000000}}};
  const std::string text = to_text(inspection_report(stored, inspection, file), true);
  EXPECT_THAT(text, StartsWith("map            barn.byre\n"));
  EXPECT_THAT(text, HasSubstr("recording      barn_morning, 100.0 s, last frame at 200.000 s, 4 keyframes, stereo\n"));
  EXPECT_THAT(text, HasSubstr("site           barn 3\n"));
  EXPECT_THAT(text, HasSubstr("keyframes      5, with 36 features, 20 with a patch\n"));
  EXPECT_THAT(text, HasSubstr("words          of 2 keyframes, vocabulary 0123456789abcdef\n"));
  EXPECT_THAT(text, HasSubstr("file           12.3 MB, 2469.1 kB per keyframe\n"));
  EXPECT_THAT(text, HasSubstr("header 432 B, points 2.0 MB"));
  EXPECT_THAT(text, HasSubstr("faults         none\n"));
  EXPECT_THAT(text, HasSubstr("\n\nReady for missions. Next: byre run RECORDING --map barn.byre, or byre register"));
  inspection.faults = {"point 3 is not observed by any keyframe"};
  EXPECT_THAT(inspection_report(stored, inspection, file).text,
              HasSubstr("fault          point 3 is not observed by any keyframe\n"));
}

TEST(InspectReport, ContainsTheCamerasOfTheMap) {
  StoredMap stored = StoredMapScene(4, 9).stored();
  EXPECT_THAT(inspect(stored).cameras_of_recordings, testing::ElementsAre("stereo", "mono"));
  stored.recordings[0].calibration.right.reset();
  const MapInspection inspection = inspect(stored);
  EXPECT_THAT(inspection.cameras_of_recordings, testing::ElementsAre("rgbd", "mono")) << "its rig has a baseline";
  EXPECT_THAT(inspection_report(stored, inspection, {}).text,
              HasSubstr("last frame at 200.000 s, 4 keyframes, rgbd\n"));
  EXPECT_EQ(Json(inspection_report(stored, inspection, {}).figures)["recordings"][0]["camera"], "rgbd");
}

TEST(InspectReport, ContainsItsUnit) {
  StoredMap stored = StoredMapScene().stored();
  EXPECT_THAT(inspection_report(stored, inspect(stored), {}).text, testing::ContainsRegex("path +[0-9.]+ m\n"));
  stored.scale = MapScale::unknown;
  EXPECT_THAT(inspection_report(stored, inspect(stored), {}).text, testing::ContainsRegex("path +[0-9.]+ units\n"));
}

TEST(InspectReport, IsJsonWithStableKeys) {
  const StoredMap stored = StoredMapScene(4, 9).stored();
  const InspectedFile file{"barn.byre", 1000, {{"header", 432}}};
  const Json report = Json(inspection_report(stored, inspect(stored), file).figures);
  std::vector<std::string> keys;
  for (const auto& item : report.items()) keys.push_back(item.key());
  EXPECT_THAT(keys, testing::UnorderedElementsAre("file", "scale", "pose_source", "recordings", "notes", "plan",
                                                  "vocabulary_checksum", "counts", "observations_per_point",
                                                  "reprojection_error", "bounding_box", "path_length", "memory_bytes",
                                                  "faults", "conclusion"));
  EXPECT_EQ(report["file"]["section_bytes"]["header"], 432);
  EXPECT_EQ(report["counts"]["points"], 16);
  EXPECT_EQ(report["notes"]["site"], "barn 3");
  EXPECT_EQ(report["recordings"][0]["keyframes"], 4);
  EXPECT_EQ(report["recordings"][1]["keyframes"], 1);
  EXPECT_EQ(report["recordings"][0]["last_time_ns"], 200000000000);
  EXPECT_EQ(report["pose_source"], "given");
  EXPECT_EQ(report["observations_per_point"]["p50"], 2.0);
}

TEST(InspectReport, ContainsTheRegistrationInJson) {
  const StoredMap stored = StoredMapScene().stored_with_plan();
  const Json plan = Json(inspection_report(stored, inspect(stored), {}).figures).at("plan");
  EXPECT_EQ(plan.at("plan"), "barn 3, ground floor");
  EXPECT_EQ(plan.at("scale"), 1.25);
  EXPECT_EQ(plan.at("translation_m"), Json({12.5, -3.25, 0.0}));
  EXPECT_EQ(plan.at("covariance").size(), 49);
  const StoredMap without = StoredMapScene().stored();
  EXPECT_TRUE(Json(inspection_report(without, inspect(without), {}).figures).at("plan").is_null());
}

TEST(InspectReport, AcceptsAnEmptyMap) {
  const MapInspection inspection = inspect({});
  EXPECT_THAT(inspection_report({}, inspection, {"empty.byre", 512, {}}).text, HasSubstr("faults         none\n"));
  EXPECT_TRUE(Json(inspection_report({}, inspection, {"empty.byre", 512, {}}).figures)["bounding_box"].is_null());
}

}  // namespace
}  // namespace byre
