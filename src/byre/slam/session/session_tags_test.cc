#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/session/mission_session_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

// Twin rooms 10 m apart with a tag in the second one, and frames of a lap in it that show the tag every third time.
struct TagInTwinRooms {
  TagInTwinRooms() {
    MappedPlace place = twin_rooms(laps_of_room(1.0, 1));
    std::vector<MappedTag> tags{tag};
    tags.front().map_from_tag = room * tag.map_from_tag;
    offline = std::make_shared<const OfflineMap>(std::move(place.map), place.index.vocabulary(),
                                                 std::vector<SourceRecording>{}, std::nullopt, OdometryCalibration{},
                                                 std::move(tags));
    for (std::size_t i = 0; i < frames.size(); i += 3) {
      frames[i] = with_tag(frames[i], tag, true_camera_from_world(lap, i), lap.rig);
    }
    for (StampedPose& pose : truth) pose.world_from_body = room * pose.world_from_body;
  }
  Session session() const {
    return {lap.rig,
            {},
            SessionExecutors(make_inline_executor(), make_inline_executor()),
            offline->places().vocabulary(),
            offline};
  }

  const Pose room{Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0}};
  const SimulatedMission lap = laps_of_room(0.25, 2);
  const MappedTag tag = tag_before(true_camera_from_world(lap, 0));
  std::vector<Frame> frames = lap.frames;
  Trajectory truth = lap.truth;
  std::shared_ptr<const OfflineMap> offline;
};

TEST(MissionWithTags, DecidesBetweenTwinRoomsInTheFirstFrame) {
  const TagInTwinRooms scene;
  Session session = scene.session();
  const auto reports = reports_of(session, scene.frames);
  ASSERT_TRUE(reports[0].map_from_body);
  EXPECT_THAT(*reports[0].map_from_body, PoseNear(scene.truth[0].world_from_body, 0.03, 0.3 * kDegree));
  EXPECT_EQ(reports[5].health.verdict, Verdict::trusted) << to_string(reports[5].health.doubt);
  EXPECT_LT(worst_trusted(reports, scene.truth), 0.03);
}

TEST(MissionWithTags, TrustsNoTwinRoomWithoutTheTag) {
  TagInTwinRooms scene;
  for (Frame& frame : scene.frames) frame.tags.clear();
  Session session = scene.session();
  EXPECT_EQ(count_trusted(reports_of(session, scene.frames)), 0);
}

std::vector<FrameReport> reports_of_lap_without_tags(const SimulatedMission& lap) {
  Session session = session_on(mapped(1.0));
  return reports_of(session, lap.frames);
}

// Offline map of a room with a tag.
std::shared_ptr<const OfflineMap> room_with(const MappedTag& tag) {
  return std::make_shared<const OfflineMap>(mapped(1.0)->map(), simulated_vocabulary(), std::vector<SourceRecording>{},
                                            std::nullopt, OdometryCalibration{}, std::vector<MappedTag>{tag});
}

// Frames of a lap that show a tag in every second frame from the seventh on.
std::vector<Frame> frames_with(const SimulatedMission& lap, const MappedTag& tag) {
  std::vector<Frame> frames = lap.frames;
  for (std::size_t i = 6; i < frames.size(); i += 2) {
    frames[i] = with_tag(frames[i], tag, true_camera_from_world(lap, i), lap.rig);
  }
  return frames;
}

TEST(MissionWithTags, ReportsAMovedTagOnceAndIgnoresIt) {
  const SimulatedMission lap = laps_of_room(0.25, 2);
  const MappedTag seen = tag_before(true_camera_from_world(lap, 6));
  MappedTag before = seen;
  before.map_from_tag.translation += Eigen::Vector3d(0.3, 0.2, 0.1);
  const std::vector<Frame> frames = frames_with(lap, seen);
  const auto shows_tag = [](const Frame& frame) { return !frame.tags.empty(); };
  ASSERT_GE(std::ranges::count_if(frames, shows_tag), 4);
  Session session = session_on(room_with(before));
  const auto reports = reports_of(session, frames);
  EXPECT_EQ(count(reports, SessionEvent::tag_moved), 1);
  const auto report =
      std::ranges::find_if(reports, [](const FrameReport& each) { return each.has(SessionEvent::tag_moved); });
  ASSERT_THAT(report->moved_tags, testing::SizeIs(1));
  EXPECT_EQ(report->moved_tags[0].id, seen.id);
  EXPECT_THAT(report->moved_tags[0].map_from_tag.translation, PointNear(seen.map_from_tag.translation, 0.03));
  EXPECT_EQ(report - reports.begin(), 10) << "third detection";
  EXPECT_EQ(count_trusted(reports), count_trusted(reports_of_lap_without_tags(lap)));
  EXPECT_LT(worst_trusted(reports, lap.truth), 0.03);
}

TEST(MissionWithTags, TrustsNoPoseByATagOfAnotherPlaceOrSize) {
  const SimulatedMission lap = laps_of_room(0.25, 2);
  const MappedTag seen = tag_before(true_camera_from_world(lap, 0));
  std::vector<Frame> frames = lap.frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = with_tag(frames[i], seen, true_camera_from_world(lap, i), lap.rig);
  }
  const int trusted = count_trusted(reports_of_lap_without_tags(lap));
  for (const auto& [shift, scale] : {std::pair(Eigen::Vector3d(2.0, 1.0, 0.0), 1.0),
                                     {{0.0, 0.0, -0.4}, 1.0},
                                     {{0.0, 0.0, 0.0}, 1.3},
                                     {{0.0, 0.0, 0.0}, 0.7}}) {
    MappedTag wrong = seen;
    wrong.map_from_tag.translation += shift;
    wrong.size *= scale;
    Session session = session_on(room_with(wrong));
    const auto reports = reports_of(session, frames);
    EXPECT_LT(worst_trusted(reports, lap.truth), 0.03) << shift.transpose() << " size " << scale;
    EXPECT_GE(count_trusted(reports), trusted - 2) << shift.transpose() << " size " << scale;
  }
}

}  // namespace
}  // namespace byre
