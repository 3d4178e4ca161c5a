#include "byre/slam/window/map_from_model.h"

#include "byre/slam/tracking/mission_scene.h"

#include <map>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr std::size_t kFramesApart = 4;  // 32 cm and 8 degrees

// A monocular mission on a quarter of a circle, and the model of a perfect reconstruction: point n is the n-th landmark
// seen by two images.
class ModelOfAMission : public testing::Test {
 protected:
  explicit ModelOfAMission(const SimulationOptions& options = {})
      : mission_(simulate_mission(mono_rig(), path(), options)) {
    std::map<int, std::vector<int>> images_of_landmark;
    for (std::size_t frame = 0; frame < mission_.frames.size(); frame += kFramesApart) {
      const int image = static_cast<int>(model_.images.size());
      model_.images.push_back({mission_.frames[frame], true_camera_from_world(mission_, frame), 0});
      for (const int landmark : mission_.landmark_of_feature[frame]) {
        if (landmark >= 0) images_of_landmark[landmark].push_back(image);
      }
    }
    model_.rigs = {mission_.rig};
    for (const auto& [landmark, images] : images_of_landmark) {
      if (images.size() < 2) continue;
      model_.points.push_back({mission_.landmarks_in_world[static_cast<std::size_t>(landmark)], images});
      landmarks_.push_back(landmark);
    }
  }

  static Rig mono_rig() {
    Rig rig = simulated_rig();
    rig.baseline = 0.0;
    return rig;
  }
  static Trajectory path() { return circling_trajectory(40, 10.0, 2.0, 0.25); }

  int landmark_seen(const Observation& seen) const {
    return mission_.landmark_of_feature[kFramesApart * seen.keyframe.number][static_cast<std::size_t>(seen.feature)];
  }

  // Share of the observations of model points that show their landmarks.
  double right_share(const ModelMap& made) const {
    int right = 0, all = 0;
    for (std::uint32_t i = 0; i < made.model_points.size(); ++i) {
      const int landmark = landmarks_[static_cast<std::size_t>(made.model_points[i])];
      for (const Observation& seen : made.map.observations({Origin::online, i})) {
        right += landmark_seen(seen) == landmark ? 1 : 0;
        ++all;
      }
    }
    return all == 0 ? 0.0 : static_cast<double>(right) / all;
  }

  static ModelMapOptions of_model_only() {
    ModelMapOptions options;
    options.add_own_points = false;
    return options;
  }

  SimulatedMission mission_;
  SfmModel model_;
  std::vector<int> landmarks_;  // landmark of each model point
};

class ModelOfACleanMission : public ModelOfAMission {
 protected:
  ModelOfACleanMission() : ModelOfAMission(without_noise()) {}
};

TEST_F(ModelOfACleanMission, AssignsFeaturesToPointsAndKeepsPositions) {
  const ModelMap made = map_from_model(model_, of_model_only());
  EXPECT_THAT(find_faults(made.map), IsEmpty());
  EXPECT_GT(made.model_points.size(), 0.9 * static_cast<double>(model_.points.size()));
  EXPECT_GT(right_share(made), 0.99);
  ASSERT_EQ(made.model_points.size(), static_cast<std::size_t>(made.map.point_count()));
  for (std::uint32_t i = 0; i < made.model_points.size(); ++i) {
    EXPECT_EQ(made.map.find_point({Origin::online, i})->position_in_world,
              model_.points[static_cast<std::size_t>(made.model_points[i])].position_in_world);
    EXPECT_GE(made.map.observations({Origin::online, i}).size(), 2u);
  }
}

TEST_F(ModelOfACleanMission, KeepsThePosesOfItsImages) {
  const MapGraph map = map_from_model(model_, {}).map;
  ASSERT_EQ(map.keyframe_count(), static_cast<int>(model_.images.size()));
  for (std::uint32_t i = 0; i < model_.images.size(); ++i) {
    const Keyframe& keyframe = *map.find_keyframe({Origin::online, i});
    EXPECT_EQ(keyframe.camera_from_world.translation, model_.images[i].camera_from_world.translation);
    EXPECT_EQ(keyframe.frame.time, model_.images[i].frame.time);
  }
}

TEST_F(ModelOfACleanMission, OmitsPointsWithoutMatchingFeatures) {
  for (ModelPoint& point : model_.points) point.position_in_world *= 0.8;
  const ModelMap made = map_from_model(model_, of_model_only());
  EXPECT_LT(made.model_points.size(), 0.1 * static_cast<double>(model_.points.size()));
}

TEST_F(ModelOfACleanMission, AssignsAFeatureToOnePointOnly) {
  const std::size_t count = model_.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    ModelPoint beside = model_.points[i];
    beside.position_in_world += Eigen::Vector3d(0.002, 0.002, 0.0);
    model_.points.push_back(beside);
  }
  const ModelMap made = map_from_model(model_, of_model_only());
  EXPECT_THAT(find_faults(made.map), IsEmpty());
  const auto doubles =
      std::ranges::count_if(made.model_points, [count](int point) { return static_cast<std::size_t>(point) >= count; });
  EXPECT_LT(static_cast<double>(doubles), 0.1 * static_cast<double>(count));
}

TEST_F(ModelOfACleanMission, AddsPointsBetweenThoseOfTheModel) {
  const std::vector<ModelPoint> all = model_.points;
  std::set<int> known;
  model_.points.clear();
  for (std::size_t i = 0; i < all.size(); i += 4) {
    model_.points.push_back(all[i]);
    known.insert(landmarks_[i]);
  }
  const ModelMap made = map_from_model(model_, {});
  EXPECT_THAT(find_faults(made.map), IsEmpty());
  int right = 0, own = 0;
  for (const PointId id : made.map.point_ids()) {
    if (id.number < made.model_points.size()) continue;
    ++own;
    const int landmark = landmark_seen(made.map.observations(id).front());
    const Eigen::Vector3d& truth = mission_.landmarks_in_world[static_cast<std::size_t>(landmark)];
    const bool is_new = !known.contains(landmark);
    right += is_new && (made.map.find_point(id)->position_in_world - truth).norm() < 0.05 ? 1 : 0;
  }
  EXPECT_GT(own, static_cast<int>(made.model_points.size()));
  EXPECT_GT(right, 0.95 * own);
}

TEST_F(ModelOfAMission, SelectsCorrectFeaturesUnderNoise) {
  const ModelMap made = map_from_model(model_, of_model_only());
  EXPECT_GT(made.model_points.size(), 0.8 * static_cast<double>(model_.points.size()));
  EXPECT_GT(right_share(made), 0.98);
}

TEST_F(ModelOfAMission, RejectsImagesThatContradictTheModel) {
  const int images = static_cast<int>(model_.images.size());
  for (ModelPoint& point : model_.points) {  // claims that all images see each point
    point.images.clear();
    for (int image = 0; image < images; ++image) point.images.push_back(image);
  }
  EXPECT_GT(right_share(map_from_model(model_, of_model_only())), 0.97);
}

TEST_F(ModelOfAMission, IsMoreCertainForPreciseMeasurements) {
  ModelMapOptions fine = of_model_only(), coarse = of_model_only();
  fine.model_sigma = 0.5;
  coarse.model_sigma = 2.0;
  const MapGraph well_known = map_from_model(model_, fine).map, badly_known = map_from_model(model_, coarse).map;
  for (const PointId id : well_known.point_ids()) {
    const Eigen::Matrix3d& covariance = well_known.find_point(id)->covariance;
    EXPECT_GT(covariance.determinant(), 0.0);
    EXPECT_NEAR(badly_known.find_point(id)->covariance.trace() / covariance.trace(), 16.0, 1e-6);
  }
}

// With exact poses, a point's covariance is that of its reprojection errors. Compared with its definition by the second
// derivatives of the squared errors.
TEST_F(ModelOfACleanMission, HasTheCovarianceOfItsReprojections) {
  const ModelMap made = map_from_model(model_, of_model_only());
  const ModelPoint& point = model_.points[static_cast<std::size_t>(made.model_points.front())];
  const double sigma = ModelMapOptions{}.model_sigma;
  const auto half_squared_error = [&](const Eigen::Vector3d& position) {
    double sum = 0.0;
    for (const int image : point.images) {
      const Pose& camera_from_world = model_.images[static_cast<std::size_t>(image)].camera_from_world;
      const Eigen::Vector3d error = model_.rigs[0].project(camera_from_world * position) -
                                    model_.rigs[0].project(camera_from_world * point.position_in_world);
      sum += 0.5 * error.head<2>().squaredNorm() / (sigma * sigma);
    }
    return sum;
  };
  constexpr double kStep = 1e-4;
  Eigen::Matrix3d information;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const Eigen::Vector3d a = kStep * Eigen::Vector3d::Unit(row), b = kStep * Eigen::Vector3d::Unit(column);
      const Eigen::Vector3d& p = point.position_in_world;
      information(row, column) = (half_squared_error(p + a + b) - half_squared_error(p + a - b) -
                                  half_squared_error(p - a + b) + half_squared_error(p - a - b)) /
                                 (4.0 * kStep * kStep);
    }
  }
  const Eigen::Matrix3d& covariance = made.map.find_point({Origin::online, 0})->covariance;
  EXPECT_LT((information * covariance - Eigen::Matrix3d::Identity()).norm(), 1e-2);
}

TEST(MapFromModel, IsEmptyForAnEmptyModel) {
  const ModelMap made = map_from_model({}, {});
  EXPECT_EQ(made.map.keyframe_count(), 0);
  EXPECT_EQ(made.map.point_count(), 0);
}

TEST_F(ModelOfAMission, OmitsPointsOfASingleImage) {
  for (ModelPoint& point : model_.points) point.images = {point.images.front(), point.images.front()};
  EXPECT_TRUE(map_from_model(model_, of_model_only()).model_points.empty());
}

}  // namespace
}  // namespace byre
