#include "byre/playback/report/map_statistics.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

PlayedFrame frame_in(State state) {
  PlayedFrame frame;
  frame.has_right = true;
  frame.report.emplace();
  frame.report->state = state;
  if (state == State::tracking) frame.report->map_from_body = Pose{};
  return frame;
}

TEST(SummariseTimes, GivesMillisecondsInAnyOrder) {
  std::vector<double> seconds;
  for (int i = 100; i >= 0; --i) seconds.push_back(1e-3 * i);
  const Distribution summary = summarise_times(seconds);
  EXPECT_EQ(summary.count, 101);
  EXPECT_NEAR(summary.mean, 50.0, 1e-9);
  EXPECT_NEAR(summary.p50, 50.0, 1e-9);
  EXPECT_NEAR(summary.p95, 95.0, 1e-9);
  EXPECT_NEAR(summary.p99, 99.0, 1e-9);
  EXPECT_NEAR(summary.max, 100.0, 1e-9);
}

TEST(SummariseTimes, InterpolatesPercentilesOfFewTimes) {
  const Distribution summary = summarise_times({0.001, 0.003});
  EXPECT_NEAR(summary.p50, 2.0, 1e-9);
  EXPECT_NEAR(summary.p99, 2.98, 1e-9);
  EXPECT_NEAR(summarise_times({0.004}).p95, 4.0, 1e-9);
}

TEST(SummariseTimes, IsZeroForNothing) {
  const Distribution summary = summarise_times({});
  EXPECT_EQ(summary.count, 0);
  EXPECT_EQ(summary.max, 0.0);
}

TEST(SummariseStage, SkipsUnprocessedFrames) {
  std::vector<PlayedFrame> frames(3, frame_in(State::tracking));
  frames[0].seconds.track = 0.010;
  frames[1].report.reset();
  frames[2].seconds.track = 0.020;
  const Distribution track = summarise_stage(frames, &StageSeconds::track);
  EXPECT_EQ(track.count, 2);
  EXPECT_NEAR(track.mean, 15.0, 1e-9);
}

TEST(SummariseWithoutJobs, SubtractsTheTimeOfSubmittedJobs) {
  PlayedFrame frame = frame_in(State::tracking);
  frame.seconds.total = 0.100;
  frame.seconds.map_submit = 0.080;
  EXPECT_NEAR(summarise_without_jobs({frame}).max, 20.0, 1e-9);
}

TEST(CountFrames, CountsLostEpisodesAndTheirFrames) {
  std::vector<PlayedFrame> frames;
  for (const State state : {State::initialising, State::tracking, State::relocalising, State::lost, State::tracking,
                            State::relocalising, State::tracking, State::tracking}) {
    frames.push_back(frame_in(state));
  }
  frames[6].report->events.push_back(SessionEvent::restarted);
  const FrameCounts counts = count_frames(frames);
  EXPECT_EQ(counts.frames, 8);
  EXPECT_EQ(counts.with_pose, 4);
  EXPECT_EQ(counts.lost_episodes, 2);
  EXPECT_EQ(counts.lost, 3);
  EXPECT_EQ(counts.resets, 1);
  EXPECT_DOUBLE_EQ(counts.coverage(), 4.0 / 8.0);
}

TEST(CountFrames, CountsUnreadableFramesSeparately) {
  std::vector<PlayedFrame> frames(5, frame_in(State::lost));
  frames[2].report.reset();
  frames[3].has_right = false;
  const FrameCounts counts = count_frames(frames);
  EXPECT_EQ(counts.unreadable, 1);
  EXPECT_EQ(counts.without_right_image, 1);
  EXPECT_EQ(counts.lost, 4);
  EXPECT_EQ(counts.lost_episodes, 1);
}

TEST(CountFrames, CountsMapEvents) {
  std::vector<PlayedFrame> frames(4, frame_in(State::tracking));
  frames[0] = frame_in(State::lost);
  frames[1].report->events.push_back(SessionEvent::relocalised);
  frames[2].report->events.push_back(SessionEvent::loop_found);
  frames[3].report->events.push_back(SessionEvent::map_corrected);
  const FrameCounts counts = count_frames(frames);
  EXPECT_EQ(counts.relocalisations, 1);
  EXPECT_EQ(counts.loops, 1);
  EXPECT_EQ(counts.corrections, 1);
  EXPECT_EQ(counts.frames_to_first, 1);
  EXPECT_EQ(count_frames({frame_in(State::lost)}).frames_to_first, std::nullopt);
}

TEST(CountFrames, HasZeroCoverageWithoutFrames) {
  EXPECT_EQ(count_frames({}).coverage(), 0.0);
}

}  // namespace
}  // namespace byre
