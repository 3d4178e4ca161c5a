#include "byre/playback/report/mission_report.h"

#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

PlayedFrame frame_with(int number, Verdict verdict, DistrustReason doubt, int offline_inliers) {
  FrameReport report;
  report.time = from_seconds(number);
  report.map_from_body = Pose{};
  report.health.verdict = verdict;
  report.health.doubt = doubt;
  report.health.offline_inliers = offline_inliers;
  report.health.online_inliers = 10;
  PlayedFrame frame;
  frame.time = report.time;
  frame.report = std::move(report);
  return frame;
}

// A frame without pose, two in a mapped place, one unreadable, and two in a changed place.
std::vector<PlayedFrame> mission() {
  std::vector<PlayedFrame> frames = {frame_with(0, Verdict::untrusted, DistrustReason::no_pose, 0),
                                     frame_with(1, Verdict::trusted, DistrustReason::none, 100),
                                     frame_with(2, Verdict::trusted, DistrustReason::none, 80),
                                     PlayedFrame{},
                                     frame_with(4, Verdict::degraded, DistrustReason::few_offline_points, 10),
                                     frame_with(5, Verdict::degraded, DistrustReason::few_offline_points, 25)};
  frames[0].report->map_from_body.reset();
  frames[3].time = from_seconds(3);
  return frames;
}

TEST(SummariseMission, CountsVerdictsDoubtsAndMissingFrames) {
  const MissionStatistics statistics = summarise_mission(mission(), 25);
  EXPECT_EQ(statistics.frames, 6);
  EXPECT_EQ(statistics.missing, 1);
  EXPECT_EQ(statistics.trusted, 2);
  EXPECT_EQ(statistics.degraded, 2);
  EXPECT_EQ(statistics.untrusted, 1);
  EXPECT_THAT(statistics.doubts,
              ElementsAre(Pair(DistrustReason::few_offline_points, 2), Pair(DistrustReason::no_pose, 1)));
}

TEST(SummariseMission, MeasuresTheTimeToTheFirstPose) {
  EXPECT_EQ(summarise_mission(mission(), 25).seconds_to_first_pose, 1.0);
  EXPECT_EQ(summarise_mission({mission().front()}, 25).seconds_to_first_pose, std::nullopt);
}

TEST(SummariseMission, CountsKeyframesInKnownAndOtherPlacesSeparately) {
  std::vector<PlayedFrame> frames = mission();
  for (const std::size_t i : {1, 4, 5}) frames[i].report->keyframe_added = true;
  const MissionStatistics statistics = summarise_mission(frames, 25);
  EXPECT_EQ(statistics.in_mapped_area.keyframes, 2);
  EXPECT_NEAR(statistics.in_mapped_area.minutes, 3.0 / 60.0, 1e-9) << "frames 1, 2 and 5";
  EXPECT_EQ(statistics.in_changed_or_new.keyframes, 1);
  EXPECT_NEAR(statistics.in_changed_or_new.per_minute(), 60.0, 1e-9);
  EXPECT_EQ(KeyframeRate{}.per_minute(), 0.0);
}

TEST(SummariseMission, CountsLossesAndRelocalisations) {
  std::vector<PlayedFrame> frames = mission();
  frames[2].report->events = {SessionEvent::blinded, SessionEvent::pose_lost};
  frames[4].report->events = {SessionEvent::navigation_error};
  frames[5].report->events = {SessionEvent::relocalised};
  const MissionStatistics statistics = summarise_mission(frames, 25);
  EXPECT_EQ(statistics.losses, 1);
  EXPECT_EQ(statistics.navigation_errors, 1);
  EXPECT_EQ(statistics.relocalisations, 1);
}

TEST(SummariseMission, UsesInliersOfFramesWithPose) {
  std::vector<PlayedFrame> frames = mission();
  frames[2].report->health.suspended = 7;
  const MissionStatistics statistics = summarise_mission(frames, 25);
  EXPECT_EQ(statistics.offline_inliers.median, 52.5);
  EXPECT_EQ(statistics.online_inliers.median, 10.0);
  EXPECT_EQ(statistics.max_suspended, 7);
}

TEST(SummariseMission, ReportsTooManyMissingFrames) {
  MissionStatistics statistics;
  EXPECT_FALSE(misses_too_many_frames(statistics));
  statistics.frames = 100;
  statistics.missing = 5;
  EXPECT_FALSE(misses_too_many_frames(statistics));
  statistics.missing = 6;
  EXPECT_TRUE(misses_too_many_frames(statistics));
}

TEST(SummariseMission, IsEmptyForNoFrames) {
  const MissionStatistics statistics = summarise_mission({}, 25);
  EXPECT_EQ(statistics.frames, 0);
  EXPECT_THAT(statistics.doubts, IsEmpty());
}

}  // namespace
}  // namespace byre
