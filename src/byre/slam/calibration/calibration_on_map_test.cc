#include "byre/slam/calibration/calibration_on_map.h"

#include "byre/features/recalibrated.h"
#include "byre/geometry/calibration_scene.h"
#include "byre/slam/calibration/self_calibration.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr float kSigma = 0.1f;  // pixels

// A robot that turns in front of a wall of mapped points, with a calibration error.
class LookingAbout {
 public:
  LookingAbout(const Calibration& given, const CalibrationVector& error)
      : given_(given), truth_(changed(given, error)), rectification_(rectification_of(given)) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> place(-1.0, 1.0);
    for (int i = 0; i < 500; ++i) {
      MapPoint point;
      point.position_in_world = {5.0 * place(random), 3.0 * place(random), 4.0 + 2.0 * place(random)};
      point.covariance = 1e-6 * Eigen::Matrix3d::Identity();
      ids_.push_back(offline_.add_point(point));
    }
  }

  // Returns what the robot sees.
  std::shared_ptr<const Features> look(int number, CalibrationOnMap& calibration) {
    const double t = 0.11 * number;
    const Pose world_from_left{rotation_exp({0.2 * std::sin(0.9 * t), 0.6 * std::sin(t), 0.3 * std::sin(1.7 * t)}),
                               {std::sin(t), 0.4 * std::sin(1.3 * t), 0.8 * std::cos(0.8 * t)}};
    TrackedFrame tracked;
    tracked.camera_from_world =
        Pose{rectification_.left_from_rectified.conjugate(), Eigen::Vector3d::Zero()} * inverse(world_from_left);
    std::vector<Keypoint> keypoints;
    std::vector<PointId> seen;
    for (const PointId id : ids_) {
      const auto keypoint = see(inverse(world_from_left) * offline_.find_point(id)->position_in_world);
      if (!keypoint) continue;
      keypoints.push_back(*keypoint);
      seen.push_back(id);
    }
    const Rig& rig = rectification_.rig;
    const std::vector<int> order = Features::order_of(rig.width, rig.height, keypoints);
    const std::size_t count = keypoints.size();
    Frame frame;
    frame.features = std::make_shared<const Features>(rig.width, rig.height, std::move(keypoints),
                                                      std::vector<Descriptor>(count), std::vector<Patch>{});
    for (int i = 0; i < static_cast<int>(order.size()); ++i) {
      tracked.features.push_back({i, seen[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])],
                                  frame.features->keypoint(i).pixel, kSigma});
    }
    const MapGraph nothing_online(Origin::online);
    calibration.add(frame, rig, tracked, {&offline_, nothing_online}, CalibrationVector::Zero());
    return frame.features;
  }

 private:
  std::optional<Keypoint> see(const Eigen::Vector3d& point_in_left) {
    const Eigen::Vector3d rectified = rectification_.left_from_rectified.conjugate() * point_in_left;
    if (rectified.z() < 0.5) return std::nullopt;
    const StereoPixel ideal = rectification_.rig.project(rectified);
    if (!rectification_.rig.contains(ideal.head<2>(), 20.0)) return std::nullopt;
    if (!rectification_.rig.contains({ideal.x() - ideal.z(), ideal.y()}, 20.0)) return std::nullopt;
    const Eigen::Vector4d seen = measured(truth_, given_, rectification_, point_in_left);
    Keypoint keypoint;
    keypoint.pixel = (seen.head<2>() + kSigma * Eigen::Vector2d(noise_(random_), noise_(random_))).cast<float>();
    keypoint.disparity = static_cast<float>(seen.z() + kSigma * noise_(random_));
    keypoint.disparity_sigma = kSigma;
    keypoint.row_offset = static_cast<float>(seen.w() + kSigma * noise_(random_));
    return keypoint;
  }

  Calibration given_, truth_;
  Rectification rectification_;
  MapGraph offline_{Origin::offline};
  std::vector<PointId> ids_;
  std::mt19937_64 random_{5};
  std::normal_distribution<double> noise_;
};

// Root mean square error of disparities of 20 px, pixels.
double disparity_error(const Calibration& calibration, const Calibration& truth) {
  const RectifiedChange change(calibration, truth);
  double sum = 0.0;
  int count = 0;
  for (double v = 40.0; v < 440.0; v += 40.0) {
    for (double u = 160.0; u < 720.0; u += 40.0, ++count) {
      sum += std::pow(change({{u, v, 20.0}, 0.0}).pixel.z() - 20.0, 2);
    }
  }
  return std::sqrt(sum / count);
}

TEST(CalibrationOnMap, EstimatesTheErrorOfAGoodCalibration) {
  const Calibration given = scene_calibration();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const CalibrationVector error = draw_error(seed);
    LookingAbout robot(given, error);
    CalibrationOnMap calibration(given, SelfCalibrationOptions{}.prior_sigmas);
    for (int i = 0; i < 80; ++i) robot.look(i, calibration);
    const RefinedCalibration found = calibration.estimate();
    const Calibration truth = changed(given, error);
    EXPECT_GT(disparity_error(given, truth), 0.08) << "seed " << seed;
    EXPECT_LT(disparity_error(found.calibration, truth), 0.02) << "seed " << seed;
    EXPECT_LT((found.change - error).cwiseQuotient(found.sigma_after).cwiseAbs().maxCoeff(), 4.0) << "seed " << seed;
  }
}

// All disparities err by half a pixel, so lengths err by half a pixel's share of the disparities.
TEST(CalibrationOnMap, TellsTheErrorOfLengthsUntilItsEstimateIsApplied) {
  constexpr double kOff = 0.5;    // pixels
  constexpr double kLeft = 0.08;  // pixels, see length_sigma()
  constexpr int kCentreOfRight = kRightCamera + 2;
  const Calibration given = scene_calibration();
  CalibrationVector error = CalibrationVector::Zero();
  error[kCentreOfRight] = kOff / calibration_parameters()[kCentreOfRight].sigma;
  LookingAbout robot(given, error);
  CalibrationOnMap calibration(given, SelfCalibrationOptions{}.prior_sigmas);
  std::shared_ptr<const Features> seen;
  for (int i = 0; i < 40; ++i) seen = robot.look(i, calibration);
  const double left = length_sigma(*seen);
  EXPECT_GT(left, 0.001);
  EXPECT_NEAR(calibration.length_sigma(*seen, CalibrationVector::Zero()), left * kOff / kLeft,
              0.3 * left * kOff / kLeft);
  EXPECT_LT(calibration.length_sigma(*seen, calibration.estimate().change), 1.5 * left);
}

TEST(CalibrationOnMap, KeepsTheGivenCalibrationWithFewObservations) {
  const Calibration given = scene_calibration();
  const CalibrationOnMap calibration(given, SelfCalibrationOptions{}.prior_sigmas);
  const RefinedCalibration found = calibration.estimate();
  EXPECT_EQ(found.change.norm(), 0.0);
  EXPECT_EQ(found.keyframes, 0);
}

}  // namespace
}  // namespace byre
