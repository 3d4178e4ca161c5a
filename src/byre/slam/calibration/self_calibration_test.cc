#include "byre/slam/calibration/self_calibration.h"

#include "byre/geometry/calibration_scene.h"
#include "byre/geometry/median.h"
#include "byre/geometry/rectified_change.h"
#include "byre/slam/window/mapping_steps.h"

#include <functional>
#include <map>
#include <random>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using PathOfCamera = std::function<Pose(int keyframe)>;  // world_from_left

// Path round a room of points, with turns.
Pose about_the_room(int keyframe) {
  const double t = 0.23 * keyframe;
  const Eigen::Quaterniond looking =
      rotation_exp({0.25 * std::sin(0.9 * t), 0.7 * std::sin(t), 0.3 * std::sin(1.7 * t)});
  return {looking, {1.2 * std::sin(t), 0.5 * std::sin(1.3 * t), 1.0 * std::cos(0.8 * t)}};
}

// Map by keyframes of cameras with a calibration error.
class MapOfErringCamera {
 public:
  MapOfErringCamera(const Calibration& given, const CalibrationVector& error, const PathOfCamera& path, int keyframes,
                    float sigma = 0.1f)
      : given_(given), truth_(changed(given, error)), rectification_(rectification_of(given)), sigma_(sigma) {
    window_.rigs = {rectification_.rig};
    for (int i = 0; i < 400; ++i) {
      points_.push_back({place_(random_) * 4.0, place_(random_) * 2.5, 4.0 + place_(random_) * 2.0});
    }
    for (int i = 0; i < keyframes; ++i) add_keyframe(path(i));
    link_points();
  }

  const MapWindow& window() const { return window_; }

 private:
  void add_keyframe(const Pose& world_from_left) {
    WindowKeyframe entry;
    entry.id = {Origin::online, static_cast<std::uint32_t>(window_.keyframes.size())};
    entry.movable = true;
    const Pose left_from_world = inverse(world_from_left);
    entry.keyframe.camera_from_world =
        Pose{rectification_.left_from_rectified.conjugate(), Eigen::Vector3d::Zero()} * left_from_world;
    std::vector<Keypoint> keypoints;
    std::vector<int> numbers;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto keypoint = see(left_from_world * points_[i]);
      if (!keypoint) continue;
      keypoints.push_back(*keypoint);
      numbers.push_back(static_cast<int>(i));
    }
    const Rig& rig = rectification_.rig;
    for (const int i : Features::order_of(rig.width, rig.height, keypoints)) {
      entry.point_of_feature.push_back(numbers[static_cast<std::size_t>(i)]);
    }
    const std::size_t count = keypoints.size();
    entry.keyframe.frame.features = std::make_shared<const Features>(
        rig.width, rig.height, std::move(keypoints), std::vector<Descriptor>(count), std::vector<Patch>{});
    for (int i = 0; i < entry.keyframe.frame.features->size(); ++i) {
      entry.keyframe.sightings.push_back({{}, entry.keyframe.frame.features->keypoint(i).pixel, sigma_});
    }
    window_.keyframes.push_back(std::move(entry));
  }

  std::optional<Keypoint> see(const Eigen::Vector3d& point_in_left) {
    if (point_in_left.z() < 0.5) return std::nullopt;
    const StereoPixel ideal =
        rectification_.rig.project(rectification_.left_from_rectified.conjugate() * point_in_left);
    if (!rectification_.rig.contains(ideal.head<2>(), 20.0)) return std::nullopt;
    if (!rectification_.rig.contains({ideal.x() - ideal.z(), ideal.y()}, 20.0)) return std::nullopt;
    const Eigen::Vector4d seen = measured(truth_, given_, rectification_, point_in_left);
    Keypoint keypoint;
    keypoint.pixel = (seen.head<2>() + sigma_ * Eigen::Vector2d(noise_(random_), noise_(random_))).cast<float>();
    keypoint.disparity = static_cast<float>(seen.z() + sigma_ * noise_(random_));
    keypoint.disparity_sigma = sigma_;
    keypoint.row_offset = static_cast<float>(seen.w() + sigma_ * noise_(random_));
    return keypoint;
  }

  void link_points() {
    for (const Eigen::Vector3d& point : points_) {
      WindowPoint entry;
      entry.id = PointId{Origin::online, static_cast<std::uint32_t>(window_.points.size())};
      entry.point.position_in_world = point;
      window_.points.push_back(entry);
    }
    for (int k = 0; k < static_cast<int>(window_.keyframes.size()); ++k) {
      const WindowKeyframe& keyframe = window_.keyframes[static_cast<std::size_t>(k)];
      for (int feature = 0; feature < static_cast<int>(keyframe.point_of_feature.size()); ++feature) {
        const int point = keyframe.point_of_feature[static_cast<std::size_t>(feature)];
        window_.points[static_cast<std::size_t>(point)].observations.push_back({k, feature});
      }
    }
  }

  const Calibration given_;
  const Calibration truth_;
  const Rectification rectification_;
  const float sigma_;  // pixels of noise
  std::vector<Eigen::Vector3d> points_;
  MapWindow window_;
  std::mt19937_64 random_{5};
  std::uniform_real_distribution<double> place_{-1.0, 1.0};
  std::normal_distribution<double> noise_;
};

// Root mean square difference of corners by the refined and the true calibration, pixels: u, v, disparity.
double remaining_shift(const Calibration& refined, const Calibration& truth) {
  const RectifiedChange change(refined, truth);
  double sum = 0.0;
  int count = 0;
  for (double v = 40.0; v < 440.0; v += 40.0) {
    for (double u = 160.0; u < 720.0; u += 40.0) {
      const StereoPixel pixel(u, v, 20.0);
      sum += std::pow(change({pixel, 0.0}).pixel.z() - 20.0, 2);
      ++count;
    }
  }
  return std::sqrt(sum / count);
}

TEST(SelfCalibration, EstimatesTheErrorOfAGoodCalibration) {
  const Calibration given = scene_calibration();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const CalibrationVector error = draw_error(seed);
    const MapOfErringCamera map(given, error, about_the_room, 60);
    const auto found = self_calibrate(map.window(), {given, CalibrationVector::Zero()}, 0, {});
    ASSERT_TRUE(found);
    const Calibration truth = changed(given, error);
    EXPECT_GT(remaining_shift(given, truth), 0.08) << "seed " << seed;
    EXPECT_LT(remaining_shift(found->calibration, truth), 0.015) << "seed " << seed;
    const CalibrationVector deviations = (found->change - error).cwiseQuotient(found->sigma_after);
    EXPECT_LT(deviations.cwiseAbs().maxCoeff(), 4.5) << "seed " << seed;
  }
}

TEST(SelfCalibration, DoesNotMistakeNoiseForALongerFocalLength) {
  const Calibration given = scene_calibration();
  CalibrationVector error = draw_error(4);
  error[kLeftCamera] = error[kRightCamera] = 0.0;
  constexpr float kPixelSigma = 0.15f;  // pixels
  const MapOfErringCamera map(given, error, about_the_room, 150, kPixelSigma);
  const auto found = self_calibrate(map.window(), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(found);
  for (const int focal : {kLeftCamera, kRightCamera}) {
    EXPECT_LT(found->sigma_after[focal], 0.5 * found->sigma_before[focal]);
    EXPECT_LT(std::abs(found->change[focal]), 2.0 * found->sigma_after[focal]);
  }
}

TEST(SelfCalibration, KeepsACalibrationThatExplainsTheObservations) {
  const Calibration given = scene_calibration();
  const MapOfErringCamera map(given, CalibrationVector::Zero(), about_the_room, 40);
  const auto found = self_calibrate(map.window(), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->change.isZero(0.0));
  EXPECT_EQ(found->shift, 0.0);
}

TEST(SelfCalibration, RejectsImplausibleErrors) {
  const Calibration given = scene_calibration();
  CalibrationVector error = draw_error(2, 3.0);
  const MapOfErringCamera worn(given, error, about_the_room, 40);
  const auto believed = self_calibrate(worn.window(), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(believed);
  EXPECT_FALSE(believed->was_refused());
  error[kRightRotation + 2] = 60.0;  // 0.6 degrees about the optical axis
  const MapOfErringCamera knocked(given, error, about_the_room, 40);
  const auto refused = self_calibrate(knocked.window(), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(refused);
  EXPECT_TRUE(refused->was_refused());
  EXPECT_GT(refused->shift, 0.5) << "pixels: the error is reported";
}

TEST(SelfCalibration, ContinuesFromAnEarlierEstimate) {
  const Calibration given = scene_calibration();
  const CalibrationVector error = draw_error(4);
  const MapOfErringCamera map(given, error, about_the_room, 40);
  const auto at_once = self_calibrate(map.window(), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(at_once);
  // The same cameras, with half of the error already corrected.
  const MapOfErringCamera known(changed(given, 0.5 * error), 0.5 * error, about_the_room, 40);
  const auto in_two_steps = self_calibrate(known.window(), {given, 0.5 * error}, 0, {});
  ASSERT_TRUE(in_two_steps);
  EXPECT_LT(remaining_shift(in_two_steps->calibration, at_once->calibration), 0.01);
}

TEST(SelfCalibration, KeepsTheDepthsOfAnExactCalibration) {
  const Calibration given = scene_calibration();
  const MapOfErringCamera map(given, CalibrationVector::Zero(), about_the_room, 40);
  const auto found = self_calibrate(map.window(), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(found);
  EXPECT_LT(remaining_shift(found->calibration, given), 0.015);
  EXPECT_LT(found->change.cwiseQuotient(found->sigma_after).cwiseAbs().maxCoeff(), 4.5);
}

// The window of one camera.
MapWindow without_disparities(MapWindow window) {
  for (WindowKeyframe& keyframe : window.keyframes) {
    std::vector<Keypoint> keypoints = to_vector(keyframe.keyframe.frame.features->keypoints());
    for (Keypoint& keypoint : keypoints) keypoint.disparity = keypoint.disparity_sigma = -1.0f;
    keyframe.keyframe.frame.features =
        std::make_shared<const Features>(keyframe.keyframe.frame.features->moved(std::move(keypoints)));
  }
  return window;
}

TEST(SelfCalibration, KeepsTheCalibrationOfOneRestingCamera) {
  const Calibration given = scene_calibration();
  const MapOfErringCamera map(
      given, draw_error(2), [](int) { return Pose{}; }, 30);
  const auto found = self_calibrate(without_disparities(map.window()), {given, CalibrationVector::Zero()}, 0, {});
  if (found) {
    EXPECT_LT(found->change.norm(), 1e-6);
  }
}

TEST(SelfCalibration, KeepsTheFocalLengthOfOneCameraMovingStraight) {
  const Calibration given = scene_calibration();
  const MapOfErringCamera map(
      given, draw_error(2),
      [](int i) {
        return Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.03 * i}};
      },
      30);
  const auto found = self_calibrate(without_disparities(map.window()), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->change[kLeftCamera], 0.0, 0.1);
  EXPECT_GT(found->sigma_after[kLeftCamera], 0.9 * found->sigma_before[kLeftCamera]);
}

TEST(SelfCalibration, EstimatesTheLensOfOneRotatingCamera) {
  const Calibration given = scene_calibration();
  const CalibrationVector error = draw_error(6);
  const MapOfErringCamera map(given, error, about_the_room, 60);
  const auto found = self_calibrate(without_disparities(map.window()), {given, CalibrationVector::Zero()}, 0, {});
  ASSERT_TRUE(found);
  const auto of_left = found->change.head<kParametersPerCamera>() - error.head<kParametersPerCamera>();
  EXPECT_LT(of_left.cwiseQuotient(found->sigma_after.head<kParametersPerCamera>()).cwiseAbs().maxCoeff(), 4.5);
  EXPECT_LT(found->sigma_after[kLeftCamera], 0.6 * found->sigma_before[kLeftCamera]);
}

Calibration parallel_pair_of(const Camera& camera) {
  return {camera, StereoPartner{camera, {Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.0}}}, Pose{}};
}

// Without distortion, with round numbers.
Calibration nominal_pair() {
  return parallel_pair_of(
      {.model = CameraModel::pinhole, .width = 752, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 375.5, .cy = 239.5});
}

Calibration calibrated_pair() {
  return parallel_pair_of({.model = CameraModel::radial_tangential,
                           .width = 752,
                           .height = 480,
                           .fx = 458.7,
                           .fy = 457.3,
                           .cx = 367.2,
                           .cy = 248.4,
                           .distortion = {-0.283, 0.074, 0.0002, 0.00002, 0.0}});
}

// Median distance of the solved points from their corners in images rectified by the refined calibration.
double pixel_error(const MapWindow& window, const SelfCalibration& solved, const Calibration& given) {
  const RectifiedChange change(given, solved.calibration);
  std::map<int, Pose> camera_from_world;
  for (const auto& [keyframe, pose] : solved.keyframes_moved) camera_from_world[keyframe] = pose;
  std::vector<double> errors;
  for (const auto& [index, position] : solved.points_moved) {
    for (const WindowObservation& seen : window.point(index).observations) {
      const Eigen::Vector3d expected = change.rig().project(camera_from_world.at(seen.keyframe) * position);
      const BundleObservation measured = bundle_observation(window.keyframe(seen.keyframe), seen.feature);
      errors.push_back((expected - change({measured.measured}).pixel).head<2>().norm());
    }
  }
  return median(std::move(errors));
}

TEST(SelfCalibration, FindsTheFocalLengthOfOneCameraWithTheCalibrationOfAnother) {
  for (const Calibration& pair : {nominal_pair(), calibrated_pair()}) {
    Calibration given = pair;
    given.right.reset();
    for (const double focal : {-250.0, 250.0}) {  // 10 %
      CalibrationVector error = CalibrationVector::Zero();
      error[kLeftCamera] = focal;
      error[kLeftCamera + 4] = -80.0;  // k1
      const MapOfErringCamera map(pair, error, about_the_room, 30);
      const MapWindow window = without_disparities(map.window());
      const auto found = self_calibrate(window, {given, CalibrationVector::Zero()}, 0, {});
      ASSERT_TRUE(found);
      const Camera truth = changed(pair, error).left;
      EXPECT_NEAR(found->calibration.left.fx, truth.fx, 0.003 * truth.fx);
      EXPECT_NEAR(found->calibration.left.distortion[0], truth.distortion[0], 0.005);
      EXPECT_LT(pixel_error(window, *found, given), 1.0);
    }
  }
}

TEST(SelfCalibration, KeepsTheCalibrationOfAnotherCameraUntilTheGivenOneFits) {
  const Calibration pair = nominal_pair();
  Calibration given = pair;
  given.right.reset();
  CalibrationVector error = CalibrationVector::Zero();
  error[kLeftCamera] = 250.0;
  const CalibrationVector found_before = 0.9 * error;
  const MapOfErringCamera other(changed(pair, found_before), error - found_before, about_the_room, 30);
  const auto kept = self_calibrate(without_disparities(other.window()), {given, found_before}, 0, {});
  ASSERT_TRUE(kept);
  EXPECT_NEAR(kept->change[kLeftCamera], error[kLeftCamera], 8.0) << "0.3 % of the focal length";
  const MapOfErringCamera same(changed(pair, found_before), -found_before, about_the_room, 30);
  const auto returned = self_calibrate(without_disparities(same.window()), {given, found_before}, 0, {});
  ASSERT_TRUE(returned);
  EXPECT_NEAR(returned->change[kLeftCamera], 0.0, 1.0);
}

TEST(SelfCalibration, TakesAWornCalibrationOfOneCameraForItsOwn) {
  const Calibration pair = calibrated_pair();
  Calibration given = pair;
  given.right.reset();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const MapOfErringCamera map(pair, draw_error(seed, 3.0), about_the_room, 30);
    const auto found = self_calibrate(without_disparities(map.window()), {given, CalibrationVector::Zero()}, 0, {});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->sigma_before[kLeftCamera], SelfCalibrationOptions().prior_sigmas) << "seed " << seed;
  }
}

TEST(SelfCalibration, RequiresEnoughKeyframes) {
  const Calibration given = scene_calibration();
  const MapOfErringCamera map(given, draw_error(1), about_the_room, 5);
  EXPECT_FALSE(self_calibrate(map.window(), {given, CalibrationVector::Zero()}, 0, {}));
}

}  // namespace
}  // namespace byre
