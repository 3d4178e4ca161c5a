#include "byre/slam/localisation/mission.h"

#include "byre/slam/places/place_scene.h"
#include "byre/slam/places/place_view_scene.h"

#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

const Pose kOfflineFromOnline{rotation_exp({0.0, 0.0, 0.02}), {0.3, -0.1, 0.05}};

// Registration tests of an online map.
class RegistrationOfAnOnlineMap : public ::testing::Test {
 protected:
  // A camera with a median depth of 4 m.
  bool is_registered_by(const Pose& offline_from_online, const PlaceView& view = view_of_room(10, 0),
                        const Eigen::Vector3d& camera = {1.0, 2.0, 0.0}, double prior = 0.0) {
    const Mission::RegistrationEvidence seen{offline_from_online, camera, 4.0, view};
    return mission_.test_registrations({&seen, 1}, [&](const Pose&) { return PlaceHypothesis(prior, 3); }).has_value();
  }

  Mission mission_{offline_map_of(quarter_circle({})), {}};
};

TEST_F(RegistrationOfAnOnlineMap, EndsAfterThreeConsistentFrames) {
  EXPECT_FALSE(is_registered_by(kOfflineFromOnline));
  EXPECT_FALSE(is_registered_by(kOfflineFromOnline));
  EXPECT_TRUE(is_registered_by(kOfflineFromOnline));
  EXPECT_FALSE(is_registered_by(kOfflineFromOnline)) << "a new test begins";
}

TEST_F(RegistrationOfAnOnlineMap, DoesNotEndIfMostOfTheMapIsInvisible) {
  for (int frame = 0; frame < 20; ++frame) EXPECT_FALSE(is_registered_by(kOfflineFromOnline, view_of_room(2, 8)));
}

TEST_F(RegistrationOfAnOnlineMap, RequiresMoreEvidenceAgainstMeasuredMotion) {
  const PlaceView two_cells = view_of_room(2, 0), ten_cells = view_of_room(10, 0);
  for (int frame = 0; frame < 5; ++frame) {
    EXPECT_FALSE(is_registered_by(kOfflineFromOnline, two_cells, {1.0, 2.0, 0.0}, kLogOddsOfKidnapping));
  }
  EXPECT_TRUE(is_registered_by(kOfflineFromOnline, ten_cells, {1.0, 2.0, 0.0}, kLogOddsOfKidnapping));
}

TEST_F(RegistrationOfAnOnlineMap, RestartsAfterThreeFramesElsewhere) {
  is_registered_by(kOfflineFromOnline);
  is_registered_by(kOfflineFromOnline);
  for (const double metres : {1.0, 2.0, 3.0}) {
    EXPECT_FALSE(is_registered_by({Eigen::Quaterniond::Identity(), {metres, 0.0, 0.0}}));
  }
  EXPECT_FALSE(is_registered_by(kOfflineFromOnline));
  EXPECT_FALSE(is_registered_by(kOfflineFromOnline));
  EXPECT_TRUE(is_registered_by(kOfflineFromOnline));
}

// Two places that look alike show each frame.
TEST_F(RegistrationOfAnOnlineMap, EndsAtTheLikelierOfTwoPlaces) {
  const Pose likelier{Eigen::Quaterniond::Identity(), {5.0, 0.0, 0.0}};
  const PlaceView four_cells = view_of_room(4, 0), ten_cells = view_of_room(10, 0);
  const Eigen::Vector3d camera(1.0, 2.0, 0.0);
  const std::vector<Mission::RegistrationEvidence> places = {{kOfflineFromOnline, camera, 4.0, four_cells},
                                                             {likelier, camera, 4.0, ten_cells}};
  const auto begin = [](const Pose&) { return PlaceHypothesis(0.0, 3); };
  EXPECT_FALSE(mission_.test_registrations(places, begin));
  EXPECT_FALSE(mission_.test_registrations(places, begin));
  const auto registered = mission_.test_registrations(places, begin);
  ASSERT_TRUE(registered);
  EXPECT_EQ(registered->translation.x(), likelier.translation.x());
}

TEST_F(RegistrationOfAnOnlineMap, ComparesCameraPositions) {
  const Eigen::Vector3d camera(50.0, 0.0, 0.0);
  const Eigen::Quaterniond turn = rotation_exp({0.0, 0.0, 0.005});
  const Pose about_the_camera{turn, camera - turn * camera};
  const PlaceView view = view_of_room(10, 0);
  is_registered_by(Pose{}, view, camera);
  is_registered_by(about_the_camera, view, camera);
  EXPECT_TRUE(is_registered_by(about_the_camera, view, camera));
}

}  // namespace
}  // namespace byre
