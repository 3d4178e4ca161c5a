#include "byre/slam/loops/odometry_motions.h"

#include "byre/slam/tracking/mission_scene.h"
#include "byre/trajectory.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class MotionsOfATrueMap : public ::testing::Test {
 protected:
  static SimulatedMission quarter_circle_of(Rig rig) {
    return simulate_mission(rig, circling_trajectory(40, 10.0, 2.0, 0.25), {});
  }
  static Rig one_camera() {
    Rig rig = simulated_rig();
    rig.baseline = 0.0;
    return rig;
  }

  const SimulatedMission mission_ = quarter_circle_of(one_camera());
  MapGraph map_ = true_map(mission_, 4, Origin::online);

  // Motions by wheels with a scale error; from the time `spinning` on, wheels spin.
  OdometryQuery odometry(double scale = 1.0, Timestamp spinning = Timestamp::max()) const {
    return [this, scale, spinning](Timestamp earlier, Timestamp later) -> std::optional<BodyMotion> {
      const Timestamp gap = std::chrono::seconds(1);
      Pose motion = inverse(*pose_at(mission_.truth, earlier, gap)) * *pose_at(mission_.truth, later, gap);
      motion.translation *= later > spinning ? 3.0 * scale : scale;
      return motion;
    };
  }
};

TEST_F(MotionsOfATrueMap, ConnectConsecutiveKeyframes) {
  std::vector<KeyframeId> ids = map_.keyframe_ids();
  const std::size_t ways = ids.size() - 1;
  std::ranges::reverse(ids);
  const auto motions = odometry_motions(map_, ids, 0, odometry());
  ASSERT_THAT(motions, SizeIs(ways));
  EXPECT_EQ(motions.front().later, motions[1].earlier);
  EXPECT_THAT(odometry_motions(map_, ids, 1, odometry()), IsEmpty()) << "another recording";
  EXPECT_THAT(odometry_motions(map_, ids, 0, {}), IsEmpty());
}

TEST_F(MotionsOfATrueMap, AreEmptyForAStereoRig) {
  const MapGraph map = true_map(quarter_circle_of(simulated_rig()), 4, Origin::online);
  EXPECT_THAT(odometry_motions(map, map.keyframe_ids(), 0, odometry()), IsEmpty());
}

TEST_F(MotionsOfATrueMap, AreRejectedIfTheyContradictImages) {
  const std::vector<KeyframeId> ids = map_.keyframe_ids();
  const Timestamp spinning = map_.find_keyframe(ids[ids.size() - 4])->frame.time;
  EXPECT_THAT(odometry_motions(map_, ids, 0, odometry(1.0, spinning)), SizeIs(ids.size() - 4));
}

TEST_F(MotionsOfATrueMap, AreAcceptedIfTheMapErrsByAFifth) {
  const std::vector<KeyframeId> ids = map_.keyframe_ids();
  EXPECT_THAT(odometry_motions(map_, ids, 0, odometry(1.2)), SizeIs(ids.size() - 1));
}

// No image contradicts a motion between keyframes without common points.
TEST_F(MotionsOfATrueMap, AreAcceptedBetweenKeyframesWithoutCommonPoints) {
  const std::vector<KeyframeId> ids = map_.keyframe_ids();
  const std::vector<KeyframeId> ends = {ids.front(), ids.back()};
  const auto motions = odometry_motions(map_, ends, 0, odometry(3.0));
  ASSERT_THAT(motions, SizeIs(1));
  EXPECT_TRUE(motions.front().lacks_visual_constraint);
  EXPECT_THAT(odometry_motions(map_, {ids[0], ids[1]}, 0, odometry(3.0)), IsEmpty()) << "seen";
  const MapGraph pair = true_map(quarter_circle_of(simulated_rig()), 4, Origin::online);
  EXPECT_THAT(odometry_motions(pair, {pair.keyframe_ids().front(), pair.keyframe_ids().back()}, 0, odometry()),
              SizeIs(1));
}

// Few common points may have been triangulated across a gap, and contradict no motion.
TEST_F(MotionsOfATrueMap, AreAcceptedBetweenKeyframesWithFewCommonPoints) {
  const KeyframeId earlier = map_.keyframe_ids()[3], later = map_.keyframe_ids()[4];
  const auto seen_by = [&](const Observation& seen, KeyframeId id) { return seen.keyframe == id; };
  int shared = 0;
  for (const PointId point : map_.point_ids()) {
    const std::vector<Observation> observations = map_.observations(point);
    const auto of_later = std::ranges::find_if(observations, [&](const auto& seen) { return seen_by(seen, later); });
    const bool is_shared = of_later != observations.end() &&
                           std::ranges::any_of(observations, [&](const auto& seen) { return seen_by(seen, earlier); });
    if (is_shared && ++shared > 20) map_.remove_observation(*of_later);
  }
  ASSERT_GT(shared, 60);
  const auto motions = odometry_motions(map_, {earlier, later}, 0, odometry(3.0));
  ASSERT_THAT(motions, SizeIs(1));
  EXPECT_TRUE(motions.front().lacks_visual_constraint);
}

// After relocalisation at an old place, the points shared with the keyframe before are no evidence.
TEST_F(MotionsOfATrueMap, AreAcceptedIfTheLaterKeyframeWasTrackedFromElsewhere) {
  const MapGraph map =
      true_map(simulate_mission(one_camera(), circling_trajectory(120, 10.0, 2.0, 1.0), {}), 4, Origin::online);
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  MapGraph found_again(Origin::online);
  for (const PointId point : map.point_ids()) found_again.add_point(*map.find_point(point));
  for (const KeyframeId id : ids) {
    Keyframe keyframe = *map.find_keyframe(id);
    keyframe.rig = found_again.add_rig(one_camera());
    if (id == ids[16]) keyframe.parent = ids[1];
    found_again.add_keyframe(std::move(keyframe));
  }
  const auto wrong_odometry = [](Timestamp, Timestamp) { return std::optional(BodyMotion{Pose{{}, {9.0, 0.0, 0.0}}}); };
  EXPECT_THAT(odometry_motions(map, {ids[15], ids[16]}, 0, wrong_odometry), IsEmpty());
  EXPECT_THAT(odometry_motions(found_again, {ids[15], ids[16]}, 0, wrong_odometry), SizeIs(1));
}

TEST_F(MotionsOfATrueMap, AreScaledToTheMap) {
  const MapGraph map = true_map(mission_, 1, Origin::online);
  const auto motions = in_lengths_of(map, odometry_motions(map, map.keyframe_ids(), 0, odometry(1.03)));
  const auto exact = odometry_motions(map, map.keyframe_ids(), 0, odometry());
  ASSERT_THAT(motions, SizeIs(exact.size()));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Eigen::Vector3d& way = exact[i].motion.last_from_body.translation;
    EXPECT_LT((motions[i].motion.last_from_body.translation - way).norm(), 1e-3 * way.norm());
  }
}

TEST_F(MotionsOfATrueMap, AreAddedToAWindowWithBothKeyframes) {
  const std::vector<KeyframeId> ids = map_.keyframe_ids();
  MapWindow window = window_of(map_, {ids[2], ids[1], ids[5]});
  add_motions(window, odometry_motions(map_, ids, 0, odometry()));
  ASSERT_THAT(window.motions, SizeIs(1));
  EXPECT_EQ(window.keyframes[static_cast<std::size_t>(window.motions[0].earlier)].id, ids[1]);
  EXPECT_EQ(window.keyframes[static_cast<std::size_t>(window.motions[0].later)].id, ids[2]);
}

}  // namespace
}  // namespace byre
