#include "byre/camera/reconnecting_device.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;

TEST(SequenceCounter, CountsGapsBetweenNumbers) {
  SequenceCounter counter;
  EXPECT_TRUE(counter.note(10, 0ms));
  EXPECT_TRUE(counter.note(11, 50ms));
  EXPECT_EQ(counter.counts().lost, 0);
  EXPECT_TRUE(counter.note(15, 250ms));
  EXPECT_EQ(counter.counts().lost, 3);
  EXPECT_EQ(counter.counts().images, 3);
}

TEST(SequenceCounter, ContinuesAfterARestartOfNumbers) {
  SequenceCounter counter;
  EXPECT_TRUE(counter.note(0xFFFFFFFFu, 0ms));
  EXPECT_TRUE(counter.note(0, 50ms)) << "after 2^32 images";
  EXPECT_TRUE(counter.note(7, 400ms));
  counter.restart();
  EXPECT_TRUE(counter.note(100, 450ms)) << "first image after reopening the device";
  EXPECT_TRUE(counter.note(3, 500ms)) << "of a restarted driver";
  EXPECT_EQ(counter.counts().lost, 6);
}

TEST(SequenceCounter, CountsDamagedAndLostImagesSeparately) {
  SequenceCounter counter;
  counter.note(0, 0ms);
  counter.note_damaged(1);
  counter.note(2, 100ms);
  EXPECT_EQ(counter.counts().damaged, 1);
  EXPECT_EQ(counter.counts().lost, 0);
  EXPECT_EQ(counter.counts().images, 2);
}

TEST(SequenceCounter, RejectsNonIncreasingStamps) {
  SequenceCounter counter;
  EXPECT_TRUE(counter.note(0, 100ms));
  EXPECT_FALSE(counter.note(1, 100ms));
  EXPECT_FALSE(counter.note(2, 50ms));
  EXPECT_TRUE(counter.note(3, 150ms));
  EXPECT_EQ(counter.counts().out_of_order, 2);
  EXPECT_EQ(counter.counts().images, 2);
}

}  // namespace
}  // namespace byre
