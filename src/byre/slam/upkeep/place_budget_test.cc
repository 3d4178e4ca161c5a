#include "byre/slam/upkeep/place_budget.h"

#include "byre/slam/places/place_scene.h"
#include "byre/slam/upkeep/point_survival.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr int kBudget = 12;

// A mapped place, and a child in which an update added keyframes at its first camera.
class PlaceBudget : public ::testing::Test {
 protected:
  // A keyframe beside the first one, with the same points.
  KeyframeId add_beside(double metres) {
    Keyframe keyframe = *child_.find_keyframe(child_.keyframe_ids().front());
    keyframe.parent = child_.keyframe_ids().front();
    keyframe.camera_from_world.translation.x() += metres;
    return child_.add_keyframe(std::move(keyframe));
  }
  // A point that these keyframes alone see, in place of one of theirs.
  PointId add_point_seen_by(std::initializer_list<KeyframeId> keyframes) {
    const Keyframe& first = *child_.find_keyframe(*keyframes.begin());
    const auto is_of_parent = [&](const Sighting& seen) { return seen.point && parent_.find_point(*seen.point); };
    const auto feature =
        static_cast<int>(std::ranges::find_if(first.sightings, is_of_parent) - first.sightings.begin());
    const Sighting sighting = first.sightings[static_cast<std::size_t>(feature)];
    MapPoint point = *child_.find_point(*sighting.point);
    point.reference = {*keyframes.begin(), feature};
    const PointId added = child_.add_point(point);
    for (const KeyframeId id : keyframes) {
      child_.remove_observation({id, feature});
      child_.add_observation({id, feature}, {added, sighting.pixel, sighting.pixel_sigma});
    }
    return added;
  }
  int keep(const std::function<bool(const Keyframe&)>& is_kept = [](const Keyframe&) { return false; }) {
    survival_.resize(child_.point_ids().back().number + 1, kSurvivalOfNewPoint);
    return keep_to_budget(parent_, kBudget, survival_, is_kept, child_);
  }
  std::size_t keyframes_at_first() const {
    const std::vector<KeyframeId> ids = child_.keyframe_ids();
    return keyframes_at(child_, ids, child_.find_keyframe(ids.front())->camera_from_world).size();
  }

  const MapGraph parent_ = MappedPlace(quarter_circle(without_noise())).map;
  MapGraph child_ = parent_;
  std::vector<Survival> survival_;
};

TEST_F(PlaceBudget, RemovesNothingFromPlacesWithinIt) {
  EXPECT_EQ(keep(), 0);
  EXPECT_EQ(child_.keyframe_count(), parent_.keyframe_count());
}

TEST_F(PlaceBudget, LimitsTheKeyframesOfAPlace) {
  for (int i = 0; i < 2 * kBudget; ++i) add_beside(0.01 * i);
  EXPECT_GT(keep(), kBudget);
  EXPECT_LE(keyframes_at_first(), std::size_t{kBudget});
  EXPECT_THAT(find_faults(child_), IsEmpty());
}

TEST_F(PlaceBudget, KeepsKeyframesThatAloneSeeTheirPoints) {
  const KeyframeId first = add_beside(0.0), second = add_beside(0.01);
  std::vector<PointId> points;
  for (int i = 0; i < 40; ++i) points.push_back(add_point_seen_by({first, second}));
  for (int i = 0; i < 2 * kBudget; ++i) add_beside(0.02);
  keep();
  EXPECT_NE(child_.find_keyframe(first), nullptr);
  EXPECT_NE(child_.find_keyframe(second), nullptr);
  for (const PointId id : points) EXPECT_NE(child_.find_point(id), nullptr);
}

TEST_F(PlaceBudget, GivesUpKeyframesWhosePointsAreUnlikely) {
  const KeyframeId first = add_beside(0.0), second = add_beside(0.01);
  survival_.assign(child_.point_ids().back().number + 1, kSurvivalOfNewPoint);
  for (int i = 0; i < 40; ++i) {
    survival_.resize(add_point_seen_by({first, second}).number + 1, Survival{-80});
  }
  for (int i = 0; i < 2 * kBudget; ++i) add_beside(0.02);
  keep();
  EXPECT_EQ(child_.find_keyframe(first), nullptr);
  EXPECT_EQ(child_.find_keyframe(second), nullptr);
}

TEST_F(PlaceBudget, LeavesKeptKeyframes) {
  for (int i = 0; i < 2 * kBudget; ++i) add_beside(0.01 * i);
  const int before = child_.keyframe_count();
  EXPECT_EQ(keep([](const Keyframe&) { return true; }), 0);
  EXPECT_EQ(child_.keyframe_count(), before);
}

}  // namespace
}  // namespace byre
