#include "byre/camera/live_cameras.h"

#include "byre/input_error.h"

#include <gmock/gmock.h>
#include <linux/videodev2.h>

namespace byre {
namespace {

using std::chrono_literals::operator""us;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(LiveCameras, AreOneDeviceOrTwo) {
  EXPECT_THROW(LiveCameras({}), InputError);
  EXPECT_THROW(LiveCameras({.devices = {"a", "b", "c"}}), InputError);
  EXPECT_THROW(LiveCameras({.devices = {"a", "b"}, .side_by_side = true}), InputError);
}

TEST(LiveCameras, AreNamedInErrors) {
  for (const char* const path : {"/dev/no-such-video", "/dev/null"}) {
    try {
      const LiveCameras cameras({.devices = {path}});
      ADD_FAILURE() << path;
    } catch (const InputError& fault) {
      EXPECT_EQ(fault.place(), path);
      EXPECT_FALSE(fault.remedy().empty());
    }
  }
}

TEST(LiveCameraReport, ContainsOnlyFaultsThatOccurred) {
  DeviceReport left;
  left.path = "/dev/video0";
  left.mode = {{V4L2_PIX_FMT_GREY, 752, 480, 752}, 20.0};
  left.moment = StampMoment::exposure_start;
  left.counts.images = 200;
  LiveCameraReport report{{left}, CameraClock::monotonic, {}, {}};
  const std::string sound = to_text(report);
  EXPECT_THAT(sound, AllOf(HasSubstr("/dev/video0, 752 x 480 GREY at 20 Hz: 200 images\n"),
                           HasSubstr("start of exposure, kernel clock, converted to UTC")));
  EXPECT_THAT(sound, AllOf(Not(HasSubstr("lost")), Not(HasSubstr("pairs"))));

  report.devices.front().counts.lost = 3;
  report.devices.front().disconnections = 1;
  report.devices.front().seconds_disconnected = 2.5;
  report.devices.front().exposure = CameraExposure{0.005, 2.0};
  report.devices.front().is_disconnected = true;
  report.pairs = StampPairCounts{190, 10, 4};
  report.last_difference = 1500us;
  EXPECT_THAT(
      to_text(report),
      AllOf(HasSubstr(
                "200 images, 3 lost; disconnected 1 times for 2.5 s, still disconnected; exposure 5.0 ms, gain 2.0"),
            HasSubstr("190; 10 left and 4 right images unpaired; the last 1.50 ms apart")));
}

}  // namespace
}  // namespace byre
