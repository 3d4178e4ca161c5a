#include "byre/slam/places/place_view.h"

#include "byre/map/scaled_copy.h"
#include "byre/slam/places/place_scene.h"

#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

struct Counts {
  int expected = 0;
  int seen = 0;
};

Counts counts_of(const PlaceView& view) {
  Counts counts;
  for (const CellInView& cell : view.cells) counts = {counts.expected + cell.expected, counts.seen + cell.seen};
  return counts;
}

// Frame 10 of a mission, tracked at its true pose on a true map of every fourth frame.
class ViewOfAPlace : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrame = 10;

  TrackedFrame tracked_at(const Pose& camera_from_world) const {
    TrackedFrame tracked;
    tracked.camera_from_world = camera_from_world;
    const Keyframe& keyframe = *offline_->map().find_keyframe(offline_->map().keyframe_ids()[kFrame / 4]);
    for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
      const Sighting& sighting = keyframe.sightings[i];
      if (sighting.point) tracked.features.push_back({0, *sighting.point, sighting.pixel, 1.0f});
    }
    return tracked;
  }
  PlaceViewQuery query(const TrackedFrame& tracked, std::span<const PointId> candidates = {}) const {
    return {offline_->map(), mission_.rig, mission_.frames[kFrame], tracked, nearby_, candidates};
  }

  const SimulatedMission mission_ = quarter_circle({});
  const std::shared_ptr<const OfflineMap> offline_ = offline_map_of(mission_);
  const Pose pose_ = true_camera_from_world(mission_, kFrame);
  const ScratchVector<PointId> nearby_ = points_of_place(*offline_, keyframes_of_place(*offline_, pose_));
};

TEST_F(ViewOfAPlace, ExpectsPointsOfNearbyKeyframes) {
  const TrackedFrame tracked = tracked_at(pose_);
  const PlaceView view = view_of_place(query(tracked));
  EXPECT_TRUE(view.is_near_keyframe);
  const Counts counts = counts_of(view);
  EXPECT_GT(counts.expected, 60);
  EXPECT_GT(counts.seen, counts.expected / 3);
  EXPECT_LE(counts.seen, counts.expected);
  EXPECT_TRUE(std::ranges::is_sorted(view.cells, {}, &CellInView::cell));
}

TEST_F(ViewOfAPlace, ExpectsTheCandidatesWithoutNearbyKeyframes) {
  const Pose ten_metres_up = pose_ * Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, -10.0}};
  EXPECT_TRUE(keyframes_of_place(*offline_, ten_metres_up).empty());
  const TrackedFrame tracked = tracked_at(pose_);
  PlaceViewQuery far = query(tracked, nearby_);
  far.nearby = {};
  const PlaceView view = view_of_place(far);
  EXPECT_FALSE(view.is_near_keyframe);
  EXPECT_EQ(counts_of(view).expected, counts_of(view_of_place(query(tracked))).expected);
}

TEST_F(ViewOfAPlace, ExpectsSeenPointsOfOtherKeyframes) {
  const TrackedFrame tracked = tracked_at(pose_);
  PlaceViewQuery half = query(tracked);
  half.nearby = std::span(nearby_).first(nearby_.size() / 2);
  const Counts counts = counts_of(view_of_place(half)), all = counts_of(view_of_place(query(tracked)));
  EXPECT_EQ(counts.seen, all.seen);
  EXPECT_LT(counts.expected, all.expected);
}

TEST_F(ViewOfAPlace, LeavesOutRecordingsThatTheFrameHardlyShows) {
  const TrackedFrame tracked = tracked_at(pose_);
  MapGraph map = offline_->map();
  const KeyframeId by_night = map.add_keyframe([&] {
    Keyframe keyframe = *map.find_keyframe(map.keyframe_ids()[kFrame / 4]);
    keyframe.recording = 1;
    keyframe.parent = map.keyframe_ids().front();
    for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
    return keyframe;
  }());
  ScratchVector<PointId> points = nearby_;
  const std::vector<Sighting> by_day = map.find_keyframe(map.keyframe_ids()[kFrame / 4])->sightings;
  for (int feature = 0; feature < static_cast<int>(by_day.size()); ++feature) {
    const Sighting& seen = by_day[static_cast<std::size_t>(feature)];
    if (!seen.point) continue;
    MapPoint point = *map.find_point(*seen.point);
    point.reference = {by_night, feature};
    points.push_back(map.add_point(point));
    map.add_observation({by_night, feature}, {points.back(), seen.pixel, seen.pixel_sigma});
  }
  PlaceViewQuery of_both = query(tracked);
  const PlaceViewQuery both{map, of_both.rig, of_both.frame, tracked, points, {}};
  EXPECT_EQ(counts_of(view_of_place(both)).expected, counts_of(view_of_place(query(tracked))).expected);

  TrackedFrame lost = tracked;
  lost.features.clear();
  const PlaceViewQuery unseen{map, of_both.rig, of_both.frame, lost, points, {}};
  EXPECT_GT(counts_of(view_of_place(unseen)).expected, counts_of(view_of_place(both)).expected)
      << "a frame that shows nothing of any recording is evidence against all";
}

TEST_F(ViewOfAPlace, IsEmptyForAFrameWithoutMatches) {
  TrackedFrame tracked = tracked_at(pose_);
  tracked.features.clear();
  EXPECT_EQ(counts_of(view_of_place(query(tracked))).seen, 0);
}

TEST_F(ViewOfAPlace, OmitsPointsThatAreNeverExpected) {
  const TrackedFrame tracked = tracked_at(pose_);
  PlaceViewQuery all_moved = query(tracked);
  all_moved.is_left_out = [](PointId) { return true; };
  EXPECT_TRUE(view_of_place(all_moved).cells.empty());
}

TEST_F(ViewOfAPlace, HasCellsByPointPosition) {
  const TrackedFrame tracked = tracked_at(pose_);
  for (const double metre : {1.0, 0.3}) {
    PlaceViewQuery scaled = query(tracked);
    scaled.metre = metre;
    const PlaceView view = view_of_place(scaled);
    EXPECT_EQ(counts_of(view).seen, counts_of(view_of_place(query(tracked))).seen);
    for (const CellInView& cell : view.cells) {
      if (cell.seen == 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(std::floor(cell.centre_of_seen[axis] / 2.0), cell.cell[static_cast<std::size_t>(axis)]);
      }
    }
  }
}

TEST_F(ViewOfAPlace, HasSmallerCellsInTheMapOfADesk) {
  const auto unit_of = [&](double factor) {
    MapGraph map = true_map(mission_, 4, Origin::offline);
    rescale(map, factor);
    return OfflineMap(std::move(map), simulated_vocabulary()).cell_unit();
  };
  EXPECT_EQ(unit_of(1.0), 1.0) << "a room";
  const double fifth = unit_of(0.2);
  EXPECT_LT(fifth, 0.5);
  EXPECT_NEAR(unit_of(0.1), fifth / 2.0, 0.01);
}

}  // namespace
}  // namespace byre
