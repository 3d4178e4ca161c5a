#include "byre/map/plan/plan_places.h"

#include "byre/geometry/geometry_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

const Eigen::Vector3d kPointInCamera(1.0, -0.5, 4.0);
constexpr double kPointSigma = 0.1;

// A keyframe with a rectifying rotation of its camera, and a point with a sigma of 0.1 m.
class PlanPlaces : public testing::Test {
 protected:
  PlanPlaces() {
    calibration_.left = {CameraModel::radial_tangential, 640, 480, 400.0, 402.0, 322.0, 239.0,
                         {-0.28, 0.07, 1e-3, 2e-4}};
    calibration_.body_from_left = {rotation_exp({0.0, 1.5, 0.1}), {0.2, 0.1, 0.5}};
    Rig rig{640, 480, 380.0, 320.0, 240.0, 0.11, calibration_.body_from_left * left_from_rectified_};
    Keyframe keyframe;
    keyframe.frame.features = std::make_shared<const Features>(640, 480, std::vector<Keypoint>(2),
                                                               std::vector<Descriptor>(2), std::vector<Patch>{});
    keyframe.camera_from_world = {rotation_exp({0.3, -0.2, 0.5}), {5.0, 6.0, 7.0}};
    stored_.map.add_rig(rig);
    const KeyframeId id = stored_.map.add_keyframe(keyframe);
    point_in_map_ = inverse(keyframe.camera_from_world) * kPointInCamera;
    MapPoint point;
    point.position_in_world = point_in_map_;
    point.covariance = kPointSigma * kPointSigma * Eigen::Matrix3d::Identity();
    point.reference = {id, 0};
    const Eigen::Vector2d pixel_in_rig = rig.project(kPointInCamera).head<2>();
    stored_.map.add_observation(point.reference, {stored_.map.add_point(point), pixel_in_rig.cast<float>(), 1.0f});
    stored_.recordings = {{"barn_morning", calibration_, {}, {}}};
  }

  const Keyframe& keyframe() const { return *stored_.map.find_keyframe({Origin::offline, 0}); }

  Eigen::Vector2d pixel_as_recorded() const {
    return calibration_.left.project(left_from_rectified_ * kPointInCamera).value();
  }

  Pose left_from_rectified_{rotation_exp({0.01, -0.02, 0.03}), Eigen::Vector3d::Zero()};
  Calibration calibration_;
  StoredMap stored_;
  Eigen::Vector3d point_in_map_;
};

TEST_F(PlanPlaces, OfMapPointsHaveTheCovarianceOfTheMap) {
  const std::optional<MapPosition> place = position_of_point(stored_, {Origin::offline, 0});
  ASSERT_TRUE(place.has_value());
  EXPECT_EQ(place->point_in_map, point_in_map_);
  EXPECT_NEAR(place->sigma, kPointSigma, 1e-12);
  EXPECT_FALSE(position_of_point(stored_, {Origin::offline, 1}).has_value());
}

TEST_F(PlanPlaces, AreFoundAtARecordedPixel) {
  const std::optional<MapPosition> place = position_at_pixel(stored_, keyframe(), pixel_as_recorded());
  ASSERT_TRUE(place.has_value());
  EXPECT_THAT(place->point_in_map, PointNear(point_in_map_, 1e-9));
  EXPECT_NEAR(place->sigma, kPointSigma, 1e-4);
}

TEST_F(PlanPlaces, AreLessCertainFartherFromThePixel) {
  const std::optional<MapPosition> place =
      position_at_pixel(stored_, keyframe(), pixel_as_recorded() + Eigen::Vector2d(8.0, 0.0));
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->sigma, std::hypot(kPointSigma, 8.0 / 380.0 * kPointInCamera.z()), 0.01);
}

TEST_F(PlanPlaces, AreEmptyFarFromAllPointsOrWithoutCalibration) {
  const Eigen::Vector2d pixel = pixel_as_recorded();
  EXPECT_FALSE(position_at_pixel(stored_, keyframe(), pixel + Eigen::Vector2d(30.0, 0.0)).has_value());
  stored_.recordings.clear();
  EXPECT_FALSE(position_at_pixel(stored_, keyframe(), pixel).has_value());
}

TEST_F(PlanPlaces, HaveNoSigmaInANonMetricMap) {
  stored_.scale = MapScale::unknown;
  EXPECT_EQ(position_of_point(stored_, {Origin::offline, 0}).value().sigma, 0.0);
  EXPECT_EQ(position_at_pixel(stored_, keyframe(), pixel_as_recorded()).value().sigma, 0.0);
}

TEST_F(PlanPlaces, HaveCorrespondencesWithBothUncertainties) {
  const PlanCorrespondence made = correspondence("gate", {{1.0, 2.0, 3.0}, 0.03}, {7.0, 8.0}, 0.04);
  EXPECT_EQ(made.name, "gate");
  EXPECT_EQ(made.point_in_map, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(made.point_in_plan, Eigen::Vector2d(7.0, 8.0));
  EXPECT_NEAR(made.sigma, 0.05, 1e-12);
}

}  // namespace
}  // namespace byre
