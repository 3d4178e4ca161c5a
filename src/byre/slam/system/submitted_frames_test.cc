// Slam::submit: order, replacement, threads and exceptions.

#include "byre/slam/system/slam_scene.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <latch>
#include <optional>
#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

// Holds the thread of a Slam within the callback of a frame.
class Gate {
 public:
  ReportCallback callback(ReportCallback then) {
    return [this, then = std::move(then)](const FrameReport& report) {
      reached_.count_down();
      opened_.wait();
      then(report);
    };
  }
  void wait_until_reached() { reached_.wait(); }
  void open() { opened_.count_down(); }

 private:
  std::latch reached_{1};
  std::latch opened_{1};
};

// Collects reports on the thread of a Slam; to be read after a call that waits for it.
ReportCallback into(std::vector<FrameReport>& reports) {
  return [&reports](const FrameReport& report) { reports.push_back(report); };
}

std::vector<InputFault> faults_of(const std::vector<FrameReport>& reports) {
  std::vector<InputFault> faults;
  for (const FrameReport& report : reports) faults.push_back(report.input);
  return faults;
}

TEST(SubmittedFrames, YieldTheReportsOfProcess) {
  const std::vector<ImageFrame> frames = shared_frames();
  SlamOptions options = repeatable();
  options.max_waiting = static_cast<int>(frames.size());
  Slam slam = Slam::mapping(open_shared()->calibration(), options);
  std::vector<FrameReport> reports;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % 2 == 0) {
      slam.submit(frames[i], into(reports));
    } else {
      ImageFrame lost_afterwards = frames[i];
      slam.submit(view_of(lost_afterwards), into(reports));
      lost_afterwards.left.pixels.assign(lost_afterwards.left.pixels.size(), 0);
    }
  }
  slam.finish();
  Slam plain = Slam::mapping(open_shared()->calibration(), repeatable());
  const Trajectory expected = causal(plain, frames);
  ASSERT_THAT(reports, SizeIs(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(reports[i].time, frames[i].time);
    ASSERT_TRUE(reports[i].map_from_body);
    EXPECT_EQ(reports[i].map_from_body->translation, expected[i].world_from_body.translation) << i;
  }
}

TEST(SubmittedFrames, AreReplacedByNewerOnesAndReportedInOrder) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
  std::vector<FrameReport> reports;
  Gate gate;
  slam.submit(frames[0], gate.callback(into(reports)));
  gate.wait_until_reached();
  for (std::size_t i = 1; i < 4; ++i) slam.submit(frames[i], into(reports));
  gate.open();
  EXPECT_EQ(slam.frames(), 4);
  EXPECT_THAT(faults_of(reports),
              ElementsAre(InputFault::none, InputFault::replaced, InputFault::replaced, InputFault::none));
  for (std::size_t i = 0; i < reports.size(); ++i) EXPECT_EQ(reports[i].time, frames[i].time);
  EXPECT_FALSE(reports[1].map_from_body);
  EXPECT_EQ(slam.frames(InputFault::replaced), 2);
}

// The motion of replaced frames is part of that of the next one.
TEST(SubmittedFrames, LoseNoMotion) {
  const std::vector<ImageFrame> frames = shared_frames();
  ImageFrame dark = frames[3];
  for (Image* const image : {&dark.left, &*dark.right}) std::ranges::fill(image->pixels, std::uint8_t{0});
  const BodyMotion step(Pose{Eigen::Quaterniond::Identity(), {0.01, 0.0, 0.0}});
  std::vector<Eigen::Vector3d> positions;
  for (const bool is_replaced : {false, true}) {
    Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
    std::vector<FrameReport> reports;
    Gate gate;
    slam.submit(frames[0], gate.callback(into(reports)));
    gate.wait_until_reached();
    if (is_replaced) slam.submit(frames[1], into(reports), step);
    slam.submit(dark, into(reports), is_replaced ? step : step * step);
    gate.open();
    slam.finish();
    ASSERT_TRUE(reports.back().map_from_body);
    positions.push_back(reports.back().map_from_body->translation);
  }
  EXPECT_GT(positions[0].norm(), 0.019);
  EXPECT_LT((positions[0] - positions[1]).norm(), 1e-9);
}

TEST(SubmittedFrames, RunBesideSensorsAndQueries) {
  const std::vector<ImageFrame> frames = shared_frames();
  SlamOptions options = repeatable();
  options.max_waiting = static_cast<int>(frames.size());
  Slam slam = Slam::mapping(open_shared()->calibration(), options);
  std::atomic<int> keyframes = 0;
  {
    std::jthread gyroscope([&] {
      for (int i = 0; i < 400; ++i) slam.add_gyro({frames[0].time + i * 5ms, Eigen::Vector3d::Zero()});
    });
    std::jthread display([&] {
      for (int i = 0; i < 20; ++i) EXPECT_LE(slam.trajectory().size(), frames.size());
    });
    for (const ImageFrame& frame : frames) {
      slam.submit(frame, [&](const FrameReport&) { keyframes = slam.keyframes(); });
    }
  }
  EXPECT_EQ(slam.frames(), static_cast<int>(frames.size()));
  EXPECT_GT(keyframes, 0);
  EXPECT_EQ(keyframes, slam.keyframes());
}

TEST(SubmittedFrames, PassOnTheExceptionOfACallback) {
  const std::vector<ImageFrame> frames = shared_frames();
  Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
  slam.submit(frames[0], [](const FrameReport&) { throw InputError("callback", "fails"); });
  EXPECT_EQ(slam.frames(), 1);
  EXPECT_THAT(error_by([&] { slam.submit(frames[1]); }), HasSubstr("callback: fails"));
  std::vector<FrameReport> reports;
  slam.submit(frames[1], into(reports));
  slam.finish();
  ASSERT_THAT(reports, SizeIs(1));
  EXPECT_TRUE(reports[0].map_from_body);
  slam.submit(frames[2], into(reports));
  EXPECT_EQ(slam.frames(InputFault::after_finishing), 1);
}

TEST(SubmittedFrames, AreDiscardedWithTheirSlam) {
  const std::vector<ImageFrame> frames = shared_frames();
  std::vector<FrameReport> reports;
  std::optional<Slam> slam = Slam::mapping(open_shared()->calibration(), repeatable());
  const auto destroyed = std::make_shared<std::promise<void>>();
  std::latch may_destroy{1};
  slam->submit(frames[0], [&, destroyed](const FrameReport&) {
    may_destroy.wait();
    slam.reset();
    destroyed->set_value();
  });
  slam->submit(frames[1], into(reports));
  may_destroy.count_down();
  destroyed->get_future().wait();
  EXPECT_THAT(reports, SizeIs(0));
}

TEST(SubmittedFrames, MayBeUnusable) {
  Slam slam = Slam::mapping(open_shared()->calibration(), repeatable());
  std::vector<FrameReport> reports;
  const std::vector<ImageFrame> frames = shared_frames();
  CameraImages images = view_of(frames[0]);
  images.left.stride = 1;
  slam.submit(images, into(reports));
  EXPECT_EQ(slam.frames(), 1);
  slam.submit(CameraImages{}, into(reports));
  EXPECT_EQ(slam.frames(), 2);
  EXPECT_THAT(faults_of(reports), ElementsAre(InputFault::wrong_size, InputFault::no_image));
  SlamOptions options;
  options.max_waiting = 0;
  EXPECT_THAT(error_by([&] { Slam::mapping(open_shared()->calibration(), options); }), HasSubstr("max_waiting"));
}

}  // namespace
}  // namespace byre
