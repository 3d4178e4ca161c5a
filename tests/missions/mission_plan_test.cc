#include "mission_plan.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

// Ten seconds at 10 Hz, from 100 s on.
std::vector<Timestamp> frame_times() {
  std::vector<Timestamp> times;
  for (int i = 0; i < 100; ++i) times.push_back(from_seconds(100.0) + i * std::chrono::milliseconds(100));
  return times;
}

// Writes the step into the first pixel.
ImageFrame mark(const ImageFrame& images, int step) {
  ImageFrame marked = images;
  marked.left.pixels.front() = static_cast<std::uint8_t>(step);
  return marked;
}

std::vector<int> disturbed_steps(const MissionPlan& plan) {
  std::vector<int> steps;
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    if (plan.steps[i].disturb) steps.push_back(static_cast<int>(i));
  }
  return steps;
}

TEST(MissionPlan, AsRecordedHasEveryFrameAtItsTime) {
  const MissionPlan plan = as_recorded(frame_times());
  ASSERT_EQ(plan.steps.size(), 100);
  EXPECT_EQ(plan.steps[42].frame, 42);
  EXPECT_EQ(plan.steps[42].time, frame_times()[42]);
  EXPECT_THAT(disturbed_steps(plan), testing::IsEmpty());
  EXPECT_EQ(plan.undisturbed_from, frame_times().front());
}

TEST(MissionPlan, DegradesTheGivenSpanOnly) {
  const MissionPlan plan = degraded(frame_times(), {3.0, 5.0}, mark);
  EXPECT_THAT(disturbed_steps(plan), testing::SizeIs(20));
  EXPECT_EQ(disturbed_steps(plan).front(), 30);
  EXPECT_EQ(plan.undisturbed_from, frame_times()[50]);
  const ImageFrame images{{}, {1, 1, {99}}, std::nullopt};
  EXPECT_EQ(plan.steps[30].disturb(images).left.pixels.front(), 0) << "steps count from the first degraded frame";
  EXPECT_EQ(plan.steps[49].disturb(images).left.pixels.front(), 19);
}

TEST(MissionPlan, ADegradationUntilTheEndNeverEnds) {
  EXPECT_FALSE(degraded(frame_times(), {8.0, 1000.0}, mark).undisturbed_from);
}

TEST(MissionPlan, AKidnappingLeavesTimesContinuous) {
  const MissionPlan plan = kidnapped(frame_times(), {1.0, 3.0}, {7.0, 9.0}, 0.0);
  ASSERT_EQ(plan.steps.size(), 40);
  EXPECT_EQ(plan.steps[19].frame, 29);
  EXPECT_EQ(plan.steps[20].frame, 70);
  EXPECT_EQ(plan.undisturbed_from, plan.steps[20].time);
  for (std::size_t i = 1; i < plan.steps.size(); ++i) {
    EXPECT_EQ(plan.steps[i].time - plan.steps[i - 1].time, std::chrono::milliseconds(100));
  }
  EXPECT_THAT(disturbed_steps(plan), testing::IsEmpty());
}

TEST(MissionPlan, AKidnappingMayBeDarkAndReturn) {
  const MissionPlan plan = kidnapped(frame_times(), {7.0, 9.0}, {1.0, 3.0}, 0.5);
  EXPECT_THAT(disturbed_steps(plan), testing::ElementsAre(15, 16, 17, 18, 19));
  EXPECT_EQ(plan.steps[20].frame, 10);
  EXPECT_GT(plan.steps[20].time, plan.steps[19].time);
}

}  // namespace
}  // namespace byre
