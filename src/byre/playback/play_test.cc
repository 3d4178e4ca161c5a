#include "byre/playback/play.h"

#include "byre/playback/frame_source.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/slam.h"
#include "byre/trajectory_error.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Gt;
using testing::SizeIs;

RunResult run(const RenderedFixture& rendered, Pace pace, int stop_after = 1000) {
  const auto recording = open_recording(rendered.folder(), {});
  SlamOptions options;
  options.settings = {{"pace", std::string(name_of(pace))}};
  Slam slam = Slam::mapping(recording->calibration(), options);
  int frames_done = 0;
  PlayHooks hooks;
  hooks.should_stop = [&] { return frames_done == stop_after; };
  hooks.after_frame = [&frames_done](int done, const PlayedFrame&) { frames_done = done; };
  return play(slam, *recording, hooks);
}

double error_m(const Trajectory& estimate, const Trajectory& truth) {
  const auto error = absolute_trajectory_error(associate(estimate, truth, {}), Scale::fixed);
  return error ? error->translation.rmse : -1.0;
}

std::vector<Eigen::Vector3d> positions(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> positions;
  for (const StampedPose& sample : trajectory) positions.push_back(sample.world_from_body.translation);
  return positions;
}

TEST(Play, TracksARecordingInEveryPace) {
  const RenderedFixture& rendered = RenderedFixture::shared();
  for (const Pace pace : {Pace::same_thread, Pace::paced, Pace::live}) {
    SCOPED_TRACE(name_of(pace));
    const RunResult mapped = run(rendered, pace);
    EXPECT_THAT(mapped.frames, SizeIs(rendered.truth().size()));
    EXPECT_THAT(mapped.causal, SizeIs(rendered.truth().size()));
    EXPECT_THAT(mapped.final, SizeIs(rendered.truth().size()));
    EXPECT_LT(error_m(mapped.causal, rendered.truth()), 0.1);
    EXPECT_LT(error_m(mapped.final, rendered.truth()), 0.1);
    EXPECT_GT(mapped.stored.map.keyframe_count(), 1);
    EXPECT_GT(mapped.stored.map.point_count(), 100);
    EXPECT_FALSE(mapped.job_seconds.empty());
    ASSERT_TRUE(mapped.finishing);
    EXPECT_FALSE(mapped.finishing->cut_short);
    EXPECT_THAT(mapped.finishing->faults, SizeIs(0));
    EXPECT_EQ(mapped.finishing->report.after.keyframes, mapped.stored.map.keyframe_count());
  }
}

TEST(Play, ReportsEachFrameWithItsPoints) {
  const auto recording = open_recording(RenderedFixture::shared().folder(), {});
  PlayHooks hooks;
  hooks.should_stop = [] { return false; };
  hooks.after_frame = [](int, const PlayedFrame&) {};
  int looks = 0;
  hooks.on_frame = [&looks](const RunView& view) {
    ++looks;
    EXPECT_EQ(view.images.time, view.frame.time);
    const std::vector<SeenPoint>& seen = view.session.seen_points();
    EXPECT_EQ(std::ranges::count_if(seen, &SeenPoint::is_inlier), view.frame.report->inliers);
  };
  Slam slam = Slam::mapping(recording->calibration());
  const RunResult mapped = play(slam, *recording, hooks);
  EXPECT_EQ(looks, static_cast<int>(mapped.frames.size()));
}

TEST(Play, IsDeterministicWhenPaced) {
  const RunResult first = run(RenderedFixture::shared(), Pace::paced);
  const RunResult second = run(RenderedFixture::shared(), Pace::paced);
  EXPECT_EQ(positions(first.causal), positions(second.causal));
  EXPECT_EQ(positions(first.final), positions(second.final));
}

bool same(const Trajectory& first, const Trajectory& second) {
  return std::ranges::equal(first, second, [](const StampedPose& a, const StampedPose& b) {
    return a.time == b.time && a.world_from_body == b.world_from_body;
  });
}

TEST(Play, EqualsThePosesOfSlam) {
  const RunResult mapped = run(RenderedFixture::shared(), Pace::paced);
  const auto recording = open_recording(RenderedFixture::shared().folder(), {});
  SlamOptions options;
  options.workers = Workers::repeatable;
  Slam slam = Slam::mapping(recording->calibration(), options);
  Trajectory causal;
  for (int i = 0; i < recording->size(); ++i) {
    const ImageFrame frame = recording->read(i).value();
    const FrameReport report = slam.process(view_of(frame));
    if (report.map_from_body) causal.push_back({report.time, *report.map_from_body});
  }
  slam.finish();
  EXPECT_TRUE(same(causal, mapped.causal));
  EXPECT_TRUE(same(slam.trajectory(), mapped.final));
  EXPECT_EQ(slam.keyframes(), mapped.stored.map.keyframe_count());
  EXPECT_EQ(slam.points(), mapped.stored.map.point_count());
}

TEST(Play, ReportsTheFrameOfAJobOnTheSameThread) {
  const RunResult mapped = run(RenderedFixture::shared(), Pace::same_thread);
  int taken_over = 0;
  for (std::size_t i = 1; i < mapped.frames.size(); ++i) {
    const std::optional<double> job_before = mapped.frames[i].report->job_seconds;
    const StageSeconds& before = mapped.frames[i - 1].seconds;
    EXPECT_GE(before.map_submit, job_before.value_or(0.0));
    EXPECT_GE(before.map, before.map_submit);
    EXPECT_GE(before.total, before.map + before.track);
    taken_over += job_before ? 1 : 0;
  }
  EXPECT_GT(taken_over, 0);
}

TEST(Play, StopsAfterTheCurrentFrame) {
  const RunResult mapped = run(RenderedFixture::shared(), Pace::paced, 5);
  EXPECT_THAT(mapped.frames, SizeIs(5));
  EXPECT_THAT(mapped.causal, SizeIs(5));
  EXPECT_THAT(mapped.final, SizeIs(5));
  EXPECT_FALSE(mapped.finishing) << "a stopped run is saved soon";
}

TEST(Play, InterruptsFinishingWhenStopped) {
  const auto recording = open_recording(RenderedFixture::shared().folder(), {.last = 6});
  SlamOptions options;
  options.workers = Workers::repeatable;
  Slam slam = Slam::mapping(recording->calibration(), options);
  bool stopped = false;
  PlayHooks hooks;
  hooks.should_stop = [&stopped] { return stopped; };
  hooks.after_frame = [](int, const PlayedFrame&) {};
  hooks.before_finishing_step = [&stopped](const char*) { stopped = true; };
  const RunResult mapped = play(slam, *recording, hooks);
  ASSERT_TRUE(mapped.finishing);
  EXPECT_TRUE(mapped.finishing->cut_short);
  EXPECT_THAT(mapped.final, SizeIs(6));
}

TEST(Play, OffersTheMapFromTheFirstPose) {
  const auto recording = open_recording(RenderedFixture::shared().folder(), {.last = 6});
  std::vector<int> keyframes;
  PlayHooks hooks;
  hooks.should_stop = [] { return false; };
  hooks.after_frame = [](int, const PlayedFrame&) {};
  hooks.on_map_update = [&keyframes](const SlamImpl& slam) { keyframes.push_back(slam.online().keyframe_count()); };
  SlamOptions options;
  options.settings = {{"loops.close", "false"}};
  Slam slam = Slam::mapping(recording->calibration(), options);
  const RunResult mapped = play(slam, *recording, hooks);
  EXPECT_THAT(keyframes, SizeIs(6));
  EXPECT_THAT(keyframes, Each(Gt(0)));
  EXPECT_FALSE(mapped.finishing) << "no places were recognised";
}

TEST(Play, ContinuesAfterDamagedOrMissingImages) {
  const RenderedFixture damaged("byre_damaged_room", 12, 20.0);
  std::filesystem::resize_file(damaged.image("cam0", 4), 100);
  std::filesystem::remove(damaged.image("cam1", 7));
  const RunResult mapped = run(damaged, Pace::same_thread);
  EXPECT_THAT(mapped.frames, SizeIs(12));
  EXPECT_EQ(std::ranges::count_if(mapped.frames, [](const PlayedFrame& frame) { return !frame.report; }), 1);
  EXPECT_FALSE(mapped.frames[4].report);
  EXPECT_FALSE(mapped.frames[7].has_right);
  EXPECT_THAT(mapped.warnings, SizeIs(2));
  EXPECT_THAT(mapped.final, SizeIs(11));
}

// Frames of a recording, of which one comes twice and one has a smaller left image.
class FaultyFrames final : public FrameSource {
 public:
  explicit FaultyFrames(Recording& recording) : recording_(recording) {}

  const Calibration& calibration() const override { return recording_.calibration(); }
  std::optional<SourceFrame> next(const std::function<bool()>&) override {
    if (given_ == 8) return std::nullopt;
    SourceFrame frame;
    frame.decoded.images = recording_.read(given_ == 3 ? 2 : given_);
    frame.decoded.time = frame.decoded.images->time;
    if (given_ == 5) frame.decoded.images->left = Image{4, 4, std::vector<std::uint8_t>(16)};
    ++given_;
    return frame;
  }

 private:
  Recording& recording_;
  int given_ = 0;
};

TEST(Play, SkipsFramesThatSlamDrops) {
  const auto recording = open_recording(RenderedFixture::shared().folder(), {});
  SlamOptions options;
  options.workers = Workers::none;
  Slam slam = Slam::mapping(recording->calibration(), options);
  FaultyFrames frames(*recording);
  PlayHooks hooks;
  hooks.should_stop = [] { return false; };
  hooks.after_frame = [](int, const PlayedFrame&) {};
  std::vector<Timestamp> seen;
  hooks.on_frame = [&seen](const RunView& view) { seen.push_back(view.frame.time); };
  const RunResult run = play(slam, frames, hooks);
  EXPECT_THAT(run.frames, SizeIs(8));
  EXPECT_FALSE(run.frames[3].report);
  EXPECT_FALSE(run.frames[5].report);
  EXPECT_EQ(run.frames[5].seconds.total, 0.0);
  EXPECT_THAT(seen, SizeIs(6));
  EXPECT_THAT(run.causal, SizeIs(6));
  EXPECT_THAT(run.warnings, ElementsAre("frame 3 is skipped: time stamp repeats the previous frame",
                                        "frame 5 is skipped: image does not have the calibrated size"));
  const auto jobs = std::ranges::count_if(
      run.frames, [](const PlayedFrame& frame) { return frame.report && frame.report->job_seconds; });
  EXPECT_GE(static_cast<int>(run.job_seconds.size()), jobs);
  EXPECT_LE(static_cast<int>(run.job_seconds.size()), jobs + 1);
}

TEST(Play, CountsLateFramesOnlyWhenLive) {
  EXPECT_THAT(run(RenderedFixture::shared(), Pace::paced).lateness, SizeIs(0));
  EXPECT_THAT(run(RenderedFixture::shared(), Pace::live).lateness, Each(Gt(0.0)));
}

}  // namespace
}  // namespace byre
