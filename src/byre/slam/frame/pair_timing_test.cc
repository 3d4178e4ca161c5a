#include "byre/slam/frame/pair_timing.h"

#include "byre/slam/tracking/mission_scene.h"

#include <map>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr int kFrames = 80;

// A drive round a room with right images earlier or later than the left ones.
class LatePair {
 public:
  explicit LatePair(double laps = 0.15)
      : mission_(simulate_mission(simulated_rig(), circling_trajectory(kFrames, 20.0, 2.0, laps), options())),
        map_(true_map(mission_, 5, Origin::online)) {}

  // late: delay of the right image, frames. row_error: row error of the calibration at the image border, pixels.
  std::vector<Sign> signs(int late, double row_error = 0.0) {
    const MapView view(nullptr, map_);
    std::vector<Sign> signs;
    for (int i = 3; i < kFrames - 3; ++i) {
      const Frame frame = taken(i, i - late, row_error);
      const auto tracked = track(frame, true_camera_from_world(mission_, static_cast<std::size_t>(i)), mission_.rig,
                                 view, local_points(view, {Origin::online, static_cast<std::uint32_t>(i / 5)}, 30), {});
      if (tracked) signs.push_back(timing_.note(frame, mission_.rig, *tracked, view));
      if (!tracked) timing_.skip();
    }
    return signs;
  }

  const PairTiming& timing() const { return timing_; }

 private:
  static SimulationOptions options() {
    SimulationOptions options;
    options.pixel_sigma = 0.03;  // low, since both images of a pair have the same noise here
    options.disparity_sigma = 0.1;
    return options;
  }

  // A left image with the right columns and rows of another frame, for every third feature.
  Frame taken(int left, int right, double row_error) const {
    const auto l = static_cast<std::size_t>(left), r = static_cast<std::size_t>(right);
    std::map<int, Keypoint> in_right;
    for (int i = 0; i < mission_.frames[r].features->size(); ++i) {
      in_right[mission_.landmark_of_feature[r][static_cast<std::size_t>(i)]] = mission_.frames[r].features->keypoint(i);
    }
    const Features& features = *mission_.frames[l].features;
    std::vector<Keypoint> keypoints = to_vector(features.keypoints());
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      Keypoint& keypoint = keypoints[i];
      const auto seen = in_right.find(mission_.landmark_of_feature[l][i]);
      const bool is_tried = i % 3 == 0;  // the others determine the pose
      const bool is_matched =
          is_tried && keypoint.has_disparity() && seen != in_right.end() && seen->second.has_disparity();
      const float row = is_matched ? seen->second.pixel.y() - keypoint.pixel.y() : 0.0f;
      if (!is_matched || std::abs(row) > 1.2f * kScaleOfOctave[keypoint.octave]) {
        keypoint.disparity = keypoint.disparity_sigma = -1.0f;
        continue;
      }
      const float at_rim = 2.0f * keypoint.pixel.y() / static_cast<float>(mission_.rig.height) - 1.0f;
      keypoint.row_offset = row + static_cast<float>(row_error) * at_rim;
      keypoint.disparity = keypoint.pixel.x() - (seen->second.pixel.x() - seen->second.disparity);
    }
    return {mission_.frames[l].time, std::make_shared<const Features>(features.moved(keypoints))};
  }

  SimulatedMission mission_;
  MapGraph map_;
  PairTiming timing_;
};

int count(const std::vector<Sign>& signs, Sign sign) {
  return static_cast<int>(std::ranges::count(signs, sign));
}

TEST(PairTiming, AcceptsSynchronisedPairs) {
  LatePair pair;
  const std::vector<Sign> signs = pair.signs(0);
  EXPECT_EQ(count(signs, Sign::present), 0);
  EXPECT_GT(count(signs, Sign::absent), 60);
}

TEST(PairTiming, DetectsLateRightImages) {
  LatePair pair;
  EXPECT_GT(count(pair.signs(1), Sign::present), 60);
}

TEST(PairTiming, DetectsLateLeftImages) {
  LatePair pair;
  EXPECT_GT(count(pair.signs(-1), Sign::present), 60);
}

TEST(PairTiming, DetectsADelayOfTwoImages) {
  LatePair pair;
  const std::vector<Sign> signs = pair.signs(2);
  EXPECT_EQ(count(signs, Sign::absent), 0);
  EXPECT_GT(count(signs, Sign::present), 30);
}

TEST(PairTiming, DistinguishesCalibrationErrorsFromDelay) {
  LatePair pair;
  EXPECT_EQ(count(pair.signs(0, 0.7), Sign::present), 0);
}

TEST(PairTiming, IsUncertainWithoutMotion) {
  LatePair pair(1e-4);
  EXPECT_EQ(count(pair.signs(0), Sign::unclear), kFrames - 6);
}

// A hundred points of a frame, with different or equal image motion. Values are the delay times the motion plus an
// error of the calibration.
SlopeSum values_with(double delay, bool does_motion_differ) {
  SlopeSum sum;
  sum.begin_frame();
  for (int i = 0; i < 100; ++i) {
    const double place = i % 10 / 10.0 - 0.5;
    const double motion = does_motion_differ ? (i / 10 - 4.5) / 2.0 : 1.0;
    sum.add(motion, {1.0, place, 0.0, 0.0}, delay * motion + 0.3 + 0.7 * place);
  }
  return sum;
}

TEST(SlopeSum, EstimatesTheDelayDespiteCalibrationErrors) {
  for (const double delay : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
    const auto slope = values_with(delay, true).slope(0.3);
    ASSERT_TRUE(slope) << delay;
    EXPECT_NEAR(slope->value, delay, 0.01);
    EXPECT_LT(slope->sigma, 0.1);
  }
}

TEST(SlopeSum, IsEmptyIfCalibrationErrorsExplainTheMotion) {
  EXPECT_FALSE(values_with(1.0, false).slope(0.3));
  EXPECT_FALSE(values_with(1.0, true).slope(3.0)) << "too little motion";
}

TEST(SlopeSum, IsEmptyWithoutEnoughValues) {
  EXPECT_FALSE(SlopeSum().slope(0.0));
}

}  // namespace
}  // namespace byre
