#include "byre/playback/archive/scale_by_distance.h"

#include "byre/input_error.h"
#include "byre/simulation/simulated_mission_scene.h"

#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A monocular map of a quarter circle; keyframes at 0, 0.4, 0.8 s and so on.
const StoredMap& unscaled() {
  static const StoredMap stored = [] {
    Rig rig = simulated_rig();
    rig.baseline = 0.0;
    StoredMap made;
    made.map = true_map(simulate_mission(rig, circling_trajectory(40, 10.0, 2.0, 0.25), {}), 4, Origin::offline);
    made.scale = MapScale::unknown;
    return made;
  }();
  return stored;
}

Eigen::Vector3d camera_in_world(const StoredMap& stored, std::uint32_t keyframe) {
  return inverse(stored.map.camera_from_world({Origin::offline, keyframe})).translation;
}

TEST(ScaleByDistance, MakesTheMapMetric) {
  const ScaledMap scaled = scale_by_distance(unscaled(), "point:3", "point:40", 4.2);
  EXPECT_EQ(scaled.stored.scale, MapScale::metric);
  EXPECT_NEAR((find_place(scaled.stored, "point:3") - find_place(scaled.stored, "point:40")).norm(), 4.2, 1e-9);
  EXPECT_NEAR(scaled.factor * scaled.distance, 4.2, 1e-9);
  EXPECT_THAT(find_faults(scaled.stored.map), ::testing::IsEmpty());
}

TEST(ScaleByDistance, PreservesProjections) {
  const ScaledMap scaled = scale_by_distance(unscaled(), "0,0,0", "0,0,0.5", 1.0);
  EXPECT_NEAR(scaled.factor, 2.0, 1e-12);
  for (const PointId id : unscaled().map.point_ids()) {
    const MapPoint& before = *unscaled().map.find_point(id);
    const MapPoint& now = *scaled.stored.map.find_point(id);
    const KeyframeId by = before.reference.keyframe;
    const Rig& rig = unscaled().map.rigs().front();
    const StereoPixel pixel_before = rig.project(unscaled().map.camera_from_world(by) * before.position_in_world);
    const StereoPixel pixel_now = rig.project(scaled.stored.map.camera_from_world(by) * now.position_in_world);
    ASSERT_LT((pixel_now - pixel_before).head<2>().norm(), 1e-6) << "point " << id.number;
    ASSERT_LT((now.covariance - 4.0 * before.covariance).norm(), 1e-9 + 1e-9 * now.covariance.norm());
    ASSERT_FLOAT_EQ(now.max_distance, 2.0f * before.max_distance);
  }
}

TEST(ScaleByDistance, PreservesTheRegistration) {
  StoredMap stored = unscaled();
  stored.plan.emplace();
  stored.plan->plan_from_map = {3.5, {rotation_exp({0.1, 0.2, 0.3}), {10.0, -4.0, 1.0}}};
  const ScaledMap scaled = scale_by_distance(stored, "point:3", "point:40", 4.2);
  const Eigen::Vector3d before = stored.plan->plan_from_map * find_place(stored, "point:7");
  const Eigen::Vector3d now = scaled.stored.plan.value().plan_from_map * find_place(scaled.stored, "point:7");
  EXPECT_LT((now - before).norm(), 1e-9);
}

TEST(FindPlace, FindsTheCameraAtATime) {
  EXPECT_LT((find_place(unscaled(), "time:0.41") - camera_in_world(unscaled(), 1)).norm(), 1e-12);
}

TEST(FindPlace, ReportsFaults) {
  const auto of = [](const std::string& text) { return [text] { find_place(unscaled(), text); }; };
  EXPECT_THAT(of("point:x"), ThrowsMessage<InputError>(HasSubstr("is not a point number")));
  EXPECT_THAT(of("point:999999"), ThrowsMessage<InputError>(HasSubstr("is not in the map")));
  EXPECT_THAT(of("time:60"), ThrowsMessage<InputError>(HasSubstr("which cover 0.000 to 3.600 s")));
  EXPECT_THAT(of("1,2"), ThrowsMessage<InputError>(HasSubstr("does not have three coordinates")));
  EXPECT_THAT(of("1,2,nan"), ThrowsMessage<InputError>(HasSubstr("is not a place")));
  EXPECT_THAT(of("the door"), ThrowsMessage<InputError>(HasSubstr("point:NUMBER")));
}

TEST(ScaleByDistance, RejectsEqualPlaces) {
  EXPECT_THAT([] { scale_by_distance(unscaled(), "point:3", "point:3", 1.0); },
              ThrowsMessage<InputError>(HasSubstr("the same place twice")));
}

TEST(ScaleByDistance, RejectsAMetricMap) {
  StoredMap stereo;
  stereo.map =
      true_map(simulate_mission(simulated_rig(), circling_trajectory(8, 10.0, 2.0, 0.05), {}), 4, Origin::offline);
  EXPECT_THAT([&] { scale_by_distance(stereo, "0,0,0", "1,0,0", 1.0); },
              ThrowsMessage<InputError>(HasSubstr("made by a stereo or depth camera")));
}

}  // namespace
}  // namespace byre
