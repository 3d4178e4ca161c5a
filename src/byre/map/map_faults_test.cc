// Faults that callers can cause: invalid values. The map itself keeps links between its parts valid.

#include "byre/map/map_graph.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Keyframe sound_keyframe() {
  Keyframe keyframe;
  keyframe.frame.features = std::make_shared<Features>(640, 480, std::vector<Keypoint>(1, Keypoint{{1.0f, 1.0f}}),
                                                       std::vector<Descriptor>(1), std::vector<Patch>{});
  return keyframe;
}

std::vector<std::string> faults_of(const Keyframe& keyframe) {
  MapGraph map(Origin::online);
  map.add_rig({});
  map.add_keyframe(keyframe);
  return find_faults(map);
}

std::vector<std::string> faults_of_point(const std::function<void(MapPoint&)>& spoil) {
  MapGraph map(Origin::online);
  map.add_rig({});
  const KeyframeId keyframe = map.add_keyframe(sound_keyframe());
  MapPoint point;
  point.reference = {keyframe, 0};
  spoil(point);
  map.add_observation({keyframe, 0}, {map.add_point(point)});
  return find_faults(map);
}

TEST(FindFaults, AcceptsASoundMap) {
  EXPECT_THAT(find_faults(MapGraph(Origin::online)), IsEmpty());
  EXPECT_THAT(faults_of(sound_keyframe()), IsEmpty());
  EXPECT_THAT(faults_of_point([](MapPoint&) {}), IsEmpty());
}

TEST(FindFaults, ReportsAKeyframeWithoutRig) {
  Keyframe keyframe = sound_keyframe();
  keyframe.rig = 1;
  EXPECT_THAT(faults_of(keyframe), ElementsAre("keyframe online 0 has no rig"));
}

TEST(FindFaults, ReportsAnInvalidKeyframePose) {
  Keyframe stretched = sound_keyframe();
  stretched.camera_from_world.rotation.coeffs() *= 2.0;
  EXPECT_THAT(faults_of(stretched), ElementsAre(HasSubstr("an invalid pose")));
  Keyframe nowhere = sound_keyframe();
  nowhere.camera_from_world.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(faults_of(nowhere), ElementsAre(HasSubstr("an invalid pose")));
}

TEST(FindFaults, ReportsMoreSightingsThanFeatures) {
  Keyframe keyframe = sound_keyframe();
  keyframe.sightings.resize(2);
  EXPECT_THAT(faults_of(keyframe), ElementsAre(HasSubstr("one sighting per feature")));
}

TEST(FindFaults, ReportsAnUnobservedPoint) {
  MapGraph map(Origin::offline);
  map.add_point({});
  EXPECT_THAT(find_faults(map), Contains("point offline 0 is not observed by any keyframe"));
}

TEST(FindFaults, ReportsAPointWithInvalidValues) {
  EXPECT_THAT(
      faults_of_point([](MapPoint& point) { point.position_in_world.y() = std::numeric_limits<double>::infinity(); }),
      ElementsAre(HasSubstr("no finite position")));
  EXPECT_THAT(faults_of_point([](MapPoint& point) { point.mean_viewing_direction.setZero(); }),
              ElementsAre(HasSubstr("a viewing direction that is not of unit length")));
  EXPECT_THAT(faults_of_point([](MapPoint& point) { point.min_distance = 2.0f; }),
              ElementsAre(HasSubstr("an invalid distance range")));
  EXPECT_THAT(faults_of_point([](MapPoint& point) { point.reference.feature = 5; }),
              ElementsAre(HasSubstr("a reference keyframe that does not observe it")));
}

}  // namespace
}  // namespace byre
