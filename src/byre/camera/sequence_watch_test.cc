#include "byre/camera/sequence_watch.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;

TEST(SequenceWatch, CountsGapsBetweenNumbers) {
  SequenceWatch watch;
  EXPECT_TRUE(watch.note(10, 0ms));
  EXPECT_TRUE(watch.note(11, 50ms));
  EXPECT_EQ(watch.counts().lost, 0);
  EXPECT_TRUE(watch.note(15, 250ms));
  EXPECT_EQ(watch.counts().lost, 3);
  EXPECT_EQ(watch.counts().images, 3);
}

TEST(SequenceWatch, ContinuesAfterARestartOfNumbers) {
  SequenceWatch watch;
  EXPECT_TRUE(watch.note(0xFFFFFFFFu, 0ms));
  EXPECT_TRUE(watch.note(0, 50ms)) << "after 2^32 images";
  EXPECT_TRUE(watch.note(7, 400ms));
  watch.restart();
  EXPECT_TRUE(watch.note(100, 450ms)) << "first image after reopening the device";
  EXPECT_TRUE(watch.note(3, 500ms)) << "of a restarted driver";
  EXPECT_EQ(watch.counts().lost, 6);
}

TEST(SequenceWatch, CountsDamagedAndLostImagesSeparately) {
  SequenceWatch watch;
  watch.note(0, 0ms);
  watch.note_damaged(1);
  watch.note(2, 100ms);
  EXPECT_EQ(watch.counts().damaged, 1);
  EXPECT_EQ(watch.counts().lost, 0);
  EXPECT_EQ(watch.counts().images, 2);
}

TEST(SequenceWatch, RejectsNonIncreasingStamps) {
  SequenceWatch watch;
  EXPECT_TRUE(watch.note(0, 100ms));
  EXPECT_FALSE(watch.note(1, 100ms));
  EXPECT_FALSE(watch.note(2, 50ms));
  EXPECT_TRUE(watch.note(3, 150ms));
  EXPECT_EQ(watch.counts().out_of_order, 2);
  EXPECT_EQ(watch.counts().images, 2);
}

}  // namespace
}  // namespace byre
