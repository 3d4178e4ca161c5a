#include "byre/io/recording/restored_times.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""us;
using Times = std::vector<Timestamp>;

constexpr Timestamp kStart = std::chrono::seconds(1'700'000'000);
constexpr Timestamp kInterval = 50ms;

// True times of items.
Times steady(int count, Timestamp interval = kInterval) {
  Times times;
  for (int i = 0; i < count; ++i) times.push_back(kStart + i * interval);
  return times;
}

// Receive times, with a latency that varies by some milliseconds.
Times received_of(const Times& taken, Timestamp latency = 20ms) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> jitter(0, 8000);
  Times received;
  for (const Timestamp time : taken) received.push_back(time + latency + std::chrono::microseconds(jitter(random)));
  std::ranges::sort(received);
  return received;
}

Times with_step(Times stamps, std::size_t from, Timestamp by) {
  for (std::size_t i = from; i < stamps.size(); ++i) stamps[i] += by;
  return stamps;
}

std::vector<std::size_t> counted(std::size_t count) {
  std::vector<std::size_t> items(count);
  std::iota(items.begin(), items.end(), std::size_t{0});
  return items;
}

Timestamp worst_error(const Times& times, const Times& taken) {
  Timestamp worst{};
  for (std::size_t i = 0; i < std::min(times.size(), taken.size()); ++i) {
    worst = std::max(worst, Timestamp(std::chrono::abs(times[i] - taken[i])));
  }
  return worst;
}

// Expects all items in the order of recording, at their true times within the tolerance.
void expect_restored(const RestoredTimes& restored, const Times& taken, Timestamp tolerance) {
  EXPECT_EQ(restored.items, counted(taken.size()));
  ASSERT_THAT(restored.times, SizeIs(taken.size()));
  EXPECT_LE(worst_error(restored.times, taken), tolerance);
  for (std::size_t i = 1; i < taken.size(); ++i) EXPECT_GT(restored.times[i], restored.times[i - 1]) << i;
}

TEST(RestoredTimes, KeepAscendingStamps) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> interval(1, 200'000);  // microseconds
  Times stamps = {kStart};
  for (int i = 0; i < 500; ++i) stamps.push_back(stamps.back() + std::chrono::microseconds(interval(random)));
  stamps.push_back(stamps.back() + 90s);  // a pause
  stamps.push_back(stamps.back() + 10ms);
  for (const Times& received : {Times(), received_of(stamps), received_of(stamps, 2s)}) {
    const RestoredTimes restored = restore_times({stamps, received});
    EXPECT_EQ(restored.times, stamps);
    EXPECT_FALSE(restored.corrections.any());
  }
}

TEST(RestoredTimes, AcceptAStartAtZero) {
  const RestoredTimes restored = restore_times({{0ms, 103ms, 207ms, 310ms, 415ms}});
  EXPECT_THAT(restored.times, ElementsAre(0ms, 103ms, 207ms, 310ms, 415ms));
  EXPECT_FALSE(restored.corrections.any());
}

TEST(RestoredTimes, AreEmptyWithoutItems) {
  EXPECT_THAT(restore_times({}).times, IsEmpty());
}

class SteppedClock : public testing::TestWithParam<Timestamp> {};

TEST_P(SteppedClock, ContinuesByTheRecordingOrderAlone) {
  const Times taken = steady(140);
  const RestoredTimes restored = restore_times({with_step(taken, 70, -GetParam())});
  expect_restored(restored, taken, 1us);
  ASSERT_THAT(restored.corrections.clock_steps, SizeIs(1));
  EXPECT_EQ(restored.corrections.clock_steps[0].frame, 70);
  EXPECT_EQ(restored.corrections.clock_steps[0].by, -GetParam());
  EXPECT_EQ(restored.corrections.late + restored.corrections.repeated, 0);
}

TEST_P(SteppedClock, ContinuesAcrossALostItemByReceiveTimes) {
  Times taken = steady(140), received = received_of(taken);
  taken.erase(taken.begin() + 70);
  received.erase(received.begin() + 70);
  const RestoredTimes restored = restore_times({with_step(taken, 70, -GetParam()), received});
  expect_restored(restored, taken, 1us);
  EXPECT_THAT(restored.corrections.clock_steps, SizeIs(1));
}

INSTANTIATE_TEST_SUITE_P(Steps, SteppedClock,
                         testing::Values(110ms, 173ms, 250ms, 400ms, 620ms, 1s, 3s, 3s + 17ms, 3600s, 1'700'000s));

TEST(RestoredTimes, ContinueAcrossAShortStepSeenInReceiveTimes) {
  const Times taken = steady(140);
  const RestoredTimes restored = restore_times({with_step(taken, 70, -62ms), received_of(taken)});
  expect_restored(restored, taken, 1us);
}

TEST(RestoredTimes, ContinueWithJitteryStamps) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> jitter(-6000, 6000);
  Times taken = steady(140);
  for (Timestamp& time : taken) time += std::chrono::microseconds(jitter(random));
  expect_restored(restore_times({with_step(taken, 70, -620ms)}), taken, 13ms);
  expect_restored(restore_times({with_step(taken, 70, -620ms), received_of(taken)}), taken, 13ms);
}

TEST(RestoredTimes, ContinueAcrossManySteps) {
  const Times taken = steady(200);
  const Times stamps = with_step(with_step(with_step(taken, 50, -620ms), 100, -2s), 150, -300ms);
  const RestoredTimes restored = restore_times({stamps});
  expect_restored(restored, taken, 1us);
  EXPECT_THAT(restored.corrections.clock_steps, SizeIs(3));
}

TEST(RestoredTimes, ContinueARecordingOfALoop) {
  const Times taken = steady(180);
  Times stamps;
  for (std::size_t i = 0; i < taken.size(); ++i) stamps.push_back(taken[i % 60]);
  const RestoredTimes restored = restore_times({stamps, received_of(taken)});
  expect_restored(restored, taken, 1us);
  EXPECT_THAT(restored.corrections.clock_steps, SizeIs(2));
  expect_restored(restore_times({stamps}), taken, 1us);
}

TEST(RestoredTimes, ContinueAcrossAForwardStepByReceiveTimes) {
  const Times taken = steady(140);
  const Times stamps = with_step(taken, 70, 5s);
  const RestoredTimes restored = restore_times({stamps, received_of(taken)});
  expect_restored(restored, taken, 1us);
  ASSERT_THAT(restored.corrections.clock_steps, SizeIs(1));
  EXPECT_EQ(restored.corrections.clock_steps[0].by, Timestamp(5s));
  EXPECT_EQ(restore_times({stamps, received_of(stamps)}).times, stamps) << "a pause";
  EXPECT_EQ(restore_times({stamps}).times, stamps) << "perhaps a pause";
}

TEST(RestoredTimes, KeepABurstAfterAStall) {
  Times stamps = steady(200);
  stamps.erase(stamps.begin() + 110, stamps.begin() + 150);  // lost during the stall
  Times received = received_of(stamps);
  for (std::size_t i = 100; i < 110; ++i) received[i] = received[110] - 1ms;  // ten delayed ones
  const RestoredTimes restored = restore_times({stamps, received});
  EXPECT_EQ(restored.times, stamps);
  EXPECT_FALSE(restored.corrections.any());
}

TEST(RestoredTimes, SortLateItems) {
  const Times taken = steady(60);
  for (const bool has_reception : {false, true}) {
    Times stamps = taken;
    std::swap(stamps[20], stamps[21]);                                           // overtaken by one
    std::rotate(stamps.begin() + 40, stamps.begin() + 41, stamps.begin() + 45);  // overtaken by four
    const RestoredTimes restored = restore_times({stamps, has_reception ? received_of(taken) : Times()});
    EXPECT_EQ(restored.times, taken);
    EXPECT_EQ(restored.items[20], 21u);
    EXPECT_EQ(restored.items[40], 44u);
    EXPECT_EQ(restored.corrections.late, 2);
    EXPECT_THAT(restored.corrections.clock_steps, IsEmpty());
  }
}

TEST(RestoredTimes, SortPieces) {
  const Times taken = steady(90);
  Times stamps = taken;
  std::rotate(stamps.begin(), stamps.begin() + 30, stamps.begin() + 60);
  EXPECT_EQ(restore_times({stamps}).times, taken) << "the second third before the first";
  stamps = taken;
  std::ranges::rotate(stamps, stamps.begin() + 30);
  EXPECT_EQ(restore_times({stamps}).times, taken) << "the first third last";
}

TEST(RestoredTimes, SortAnUnorderedList) {
  Times stamps = steady(100);
  std::ranges::shuffle(stamps, std::mt19937(5));
  EXPECT_EQ(restore_times({stamps}).times, steady(100));
  std::ranges::sort(stamps, std::ranges::greater());
  EXPECT_EQ(restore_times({stamps}).times, steady(100));
}

TEST(RestoredTimes, InterpolateZeroAndWrongStamps) {
  const Times taken = steady(60);
  for (const Timestamp wrong : {Timestamp(0ms), Timestamp(3s), kStart + 5000s, kStart - 100s, Timestamp::max()}) {
    for (const std::size_t first : {0u, 25u, 57u}) {
      if (wrong != Timestamp{} && first != 25) continue;
      Times stamps = taken;
      for (std::size_t i = first; i < first + 3; ++i) stamps[i] = wrong;
      for (const bool has_reception : {false, true}) {
        const RestoredTimes restored = restore_times({stamps, has_reception ? received_of(taken) : Times()});
        expect_restored(restored, taken, 1us);
        EXPECT_EQ(restored.corrections.unstamped, 3) << wrong.count() << " at " << first;
        EXPECT_THAT(restored.corrections.clock_steps, IsEmpty());
      }
    }
  }
}

TEST(RestoredTimes, FollowTheCertainOrder) {
  Times stamps = steady(40);
  stamps[20] = stamps[10] + 20ms;
  const RestoredTimes restored = restore_times({.stamps = stamps, .is_order_certain = true});
  expect_restored(restored, steady(40), 1us);
  EXPECT_EQ(restored.corrections.unstamped, 1);
}

Times of_whole_seconds(Times stamps) {
  for (Timestamp& stamp : stamps) stamp -= stamp % std::chrono::seconds(1);
  return stamps;
}

TEST(RestoredTimes, UseReceiveTimesForStampsInWholeSeconds) {
  const Times taken = steady(60), received = received_of(taken);
  const RestoredTimes restored = restore_times({of_whole_seconds(taken), received});
  EXPECT_EQ(restored.times, received);
  EXPECT_EQ(restored.corrections.source, TimeSource::receive_times);
  EXPECT_EQ(restored.corrections.repeated, 0);
}

TEST(RestoredTimes, SpreadItemsEvenlyWithoutReceiveTimes) {
  Times taken = steady(67);
  for (Timestamp& time : taken) time += 350ms;  // begins and ends within a second
  for (const Times& received : {Times(), of_whole_seconds(taken)}) {
    const RestoredTimes restored = restore_times({of_whole_seconds(taken), received});
    expect_restored(restored, taken, kInterval);
    EXPECT_EQ(restored.corrections.source, TimeSource::even_spacing);
  }
}

TEST(RestoredTimes, KeepTheFirstOfRepeatedItems) {
  Times stamps, received;
  for (const Timestamp time : steady(30)) {
    stamps.insert(stamps.end(), {time, time});
    received.insert(received.end(), {time + 20ms, time + 21ms});
  }
  const RestoredTimes restored = restore_times({stamps, received});
  EXPECT_EQ(restored.times, steady(30));
  EXPECT_EQ(restored.corrections.repeated, 30);
  EXPECT_EQ(restored.corrections.source, TimeSource::stamps);
}

TEST(RestoredTimes, KeepOneItemIfAllStampsAreEqual) {
  EXPECT_THAT(restore_times({Times(20, kStart)}).items, SizeIs(1));
  EXPECT_THAT(restore_times({Times(20, Timestamp{})}).items, SizeIs(1));
  EXPECT_EQ(restore_times({Times(20, Timestamp{}), steady(20)}).times, steady(20));
}

// Wheels at 100 Hz and images at 20 Hz with one clock, which steps between two items of each.
class TwoSensors : public testing::Test {
 protected:
  static Times stepped(const Times& taken) {
    Times stamps = taken;
    for (Timestamp& stamp : stamps) stamp += stamp >= kSet ? kBy : Timestamp{};
    return stamps;
  }
  static constexpr Timestamp kSet = kStart + 3487ms, kBy = -620ms;
};

TEST_F(TwoSensors, StaySynchronisedOnASharedClock) {
  Times images = steady(140), wheels = steady(700, 10ms);
  for (const bool has_reception : {false, true}) {
    if (has_reception) images.erase(images.begin() + 70);  // lost just after the step
    const auto reception = [&](const Times& taken) { return has_reception ? received_of(taken) : Times(); };
    const RestoredTimes of_images = restore_times({stepped(images), reception(images)});
    const RestoredTimes of_wheels = restore_times({stepped(wheels), reception(wheels)}, of_images.clock);
    ASSERT_THAT(of_wheels.times, SizeIs(700));
    EXPECT_EQ(of_images.times.back() - of_wheels.times.back(), images.back() - wheels.back());
  }
}

TEST_F(TwoSensors, AreUnchangedOnDifferentClocks) {
  const Times images = steady(140), wheels = steady(700, 10ms);
  const RestoredTimes of_images = restore_times({stepped(images), received_of(images)});
  EXPECT_EQ(restore_times({wheels, received_of(wheels)}, of_images.clock).times, wheels);
}

TEST_F(TwoSensors, StaySynchronisedAcrossAStepShorterThanAnInterval) {
  const Times images = steady(140), slow = steady(20, 350ms);
  Times stamps = slow;
  for (Timestamp& stamp : stamps) stamp += stamp >= kSet ? -173ms : Timestamp{};
  const RestoredTimes of_images = restore_times({with_step(images, 70, -173ms), received_of(images)});
  const RestoredTimes of_slow = restore_times({stamps, received_of(slow)}, of_images.clock);
  EXPECT_LE(worst_error(of_slow.times, slow), 1us);
}

TEST(TimeCorrections, AreDescribedWithTheirEffect) {
  TimeCorrections corrections;
  corrections.clock_steps = {{70, -620ms}};
  corrections.late = 2;
  corrections.repeated = 3;
  corrections.unstamped = 4;
  EXPECT_THAT(
      describe(corrections, {"walk.mcap: /left", "image", "frame"}),
      ElementsAre("walk.mcap: /left: clock set back by 0.620 s at frame 70: later times are shifted to continue",
                  HasSubstr("4 images have a zero or wrong time stamp: times are interpolated"),
                  HasSubstr("2 images were recorded after later ones: sorted by time"),
                  HasSubstr("3 images have the time stamp of another one: ignored")));
  corrections = {.source = TimeSource::receive_times};
  EXPECT_THAT(describe(corrections, {"a", "image", "frame"}), ElementsAre(HasSubstr("receive times are used")));
}

}  // namespace
}  // namespace byre
