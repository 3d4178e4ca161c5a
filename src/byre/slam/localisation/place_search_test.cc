#include "byre/slam/localisation/place_search.h"

#include "byre/slam/places/place_scene.h"

#include <limits>

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

TEST_F(PlaceSearchInTwinRooms, LocalisesNoImageAlone) {
  const OfflineMap* const map = &twins();
  const ImageLocalisation found = localise_image({&map, 1}, mission_.frames[0], mission_.rig);
  EXPECT_FALSE(found.found.tracked);
  EXPECT_EQ(found.found.failure, LocalisationFailure::ambiguous);
}

TEST_F(PlaceSearchInTwinRooms, LocalisesNoImageAloneInOneOfTwoEqualMaps) {
  const OfflineMap room(MappedPlace(mission_).map, twins().places().vocabulary());
  const OfflineMap* const both[] = {&room, &room};
  const ImageLocalisation found = localise_image(both, mission_.frames[0], mission_.rig);
  EXPECT_FALSE(found.found.tracked);
  EXPECT_EQ(found.found.failure, LocalisationFailure::ambiguous);
}

TEST_F(PlaceSearchInTwinRooms, ReturnsBothPlacesAndSelectsNone) {
  const PlaceSearch search = search_place(twins(), {mission_.frames[0], mission_.rig}, {});
  EXPECT_FALSE(search.found);
  EXPECT_THAT(search.places, SizeIs(2));
  EXPECT_EQ(search.time, mission_.frames[0].time);
}

constexpr double kNone = std::numeric_limits<double>::infinity();

// Raises the points of twin rooms that are at least this high (metres), by 0.5 m.
void raise_points(MapGraph& twins, double lowest_in_first, double lowest_in_second) {
  const int of_one_room = twins.point_count() / 2;
  for (const PointId id : twins.point_ids()) {
    MapPoint point = *twins.find_point(id);
    const double lowest = static_cast<int>(id.number) < of_one_room ? lowest_in_first : lowest_in_second;
    if (point.position_in_world.z() < lowest) continue;
    point.position_in_world.z() += 0.5;
    twins.update_point(id, point);
  }
}

// The other room has its upper points elsewhere, which is too few to decide by the number of inliers.
TEST(ImageLocalisation, SelectsTheRoomWithMostOfItsPointsInView) {
  const SimulatedMission mission = lap();
  MappedPlace place = twin_rooms(mission);
  raise_points(place.map, kNone, 1.0);
  const OfflineMap map(place.map, place.index.vocabulary());
  const OfflineMap* const maps[] = {&map};
  int decided = 0;
  for (std::size_t i = 0; i < mission.frames.size(); i += 6) {
    const Frame& frame = mission.frames[i];
    const Localisation by_inliers = localise(frame, mission.rig, place.view(), place.index, {});
    const Localisation likeliest = localise_image(maps, frame, mission.rig).found;
    if (!likeliest.tracked) continue;
    decided += by_inliers.failure == LocalisationFailure::ambiguous;
    EXPECT_LT(inverse(likeliest.tracked->camera_from_world).translation.x(), 5.0) << "frame " << i;
  }
  EXPECT_GE(decided, 3);
}

// Two rooms of a row are mapped, the image is from a third one.
TEST(ImageLocalisation, RefusesThePlaceOfABuildingThatRepeatsBeyondTheMap) {
  const SimulatedMission mission = lap();
  MappedPlace place = twin_rooms(mission);
  raise_points(place.map, 0.4, 0.0);
  const OfflineMap map(place.map, place.index.vocabulary());
  const OfflineMap* const maps[] = {&map};
  int refused = 0;
  for (std::size_t i = 0; i < mission.frames.size(); i += 6) {
    const Localisation found = localise_image(maps, mission.frames[i], mission.rig).found;
    EXPECT_FALSE(found.tracked) << "frame " << i;
    refused += found.failure == LocalisationFailure::ambiguous;
  }
  EXPECT_GE(refused, 3);
}

}  // namespace
}  // namespace byre
