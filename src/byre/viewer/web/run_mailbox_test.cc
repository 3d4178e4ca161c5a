#include "byre/viewer/web/web_run.h"

#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

ShownFrame frame_at(int seconds) {
  ShownFrame frame;
  frame.report.time = std::chrono::seconds(seconds);
  return frame;
}

FrameScene scene_at(int seconds) {
  FrameScene scene;
  scene.report.time = std::chrono::seconds(seconds);
  scene.left = {2, 1, {7, 7}};
  return scene;
}

TEST(RunMailbox, KeepsEveryReportAndTheNewestImage) {
  RunMailbox mailbox;
  for (int i = 0; i < 5; ++i) mailbox.put(frame_at(i), scene_at(i));
  const RunMailbox::Content content = mailbox.take();
  EXPECT_THAT(content.frames, SizeIs(5));
  ASSERT_TRUE(content.newest);
  EXPECT_EQ(content.newest->report.time, std::chrono::seconds(4));
  EXPECT_FALSE(content.has_ended);
}

TEST(RunMailbox, KeepsTheNewestMap) {
  RunMailbox mailbox;
  mailbox.put(MapScene{});
  mailbox.put(MapScene{{{{1.0f, 2.0f, 3.0f}, Origin::online}}, {}});
  EXPECT_THAT(mailbox.take().online->points, SizeIs(1));
}

TEST(RunMailbox, IsEmptyAfterTaking) {
  RunMailbox mailbox;
  mailbox.put(frame_at(1), scene_at(1));
  mailbox.put(MapScene{});
  mailbox.put_end();
  EXPECT_TRUE(mailbox.take().has_ended);
  const RunMailbox::Content again = mailbox.take();
  EXPECT_THAT(again.frames, IsEmpty());
  EXPECT_FALSE(again.newest);
  EXPECT_FALSE(again.online);
}

TEST(RunMailbox, LosesNoReportBetweenTwoThreads) {
  constexpr int kFrames = 2000;
  RunMailbox mailbox;
  std::thread run([&mailbox] {
    for (int i = 0; i < kFrames; ++i) mailbox.put(frame_at(i), scene_at(i));
    mailbox.put_end();
  });
  std::vector<ShownFrame> taken;
  for (bool has_ended = false; !has_ended;) {
    RunMailbox::Content content = mailbox.take();
    taken.insert(taken.end(), content.frames.begin(), content.frames.end());
    has_ended = content.has_ended;
  }
  run.join();
  ASSERT_THAT(taken, SizeIs(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_EQ(taken[static_cast<std::size_t>(i)].report.time, std::chrono::seconds(i));
  }
}

}  // namespace
}  // namespace byre
