#include "byre/slam/system/input_check.h"

#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono::milliseconds;

class StereoInput : public testing::Test {
 protected:
  static constexpr int kWidth = 8, kHeight = 6;

  static Calibration pair() {
    Calibration calibration;
    calibration.left = {CameraModel::pinhole, kWidth, kHeight, 5.0, 5.0, 3.5, 2.5, {}};
    calibration.right = StereoPartner{calibration.left, {}};
    return calibration;
  }

  ImageView image(milliseconds time) const {
    return {pixels_.data(), kWidth, kHeight, 0, PixelFormat::grey8, 16, time};
  }
  CameraImages images(milliseconds time) const { return {image(time), image(time)}; }

  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(2 * kWidth * kHeight);
  InputCheck check_{pair(), {}, {0.005, 1.0}};
};

TEST_F(StereoInput, IsAcceptedInOrderOfTime) {
  EXPECT_EQ(check_.note(images(milliseconds(0))), InputFault::none);
  EXPECT_EQ(check_.note(images(milliseconds(50))), InputFault::none);
  EXPECT_EQ(check_.frames(), 2);
  EXPECT_EQ(check_.frames(InputFault::none), 2);
}

TEST_F(StereoInput, IsReportedIfRepeatedOrOutOfOrder) {
  check_.note(images(milliseconds(100)));
  EXPECT_EQ(check_.note(images(milliseconds(100))), InputFault::repeated_time);
  EXPECT_EQ(check_.note(images(milliseconds(50))), InputFault::out_of_order);
  EXPECT_EQ(check_.note(images(milliseconds(150))), InputFault::none) << "dropped frames do not change the clock";
}

TEST_F(StereoInput, IsReportedAfterAGap) {
  check_.note(images(milliseconds(0)));
  EXPECT_EQ(check_.note(images(milliseconds(1000))), InputFault::none);
  EXPECT_EQ(check_.note(images(milliseconds(2001))), InputFault::after_gap);
  EXPECT_FALSE(is_dropped(InputFault::after_gap));
}

TEST_F(StereoInput, IsReportedWithoutRightImage) {
  CameraImages alone = images(milliseconds(0));
  alone.right.reset();
  EXPECT_EQ(check_.note(alone), InputFault::missing_right);
  CameraImages empty = images(milliseconds(50));
  empty.right->data = nullptr;
  EXPECT_EQ(check_.note(empty), InputFault::missing_right);
  EXPECT_EQ(check_.frames(InputFault::missing_right), 2);
}

TEST_F(StereoInput, IsReportedWithARightImageOfAnotherTime) {
  CameraImages off = images(milliseconds(0));
  off.right->time = milliseconds(5);
  EXPECT_EQ(check_.note(off), InputFault::none);
  off = images(milliseconds(50));
  off.right->time = milliseconds(44);
  EXPECT_EQ(check_.note(off), InputFault::late_right);
  off = images(milliseconds(5000));
  off.right->time = milliseconds(1);
  EXPECT_EQ(check_.note(off), InputFault::late_right) << "unusable images take precedence over a gap";
}

TEST_F(StereoInput, IsDroppedIfItDoesNotFitTheCamera) {
  CameraImages none = images(milliseconds(0));
  none.left.data = nullptr;
  EXPECT_EQ(check_.note(none), InputFault::no_image);
  CameraImages small = images(milliseconds(0));
  small.right->width = kWidth - 1;
  EXPECT_EQ(check_.note(small), InputFault::wrong_size);
  CameraImages narrow = images(milliseconds(0));
  narrow.left.stride = kWidth - 1;
  EXPECT_EQ(check_.note(narrow), InputFault::wrong_size);
  CameraImages deep = images(milliseconds(0));
  deep.left.format = PixelFormat::depth16;
  EXPECT_EQ(check_.note(deep), InputFault::wrong_format);
  for (const InputFault fault : {InputFault::no_image, InputFault::wrong_size, InputFault::wrong_format}) {
    EXPECT_TRUE(is_dropped(fault)) << to_string(fault);
  }
}

TEST_F(StereoInput, IsReportedWithoutDepth) {
  Calibration calibration = pair();
  calibration.right.reset();
  calibration.depth = DepthCamera{};
  InputCheck check(calibration, {}, {});
  CameraImages frame{image(milliseconds(0))};
  EXPECT_EQ(check.note(frame), InputFault::missing_depth);
  frame.left.time = milliseconds(50);
  frame.depth = image(milliseconds(50));
  EXPECT_EQ(check.note(frame), InputFault::wrong_format);
  frame.depth->format = PixelFormat::depth16;
  EXPECT_EQ(check.note(frame), InputFault::none);
  EXPECT_TRUE(check.may_use_depth());
  frame.left.time = milliseconds(100);
  EXPECT_EQ(check.note(frame), InputFault::late_depth);
  EXPECT_FALSE(check.may_use_depth());
}

TEST_F(StereoInput, UsesTheLeftTimeIfTheRightOneIsUnset) {
  CameraImages untold = images(milliseconds(500));
  untold.right->time = {};
  EXPECT_EQ(check_.note(untold), InputFault::none);
  EXPECT_TRUE(check_.may_use_right());
}

TEST_F(StereoInput, IsReportedWithInvalidTimes) {
  CameraImages far = images(milliseconds(0));
  far.right->time = Timestamp::min();
  EXPECT_EQ(check_.note(far), InputFault::late_right);
  EXPECT_EQ(check_.note(images(std::chrono::duration_cast<milliseconds>(Timestamp::max()))), InputFault::after_gap);
}

TEST(FeatureInput, NeedsFeaturesInsideTheImage) {
  Rig rig;
  rig.width = 8;
  rig.height = 6;
  InputCheck check({}, rig, {});
  const auto fault_with = [&](const Keypoint& keypoint) {
    Frame frame;
    frame.features =
        std::make_shared<const Features>(8, 6, std::vector{keypoint}, std::vector<Descriptor>(1), std::vector<Patch>{});
    return InputCheck({}, rig, {}).note(frame);
  };
  Keypoint sound;
  sound.pixel = {3.0f, 3.0f};
  EXPECT_EQ(fault_with(sound), InputFault::none);
  Keypoint unsure = sound;
  unsure.disparity = 4.0f;
  EXPECT_EQ(fault_with(unsure), InputFault::wrong_features) << "a disparity without its sigma";
  Keypoint small = sound;
  small.octave = kOctaves;
  EXPECT_EQ(fault_with(small), InputFault::wrong_features);
}

TEST(FeatureInput, NeedsFeaturesInOrderOfTime) {
  InputCheck check({}, {}, {});
  Frame frame;
  EXPECT_EQ(check.note(frame), InputFault::no_image);
  frame.features = std::make_shared<const Features>();
  EXPECT_EQ(check.note(frame), InputFault::none);
  EXPECT_EQ(check.note(frame), InputFault::repeated_time);
}

}  // namespace
}  // namespace byre
