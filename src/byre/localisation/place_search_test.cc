#include "byre/localisation/place_search.h"

#include "byre/slam/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

SimulatedMission lap() {
  return simulate_mission(simulated_rig(), circling_trajectory(60, 10.0, 2.0, 1.0), {});
}

// Two rooms that look the same, ten metres apart.
class SearchInTwinRooms : public ::testing::Test {
 protected:
  static const OfflineMap& twins() {
    static const OfflineMap map = [] {
      MappedPlace place = twin_rooms(lap());
      return OfflineMap(std::move(place.map), place.index.vocabulary());
    }();
    return map;
  }
  const SimulatedMission mission_ = lap();
};

TEST_F(SearchInTwinRooms, ReturnsBothPlacesAndChoosesNone) {
  const PlaceSearch search = search_place(twins(), {mission_.frames[0], mission_.rig}, {});
  EXPECT_FALSE(search.found);
  EXPECT_THAT(search.places, SizeIs(2));
  EXPECT_EQ(search.time, mission_.frames[0].time);
}

TEST_F(SearchInTwinRooms, FindsTheShiftBetweenTheRooms) {
  const std::vector<Eigen::Vector3d> shifts = shifts_to_places_alike(twins(), true_camera_from_world(mission_, 0));
  ASSERT_THAT(shifts, SizeIs(1));
  EXPECT_LT((shifts[0] - Eigen::Vector3d(10.0, 0.0, 0.0)).norm(), 0.01);
}

TEST(SearchInOneRoom, FindsNoShift) {
  const SimulatedMission mission = lap();
  EXPECT_THAT(shifts_to_places_alike(*offline_map_of(mission), true_camera_from_world(mission, 0)), IsEmpty());
}

}  // namespace
}  // namespace byre
