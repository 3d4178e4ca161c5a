#include "byre/slam/localisation/place_search.h"

#include "byre/slam/places/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

SimulatedMission lap() {
  return simulate_mission(simulated_rig(), circling_trajectory(60, 10.0, 2.0, 1.0), {});
}

// Two equal rooms, 10 m apart.
class PlaceSearchInTwinRooms : public ::testing::Test {
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

TEST_F(PlaceSearchInTwinRooms, ReturnsBothPlacesAndSelectsNone) {
  const PlaceSearch search = search_place(twins(), {mission_.frames[0], mission_.rig}, {});
  EXPECT_FALSE(search.found);
  EXPECT_THAT(search.places, SizeIs(2));
  EXPECT_EQ(search.time, mission_.frames[0].time);
}

}  // namespace
}  // namespace byre
