#include "byre/map/plan/plan_places.h"

#include "byre/geometry/geometry_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

const Eigen::Vector3d kPointInCamera(1.0, -0.5, 4.0);
constexpr double kPointSigma = 0.1;

double sigma_of(const MapPosition& place) {
  return std::sqrt(place.covariance.trace() / 3.0);
}

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
  EXPECT_TRUE(place->covariance.isApprox(kPointSigma * kPointSigma * Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(position_of_point(stored_, {Origin::offline, 1}).has_value());
}

TEST_F(PlanPlaces, AreFoundAtARecordedPixel) {
  const std::optional<MapPosition> place = position_at_pixel(stored_, keyframe(), pixel_as_recorded());
  ASSERT_TRUE(place.has_value());
  EXPECT_THAT(place->point_in_map, PointNear(point_in_map_, 1e-9));
  EXPECT_NEAR(sigma_of(*place), kPointSigma, 1e-4);
}

TEST_F(PlanPlaces, AreLessCertainFartherFromThePixel) {
  const std::optional<MapPosition> place =
      position_at_pixel(stored_, keyframe(), pixel_as_recorded() + Eigen::Vector2d(8.0, 0.0));
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(sigma_of(*place), std::hypot(kPointSigma, 8.0 / 380.0 * kPointInCamera.z()), 0.01);
}

TEST_F(PlanPlaces, AreEmptyFarFromAllPointsOrWithoutCalibration) {
  const Eigen::Vector2d pixel = pixel_as_recorded();
  EXPECT_FALSE(position_at_pixel(stored_, keyframe(), pixel + Eigen::Vector2d(30.0, 0.0)).has_value());
  stored_.recordings.clear();
  EXPECT_FALSE(position_at_pixel(stored_, keyframe(), pixel).has_value());
}

TEST_F(PlanPlaces, HaveNoSigmaInANonMetricMap) {
  stored_.scale = MapScale::unknown;
  EXPECT_EQ(position_of_point(stored_, {Origin::offline, 0}).value().covariance.norm(), 0.0);
  EXPECT_EQ(position_at_pixel(stored_, keyframe(), pixel_as_recorded()).value().covariance.norm(), 0.0);
}

TEST_F(PlanPlaces, HaveCorrespondencesWithBothUncertainties) {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 0.02, 0.03).asDiagonal();
  const PlanCorrespondence made = correspondence("gate", {{1.0, 2.0, 3.0}, covariance}, {7.0, 8.0}, 0.04);
  EXPECT_EQ(made.name, "gate");
  EXPECT_EQ(made.point_in_map, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(made.point_in_plan, Eigen::Vector2d(7.0, 8.0));
  EXPECT_EQ(made.covariance_in_map, covariance);
  EXPECT_EQ(made.sigma, 0.04);
}

TEST_F(PlanPlaces, ConvertPixelsBothWays) {
  const Eigen::Vector2d recorded = pixel_as_recorded();
  const auto rectified = rectified_pixel(stored_, keyframe(), recorded);
  ASSERT_TRUE(rectified.has_value());
  EXPECT_THAT(recorded_pixel(stored_, keyframe(), *rectified).value(), PointNear(recorded, 1e-6));
}

// Keyframes of a level camera 1.5 m above the floor, y is down, at several x.
class PlacesInPictures : public testing::Test {
 protected:
  PlacesInPictures() {
    map_.add_rig({376, 240, 188.0, 188.0, 120.0, 0.0, {}});
    for (const double x : {0.0, 1.0, 2.0, 2.001}) {
      Keyframe keyframe;
      keyframe.camera_from_world.translation = {-x, 0.0, 0.0};
      ids_.push_back(map_.add_keyframe(keyframe));
    }
    floor_.point_in_map = {0.0, 1.5, 0.0};
    floor_.up_in_map = {0.0, -1.0, 0.0};
  }

  KeyframePixel pixel_of(int view, const Eigen::Vector3d& point, const Eigen::Vector2d& error = {0.0, 0.0}) const {
    const Keyframe& keyframe = *map_.find_keyframe(ids_[static_cast<std::size_t>(view)]);
    const Eigen::Vector2d pixel = map_.rigs()[0].project(keyframe.camera_from_world * point).head<2>();
    return {ids_[static_cast<std::size_t>(view)], pixel + error};
  }

  MapGraph map_{Origin::offline};
  std::vector<KeyframeId> ids_;
  DrivingPlane floor_;
};

TEST_F(PlacesInPictures, AreTriangulatedWithTheirCovariance) {
  const Eigen::Vector3d corner(0.5, -0.4, 5.0);
  const auto found = triangulate_pixels(map_, std::vector{pixel_of(0, corner), pixel_of(2, corner)});
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->position.point_in_map, PointNear(corner, 1e-9));
  EXPECT_TRUE(found->is_same_place);
  const Eigen::Matrix3d& covariance = found->position.covariance;
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), std::sqrt(2.0) * 25.0 / (188.0 * 2.0), 0.02) << "depth by one pixel";
  EXPECT_LT(covariance(1, 1), 0.1 * covariance(2, 2));
  const auto by_three =
      triangulate_pixels(map_, std::vector{pixel_of(0, corner), pixel_of(1, corner), pixel_of(2, corner)});
  EXPECT_LT(by_three.value().position.covariance.trace(), covariance.trace());
}

TEST_F(PlacesInPictures, AreReportedIfPixelsAreOfDifferentPlaces) {
  const Eigen::Vector3d corner(0.5, -0.4, 5.0);
  const auto noisy = triangulate_pixels(map_, std::vector{pixel_of(0, corner, {1.0, -1.0}), pixel_of(2, corner)});
  EXPECT_TRUE(noisy.value().is_same_place);
  const auto wrong = triangulate_pixels(map_, std::vector{pixel_of(0, corner, {0.0, 12.0}), pixel_of(2, corner)});
  EXPECT_FALSE(wrong.value().is_same_place);
  EXPECT_GT(wrong->error, 5.0);
}

TEST_F(PlacesInPictures, AreEmptyForParallelRays) {
  const Eigen::Vector3d corner(0.5, -0.4, 5.0);
  EXPECT_FALSE(triangulate_pixels(map_, std::vector{pixel_of(2, corner), pixel_of(3, corner)}));
  EXPECT_FALSE(triangulate_pixels(map_, std::vector{pixel_of(0, corner)}));
}

TEST_F(PlacesInPictures, AreOnTheFloorBelowTheHorizon) {
  const Eigen::Vector3d foot(1.0, 1.5, 4.0);
  const auto found = floor_at_pixel(map_, pixel_of(0, foot), floor_, 0.0);
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->point_in_map, PointNear(foot, 1e-9));
  EXPECT_NEAR(std::sqrt(found->covariance(2, 2)), std::hypot(16.0 / (1.5 * 188.0), 0.02 * 4.0 / 1.5), 5e-3);
  EXPECT_NEAR(found->covariance(1, 1), 4e-4, 1e-4) << "height of the floor";
  const Eigen::Vector3d below(1.0, 1.9, 4.0);
  EXPECT_THAT(floor_at_pixel(map_, pixel_of(0, below), floor_, 0.4).value().point_in_map, PointNear(below, 1e-9));
  EXPECT_FALSE(floor_at_pixel(map_, pixel_of(0, {0.0, 0.1, 5.0}), floor_, 0.0)) << "near the horizon";
}

}  // namespace
}  // namespace byre
