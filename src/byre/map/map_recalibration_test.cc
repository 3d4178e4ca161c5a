#include "byre/features/recalibrated.h"
#include "byre/map/map_graph.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr int kWidth = 640, kHeight = 480;

Calibration camera(double distortion) {
  Calibration calibration;
  calibration.left = {CameraModel::radial_tangential, kWidth, kHeight, 400.0, 400.0, 320.0, 240.0, {distortion}};
  return calibration;
}

std::shared_ptr<const Features> corner_at(float x, float y) {
  return std::make_shared<const Features>(kWidth, kHeight, std::vector<Keypoint>{Keypoint{{x, y}}},
                                          std::vector<Descriptor>(1), std::vector<Patch>{});
}

class RecalibratedKeyframes : public ::testing::Test {
 protected:
  RecalibratedKeyframes() : rig_(map_.add_rig(rectification_of(camera(0.0)).rig)) {}

  KeyframeId add(std::shared_ptr<const Features> features) {
    Keyframe keyframe;
    keyframe.rig = rig_;
    keyframe.frame.features = std::move(features);
    return map_.add_keyframe(std::move(keyframe));
  }
  std::shared_ptr<const Features> features(KeyframeId id) const { return map_.find_keyframe(id)->frame.features; }
  float column_of(KeyframeId id) const { return features(id)->keypoint(0).pixel.x(); }
  float moved(float column) const { return recalibrated(Eigen::Vector2f(column, 240.0f), change_).x(); }

  const RectifiedChange change_{camera(0.0), camera(0.05)};
  MapGraph map_{Origin::online};
  int rig_ = 0;
};

TEST_F(RecalibratedKeyframes, UseThePreparedFeatures) {
  const std::shared_ptr<const Features> seen = corner_at(520.0f, 240.0f);
  const KeyframeId id = add(seen);
  const auto made = std::make_shared<const Features>(recalibrated(*seen, change_));
  map_.recalibrate(rig_, change_, std::array{RecalibratedFeatures{id, seen, made}});
  EXPECT_EQ(features(id), made);
  EXPECT_GT(std::abs(column_of(id) - 520.0f), 0.5f);
  EXPECT_FLOAT_EQ(column_of(id), moved(520.0f));
}

TEST_F(RecalibratedKeyframes, AreRecomputedIfTheirFeaturesHaveChanged) {
  const std::shared_ptr<const Features> seen = corner_at(520.0f, 240.0f), older = corner_at(420.0f, 240.0f);
  const KeyframeId changed = add(seen), added = add(corner_at(120.0f, 240.0f));
  map_.recalibrate(rig_, change_, std::array{RecalibratedFeatures{changed, older, corner_at(421.0f, 240.0f)}});
  EXPECT_FLOAT_EQ(column_of(changed), moved(520.0f));
  EXPECT_FLOAT_EQ(column_of(added), moved(120.0f));
}

TEST_F(RecalibratedKeyframes, KeepTheirPointsInSight) {
  const KeyframeId id = add(corner_at(520.0f, 240.0f));
  const Rig before = map_.rigs()[0];
  MapPoint point;
  point.position_in_world = 3.0 * before.ray({520.0, 240.0});
  point.reference = {id, 0};
  const PointId seen = map_.add_point(point);
  map_.recalibrate(rig_, change_, {});
  const Eigen::Vector3d in_camera = map_.camera_from_world(id) * map_.find_point(seen)->position_in_world;
  EXPECT_NEAR(in_camera.z(), 3.0, 0.05);
  EXPECT_NEAR(map_.rigs()[0].project(in_camera).x(), moved(520.0f), 0.01);
}

}  // namespace
}  // namespace byre
