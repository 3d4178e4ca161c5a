#include "byre/slam/localisation/look_alike_places.h"

#include "byre/slam/places/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::SizeIs;

SimulatedMission around_a_room() {
  return simulate_mission(simulated_rig(), circling_trajectory(60, 10.0, 2.0, 1.0), {});
}

TEST(PlacesAlikeInTwinRooms, IncludeTheOtherRoom) {
  const SimulatedMission mission = around_a_room();
  MappedPlace rooms = twin_rooms(mission);
  const std::size_t points_of_one_room = rooms.map.point_ids().size() / 2;
  const OfflineMap map(std::move(rooms.map), rooms.index.vocabulary());
  const std::vector<LookAlikePlace> alike = look_alike_places(map, true_camera_from_world(mission, 0));
  ASSERT_THAT(alike, SizeIs(1));
  EXPECT_LT((alike[0].shift - Eigen::Vector3d(10.0, 0.0, 0.0)).norm(), 0.01);
  const KeyframeId here = map.map().keyframe_ids().front();
  std::vector<PointId> seen;
  for (const Sighting& sighting : map.map().find_keyframe(here)->sightings) {
    if (sighting.point) seen.push_back(*sighting.point);
  }
  ASSERT_GT(seen.size(), 20u);
  EXPECT_THAT(alike[0].repeated, IsSupersetOf(seen)) << "every point of one room is in the other";
  for (PointId& id : seen) id.number += static_cast<std::uint32_t>(points_of_one_room);
  EXPECT_THAT(alike[0].repeated, IsSupersetOf(seen)) << "points of the other room";
}

TEST(PlacesAlikeInOneRoom, AreEmpty) {
  const SimulatedMission mission = around_a_room();
  EXPECT_THAT(look_alike_places(*offline_map_of(mission), true_camera_from_world(mission, 0)), IsEmpty());
}

TEST(LookAlikePlaces, AreAddedAtOtherShiftsUpToSix) {
  const auto at = [](double x) { return LookAlikePlace{{x, 0.0, 0.0}, {}}; };
  std::vector<LookAlikePlace> places = {at(5.0)};
  add_look_alikes(std::vector{at(5.5), at(-5.0), at(10.0)}, places);
  ASSERT_THAT(places, SizeIs(2)) << "the opposite shift is tested as well";
  EXPECT_EQ(places[1].shift.x(), 10.0);
  add_look_alikes(std::vector{at(2.0), at(13.0), at(16.0), at(19.0), at(22.0), at(25.0)}, places);
  EXPECT_THAT(places, SizeIs(6));
}

}  // namespace
}  // namespace byre
