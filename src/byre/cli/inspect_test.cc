#include "byre/cli/inspect_point_cloud.h"
#include "byre/cli/inspect_report.h"
#include "byre/map/stored_map_scene.h"
#include "byre/simulation/simulated_mission.h"

#include <cstring>
#include <numbers>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using Json = nlohmann::json;

constexpr double kRadius = 2.0;  // metres
constexpr double kPixelSigma = 0.5;

// One lap in a room of 10 x 8 x 4 m.
StoredMap simulated_map(int keyframes = 60) {
  SimulationOptions options;
  options.pixel_sigma = kPixelSigma;
  const auto mission = simulate_mission(simulated_rig(), circling_trajectory(keyframes, 10.0, kRadius, 1.0), options);
  StoredMap stored = StoredMapScene().stored();
  stored.map = true_map(mission, 1, Origin::offline);
  return stored;
}

TEST(Inspect, CountsWhatTheMapHolds) {
  const StoredMapScene scene(4, 9);  // and a keyframe without features; three keyframes see 8 points, the last sees 8
  const MapInspection inspection = inspect(scene.stored());
  EXPECT_EQ(inspection.counts.keyframes, 5);
  EXPECT_EQ(inspection.counts.keyframes_with_words, 2);
  EXPECT_EQ(inspection.counts.features, 36);
  EXPECT_EQ(inspection.counts.patches, 4 * 5);
  EXPECT_EQ(inspection.counts.points, 16);
  EXPECT_EQ(inspection.counts.observations, 32);
  EXPECT_EQ(inspection.observations_per_point.mean, 2.0);
  EXPECT_EQ(inspection.observations_per_point.max, 3.0);
  EXPECT_THAT(inspection.faults, IsEmpty());
}

TEST(Inspect, MeasuresTheErrorsThatWereSimulated) {
  const MapInspection inspection = inspect(simulated_map());
  const ReprojectionErrors& errors = inspection.errors;
  EXPECT_EQ(errors.behind_camera, 0);
  EXPECT_EQ(errors.pixel.count, inspection.counts.observations);
  EXPECT_GT(errors.disparity.count, 0);
  EXPECT_LE(errors.disparity.count, errors.pixel.count);
  // The median of a Rayleigh distribution is 1.18 sigmas, of octaves up to 3.6 times as coarse.
  EXPECT_GT(errors.pixel.p50, 1.18 * kPixelSigma);
  EXPECT_LT(errors.pixel.p50, 3.6 * 1.18 * kPixelSigma);
  EXPECT_LT(errors.pixel.p50, errors.pixel.p95);
  EXPECT_LT(errors.pixel.p95, errors.pixel.p99);
  EXPECT_LE(errors.pixel.p99, errors.pixel.max);
}

TEST(Inspect, FindsPointsBehindTheirCameras) {
  StoredMap stored = simulated_map(4);
  const PointId id = stored.map.point_ids().front();
  MapPoint point = *stored.map.find_point(id);
  const KeyframeId observer = stored.map.observations(id).front().keyframe;
  point.position_in_world = inverse(stored.map.camera_from_world(observer)) * Eigen::Vector3d(0.0, 0.0, -1.0);
  stored.map.update_point(id, point);
  const MapInspection inspection = inspect(stored);
  EXPECT_GE(inspection.errors.behind_camera, 1);
  EXPECT_EQ(inspection.errors.pixel.count, inspection.counts.observations - inspection.errors.behind_camera);
}

TEST(Inspect, MeasuresTheRoomAndThePath) {
  const MapInspection inspection = inspect(simulated_map());
  ASSERT_TRUE(inspection.points_in_world.has_value());
  const Eigen::Vector3d size = inspection.points_in_world->max - inspection.points_in_world->min;
  EXPECT_TRUE(size.isApprox(Eigen::Vector3d(10.0, 8.0, 4.0), 0.05)) << size.transpose();
  EXPECT_NEAR(inspection.path_length, 2.0 * std::numbers::pi * kRadius, 0.3);
}

TEST(Inspect, ManagesAnEmptyMap) {
  const MapInspection inspection = inspect({});
  EXPECT_FALSE(inspection.points_in_world.has_value());
  EXPECT_EQ(inspection.errors.pixel.count, 0);
  EXPECT_THAT(to_text({}, inspection, {"empty.byre", 512, {}}), HasSubstr("faults         none\n"));
  EXPECT_TRUE(Json::parse(to_json({}, inspection, {"empty.byre", 512, {}}))["bounding_box"].is_null());
}

TEST(InspectReport, IsReadable) {
  const StoredMap stored = StoredMapScene(4, 9).stored();
  MapInspection inspection = inspect(stored);
  const InspectedFile file{"barn.byre", 12345678, {{"header", 432}, {"points", 2000000}}};
  const std::string text = to_text(stored, inspection, file);
  EXPECT_THAT(text, StartsWith("map            barn.byre\n"));
  EXPECT_THAT(text, HasSubstr("recording      barn_morning, 100.0 s, last frame at 200.000 s, 4 keyframes, stereo\n"));
  EXPECT_THAT(text, HasSubstr("site           barn 3\n"));
  EXPECT_THAT(text, HasSubstr("keyframes      5, with 36 features, 20 with a patch\n"));
  EXPECT_THAT(text, HasSubstr("words          of 2 keyframes, by the vocabulary 0123456789abcdef\n"));
  EXPECT_THAT(text, HasSubstr("file           12.3 MB, 2469.1 kB per keyframe\n"));
  EXPECT_THAT(text, HasSubstr("header 432 B, points 2.0 MB"));
  EXPECT_THAT(text, HasSubstr("faults         none\n"));
  inspection.faults = {"point 3 is seen by no keyframe"};
  EXPECT_THAT(to_text(stored, inspection, file), HasSubstr("fault          point 3 is seen by no keyframe\n"));
}

TEST(InspectReport, SaysWhichCamerasMadeTheMap) {
  StoredMap stored = StoredMapScene(4, 9).stored();
  EXPECT_THAT(inspect(stored).cameras_of_recordings, testing::ElementsAre("stereo", "mono"));
  stored.recordings[0].calibration.right.reset();
  const MapInspection inspection = inspect(stored);
  EXPECT_THAT(inspection.cameras_of_recordings, testing::ElementsAre("rgbd", "mono")) << "its rig has a baseline";
  EXPECT_THAT(to_text(stored, inspection, {}), HasSubstr("last frame at 200.000 s, 4 keyframes, rgbd\n"));
  EXPECT_EQ(Json::parse(to_json(stored, inspection, {}))["recordings"][0]["camera"], "rgbd");
}

TEST(InspectReport, NamesItsUnit) {
  StoredMap stored = StoredMapScene().stored();
  EXPECT_THAT(to_text(stored, inspect(stored), {}), testing::ContainsRegex("path +[0-9.]+ m\n"));
  stored.scale = MapScale::unknown;
  EXPECT_THAT(to_text(stored, inspect(stored), {}), testing::ContainsRegex("path +[0-9.]+ units\n"));
}

TEST(InspectReport, IsJsonWithStableKeys) {
  const StoredMap stored = StoredMapScene(4, 9).stored();
  const InspectedFile file{"barn.byre", 1000, {{"header", 432}}};
  const Json json = Json::parse(to_json(stored, inspect(stored), file));
  std::vector<std::string> keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  EXPECT_THAT(keys, testing::UnorderedElementsAre("file", "scale", "pose_source", "recordings", "notes", "plan",
                                                  "vocabulary_checksum", "counts", "observations_per_point",
                                                  "reprojection_error", "bounding_box", "path_length", "memory_bytes",
                                                  "faults"));
  EXPECT_EQ(json["file"]["section_bytes"]["header"], 432);
  EXPECT_EQ(json["counts"]["points"], 16);
  EXPECT_EQ(json["notes"]["site"], "barn 3");
  EXPECT_EQ(json["recordings"][0]["keyframes"], 4);
  EXPECT_EQ(json["recordings"][1]["keyframes"], 1);
  EXPECT_EQ(json["recordings"][0]["last_time_ns"], 200000000000);
  EXPECT_EQ(json["pose_source"], "given");
  EXPECT_EQ(json["observations_per_point"]["p50"], 2.0);
}

TEST(InspectReport, SaysInJsonWhereTheMapLiesOnItsPlan) {
  const StoredMap stored = StoredMapScene().stored_with_plan();
  const Json plan = Json::parse(to_json(stored, inspect(stored), {})).at("plan");
  EXPECT_EQ(plan.at("plan"), "barn 3, ground floor");
  EXPECT_EQ(plan.at("scale"), 1.25);
  EXPECT_EQ(plan.at("translation_m"), Json({12.5, -3.25, 0.0}));
  EXPECT_EQ(plan.at("covariance").size(), 49);
  const StoredMap without = StoredMapScene().stored();
  EXPECT_TRUE(Json::parse(to_json(without, inspect(without), {})).at("plan").is_null());
}

TEST(PointCloud, HoldsEveryPoint) {
  const StoredMap stored = StoredMapScene(4, 9).stored();
  const std::vector<std::byte> bytes = point_cloud(stored.map);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_THAT(text, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, HasSubstr("element vertex 16\n"));
  constexpr std::size_t kVertexBytes = 3 * 4 + 3 + 4;
  const std::size_t begin = text.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size() - begin, 16 * kVertexBytes);
  Eigen::Vector3f first;
  std::memcpy(first.data(), bytes.data() + begin, 3 * sizeof(float));
  EXPECT_EQ(first, stored.map.find_point({Origin::offline, 0})->position_in_world.cast<float>());
  std::int32_t observations = 0;
  std::memcpy(&observations, bytes.data() + begin + 15, sizeof(observations));
  EXPECT_EQ(observations, 3);
}

TEST(PointCloud, ColoursPointsByTheirObservations) {
  const StoredMap stored = StoredMapScene(4, 9).stored();  // point 0 is seen three times, point 15 once
  const std::vector<std::byte> bytes = point_cloud(stored.map);
  constexpr std::size_t kVertexBytes = 19;
  const auto blue_of = [&bytes](std::size_t point) {
    return std::to_integer<int>(bytes[bytes.size() - (16 - point) * kVertexBytes + 14]);
  };
  EXPECT_EQ(blue_of(15), 255);
  EXPECT_LT(blue_of(0), 255);
}

}  // namespace
}  // namespace byre::cli
