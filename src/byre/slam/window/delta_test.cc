#include "byre/slam/window/delta.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/window/hybrid_scene.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;

constexpr WindowOptions kWindow{.movable = 6, .anchors = 4};
constexpr KeyframeId kNewestKeyframe{Origin::online, 19};

// Outliers give features without a point.
MapGraph make_map() {
  SimulationOptions options;
  options.outlier_ratio = 0.2;
  return true_map(quarter_circle(options), 2, Origin::online);
}

const Sighting& sighting_at(const MapWindow& window, const WindowObservation& seen) {
  return window.keyframes[static_cast<std::size_t>(seen.keyframe)]
      .keyframe.sightings[static_cast<std::size_t>(seen.feature)];
}

// Changes a window at random, like mapping.
class RandomMapping {
 public:
  RandomMapping(MapWindow& window, std::uint64_t seed) : window_(window), random_(seed) {}

  void step() {
    switch (below(7)) {
      case 0:
        return move_keyframe();
      case 1:
        return move_point();
      case 2:
        return remove_some_point();
      case 3:
        return drop_observation();
      case 4:
        return observe_once_more();
      case 5:
        return add_point();
      default:
        if (below(20) == 0) remove_keyframe();
    }
  }

 private:
  int below(std::size_t limit) { return static_cast<int>(random_() % limit); }
  WindowKeyframe& any_keyframe() {
    return window_.keyframes[static_cast<std::size_t>(below(window_.keyframes.size()))];
  }
  int any_point() { return below(window_.points.size()); }
  WindowPoint& point_at(int index) { return window_.points[static_cast<std::size_t>(index)]; }

  bool sees(int point, int keyframe) {
    return std::ranges::any_of(point_at(point).observations,
                               [&](const WindowObservation& seen) { return seen.keyframe == keyframe; });
  }

  std::optional<WindowObservation> any_free_feature() {
    const int keyframe = below(window_.keyframes.size());
    const WindowKeyframe& entry = window_.keyframes[static_cast<std::size_t>(keyframe)];
    const int feature = below(entry.point_of_feature.size());
    const bool is_free = entry.point_of_feature[static_cast<std::size_t>(feature)] == kNoPoint && !entry.removed;
    return is_free ? std::optional(WindowObservation{keyframe, feature}) : std::nullopt;
  }

  void move_keyframe() {
    WindowKeyframe& keyframe = any_keyframe();
    if (keyframe.movable) keyframe.keyframe.camera_from_world.translation.x() += 0.01;
  }
  void move_point() { point_at(any_point()).point.position_in_world.y() += 0.01; }
  void remove_some_point() { remove_point(window_, any_point()); }

  void drop_observation() {
    const int index = any_point();
    const WindowPoint& point = point_at(index);
    if (point.observations.empty()) return;
    drop(index, point.observations[static_cast<std::size_t>(below(point.observations.size()))]);
  }

  // Removes an observation, and the point if it has none left, or is new with fewer than two; keeps the reference
  // valid.
  void drop(int index, const WindowObservation& seen) {
    remove_observation(window_, seen);
    WindowPoint& point = point_at(index);
    const std::size_t needed = point.id ? 1 : 2;
    if (point.observations.size() + static_cast<std::size_t>(point.observations_elsewhere) < needed) {
      remove_point(window_, index);
    } else if (!point.id) {
      const WindowObservation& first = point.observations.front();
      point.point.reference = {window_.keyframes[static_cast<std::size_t>(first.keyframe)].id, first.feature};
    }
  }

  void observe_once_more() {
    const int point = any_point();
    const auto seen = any_free_feature();
    if (!seen || point_at(point).removed || sees(point, seen->keyframe)) return;
    Sighting sighting = sighting_at(window_, *seen);
    sighting.point = point_at(point).id;
    add_observation(window_, point, *seen, sighting);
  }

  void add_point() {
    const auto first = any_free_feature();
    const auto second = any_free_feature();
    if (!first || !second || first->keyframe == second->keyframe) return;
    WindowPoint made;
    made.point.position_in_world = {static_cast<double>(below(100)), 0.0, 0.0};
    made.point.reference = {window_.keyframes[static_cast<std::size_t>(first->keyframe)].id, first->feature};
    window_.points.push_back(made);
    const int index = static_cast<int>(window_.points.size()) - 1;
    for (const WindowObservation& seen : {*first, *second}) {
      Sighting sighting = sighting_at(window_, seen);
      sighting.point.reset();
      add_observation(window_, index, seen, sighting);
    }
  }

  void remove_keyframe() {
    const int index = below(window_.keyframes.size());
    WindowKeyframe& keyframe = window_.keyframes[static_cast<std::size_t>(index)];
    if (!keyframe.movable) return;
    for (int feature = 0; feature < static_cast<int>(keyframe.point_of_feature.size()); ++feature) {
      const int point = keyframe.point_of_feature[static_cast<std::size_t>(feature)];
      if (point >= 0) drop(point, {index, feature});
    }
    keyframe.removed = true;
  }

  MapWindow& window_;
  std::mt19937_64 random_;
};

// Points made in the window have no id there: only their positions are compared.
void expect_same_point(const MapGraph& map, const WindowPoint& point, const std::optional<PointId>& seen) {
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen, point.id.value_or(*seen));
  ASSERT_NE(map.find_point(*seen), nullptr);
  EXPECT_EQ(map.find_point(*seen)->position_in_world, point.point.position_in_world);
}

void expect_same_keyframe(const MapGraph& map, const MapWindow& window, const WindowKeyframe& expected) {
  const Keyframe* const keyframe = map.find_keyframe(expected.id);
  ASSERT_EQ(keyframe == nullptr, expected.removed);
  if (expected.removed) return;
  EXPECT_THAT(keyframe->camera_from_world, PoseNear(expected.keyframe.camera_from_world, 0.0, 1e-7));
  for (std::size_t f = 0; f < expected.point_of_feature.size(); ++f) {
    const int point = expected.point_of_feature[f];
    if (point == kPointElsewhere) continue;
    if (point == kNoPoint) {
      EXPECT_EQ(keyframe->sightings[f].point, std::nullopt);
      continue;
    }
    expect_same_point(map, window.points[static_cast<std::size_t>(point)], keyframe->sightings[f].point);
    EXPECT_EQ(keyframe->sightings[f].pixel, expected.keyframe.sightings[f].pixel);
  }
}

void expect_same(const MapGraph& map, const MapWindow& window) {
  for (const WindowKeyframe& keyframe : window.keyframes) expect_same_keyframe(map, window, keyframe);
  for (const WindowPoint& point : window.points) {
    if (!point.id) continue;
    EXPECT_EQ(map.find_point(*point.id) == nullptr, point.removed);
  }
}

TEST(Difference, OfAnUnchangedWindowIsEmpty) {
  const MapGraph map = make_map();
  const MapWindow window = cut_window(map, {kNewestKeyframe}, kWindow);
  const MapDelta delta = difference(window, window);
  EXPECT_THAT(delta.moved_keyframes, IsEmpty());
  EXPECT_THAT(delta.updated_points, IsEmpty());
  EXPECT_THAT(delta.removed_points, IsEmpty());
  EXPECT_THAT(delta.removed_observations, IsEmpty());
  EXPECT_THAT(delta.new_observations, IsEmpty());
  EXPECT_THAT(delta.new_points, IsEmpty());
  EXPECT_THAT(delta.removed_keyframes, IsEmpty());
  EXPECT_THAT(delta.removed_foreign_views, IsEmpty());
  EXPECT_THAT(delta.new_foreign_views, IsEmpty());
}

class RandomDelta : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  static MapWindow changed(MapWindow window, std::uint64_t seed) {
    RandomMapping mapping(window, seed);
    for (int i = 0; i < 400; ++i) mapping.step();
    return window;
  }

  // Changes by the frame thread and by other deltas while a job runs.
  static void change_meanwhile(MapGraph& map, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const std::vector<PointId> points = map.point_ids();
    const auto some_point = [&] { return points[random() % points.size()]; };
    for (int i = 0; i < 40; ++i) {
      map.remove_point(some_point());
      const KeyframeId keyframe{Origin::online, static_cast<std::uint32_t>(random() % 20)};
      if (i % 20 == 0) map.remove_keyframe(keyframe);
      const Keyframe* const entry = map.find_keyframe(keyframe);
      if (entry == nullptr) continue;
      const int feature = static_cast<int>(random() % entry->sightings.size());
      map.remove_observation({keyframe, feature});
      map.add_observation({keyframe, feature}, {some_point(), {1.0f, 1.0f}});
    }
  }

  MapGraph map_ = make_map();
  const MapWindow before_ = cut_window(map_, {kNewestKeyframe}, kWindow);
  const MapWindow after_ = changed(before_, GetParam());
};

TEST_P(RandomDelta, MakesTheMapEqualToTheWindow) {
  apply(difference(before_, after_), map_);
  expect_same(map_, after_);
  EXPECT_THAT(find_faults(map_), IsEmpty());
}

TEST_P(RandomDelta, IsEqualFromMapAndWindow) {
  MapGraph by_window = map_;
  apply(difference(before_, after_), by_window);
  apply(difference(map_, after_), map_);
  expect_same(map_, after_);
  EXPECT_EQ(map_.point_ids(), by_window.point_ids());
  for (const KeyframeId id : map_.keyframe_ids()) {
    const Keyframe& keyframe = *map_.find_keyframe(id);
    EXPECT_THAT(by_window.find_keyframe(id)->camera_from_world, PoseNear(keyframe.camera_from_world, 0.0, 0.0));
    for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
      EXPECT_EQ(by_window.find_keyframe(id)->sightings[i].point, keyframe.sightings[i].point);
    }
  }
}

TEST_P(RandomDelta, IsEqualFromOutlineAndWindow) {
  const MapWindow outline = outline_of(before_);
  EXPECT_THAT(outline.keyframes.front().keyframe.sightings, IsEmpty());
  const MapDelta expected = difference(before_, after_), delta = difference(outline, after_);
  EXPECT_EQ(delta.removed_observations.size(), expected.removed_observations.size());
  EXPECT_EQ(delta.new_observations.size(), expected.new_observations.size());
  EXPECT_EQ(delta.moved_keyframes.size(), expected.moved_keyframes.size());
  EXPECT_EQ(delta.updated_points.size(), expected.updated_points.size());
  apply(delta, map_);
  expect_same(map_, after_);
}

TEST_P(RandomDelta, SkipsRemovedElements) {
  const MapDelta delta = difference(before_, after_);
  change_meanwhile(map_, GetParam());
  apply(delta, map_);
  EXPECT_THAT(find_faults(map_), IsEmpty());
}

TEST_P(RandomDelta, LeavesAnEmptyMapEmpty) {
  MapGraph empty(Origin::online);
  apply(difference(before_, after_), empty);
  EXPECT_EQ(empty.keyframe_count(), 0);
  EXPECT_EQ(empty.point_count(), 0);
  EXPECT_THAT(find_faults(empty), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomDelta, ::testing::Range(std::uint64_t{1}, std::uint64_t{21}));

// The point has a single observation, which moves to another keyframe.
TEST(Apply, KeepsAPointWhoseOnlyObservationChanges) {
  MapGraph map = make_map();
  const PointId id = *map.find_keyframe(kNewestKeyframe)->sightings.front().point;
  const std::vector<Observation> seen_by = map.observations(id);
  for (std::size_t i = 1; i < seen_by.size(); ++i) map.remove_observation(seen_by[i]);
  const MapWindow before = cut_window(map, {kNewestKeyframe}, kWindow);

  MapWindow after = before;
  const auto point = static_cast<int>(std::ranges::find(after.points, id, &WindowPoint::id) - after.points.begin());
  const auto& free_of = after.keyframes[1].point_of_feature;
  const WindowObservation other{1, static_cast<int>(std::ranges::find(free_of, kNoPoint) - free_of.begin())};
  ASSERT_LT(static_cast<std::size_t>(other.feature), free_of.size());
  Sighting sighting = sighting_at(after, other);
  sighting.point = id;
  sighting.pixel.x() += 0.5f;
  remove_observation(after, after.points[static_cast<std::size_t>(point)].observations.front());
  add_observation(after, point, other, sighting);

  apply(difference(before, after), map);
  expect_same(map, after);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

// The newest online keyframe (0), an offline one (1), and two online points seen by the first.
class DeltaOfForeignViews : public ::testing::Test {
 protected:
  DeltaOfForeignViews() {
    for (const Sighting& sighting : scene_.online.find_keyframe(kNewestKeyframe)->sightings) {
      if (sighting.point && sighting.point->origin == Origin::online) points_.push_back(*sighting.point);
    }
    const WindowOptions options{.movable = 1, .anchors = 0, .offline_anchors = 1};
    EXPECT_TRUE(scene_.online.add_foreign_view(view_of(0, points_[0])));
    before_ = cut_window(scene_.view(), {kNewestKeyframe}, options);
    after_ = before_;
  }

  static constexpr KeyframeId kOffline{Origin::offline, 19};

  // The n-th feature of the offline keyframe without a point.
  int free_feature(int n) const {
    const std::vector<Sighting>& sightings = scene_.offline.find_keyframe(kOffline)->sightings;
    for (int i = 0; i < static_cast<int>(sightings.size()); ++i) {
      if (!sightings[static_cast<std::size_t>(i)].point && n-- == 0) return i;
    }
    return -1;
  }
  ForeignView view_of(int n, PointId point) const { return {{kOffline, free_feature(n)}, {point, {1.0f, 2.0f}, 0.5f}}; }
  int index_of(PointId id) const {
    return static_cast<int>(std::ranges::find(after_.points, std::optional(id), &WindowPoint::id) -
                            after_.points.begin());
  }
  void apply_difference() {
    ASSERT_EQ(before_.keyframes[1].id, kOffline);
    apply(difference(before_, after_), scene_.online);
    EXPECT_THAT(find_faults(scene_.online), IsEmpty());
  }

  HybridScene scene_ = true_hybrid_scene({});
  std::vector<PointId> points_;
  MapWindow before_;
  MapWindow after_;
};

TEST_F(DeltaOfForeignViews, AddsThemToTheOnlineMap) {
  add_observation(after_, index_of(points_[1]), {1, free_feature(1)}, {points_[1], {3.0f, 4.0f}, 0.7f});
  apply_difference();
  ASSERT_EQ(scene_.online.foreign_views(points_[1]).size(), 1u);
  const ForeignView& view = scene_.online.foreign_views(points_[1]).front();
  EXPECT_EQ(view.observation, (Observation{kOffline, free_feature(1)}));
  EXPECT_EQ(view.sighting.pixel, Eigen::Vector2f(3.0f, 4.0f));
  EXPECT_EQ(scene_.online.foreign_views(points_[0]).size(), 1u) << "unchanged";
}

TEST_F(DeltaOfForeignViews, RemovesThemFromTheOnlineMap) {
  remove_observation(after_, {1, free_feature(0)});
  apply_difference();
  EXPECT_THAT(scene_.online.foreign_views(points_[0]), IsEmpty());
  EXPECT_NE(scene_.online.find_point(points_[0]), nullptr);
}

TEST_F(DeltaOfForeignViews, ReassignsAFeatureToAnotherPoint) {
  remove_observation(after_, {1, free_feature(0)});
  add_observation(after_, index_of(points_[1]), {1, free_feature(0)}, {points_[1], {3.0f, 4.0f}, 0.7f});
  apply_difference();
  EXPECT_EQ(scene_.online.point_of_foreign_view({kOffline, free_feature(0)}), points_[1]);
}

TEST_F(DeltaOfForeignViews, RemovesThemWithTheirPoint) {
  remove_point(after_, index_of(points_[0]));
  apply_difference();
  EXPECT_EQ(scene_.online.point_of_foreign_view({kOffline, free_feature(0)}), std::nullopt);
}

TEST_F(DeltaOfForeignViews, AddsThemWithANewPoint) {
  const auto& features = after_.keyframes[0].point_of_feature;
  const int own =
      static_cast<int>(std::ranges::find_if(features, [](int point) { return point >= 0; }) - features.begin());
  remove_observation(after_, {0, own});
  WindowPoint made;
  made.point.reference = {kNewestKeyframe, own};
  after_.points.push_back(made);
  const int index = static_cast<int>(after_.points.size()) - 1;
  add_observation(after_, index, {0, own}, {});
  add_observation(after_, index, {1, free_feature(1)}, {std::nullopt, {3.0f, 4.0f}, 0.7f});
  apply_difference();
  const auto point = scene_.online.point_of_foreign_view({kOffline, free_feature(1)});
  ASSERT_TRUE(point);
  EXPECT_EQ(scene_.online.find_keyframe(kNewestKeyframe)->sightings[static_cast<std::size_t>(own)].point, point);
}

TEST_F(DeltaOfForeignViews, KeepsAFeatureThatWasReassignedMeanwhile) {
  remove_observation(after_, {1, free_feature(0)});
  scene_.online.remove_foreign_view({kOffline, free_feature(0)});
  scene_.online.add_foreign_view(view_of(0, points_[2]));
  apply_difference();
  EXPECT_EQ(scene_.online.point_of_foreign_view({kOffline, free_feature(0)}), points_[2]);
}

TEST(Apply, DropsANewPointWithOneRemainingKeyframe) {
  MapGraph map = make_map();
  const MapWindow before = cut_window(map, {kNewestKeyframe}, kWindow);
  MapWindow after = before;
  WindowPoint made;
  made.point.reference = {after.keyframes[0].id, 0};
  after.points.push_back(made);
  const int index = static_cast<int>(after.points.size()) - 1;
  for (const int keyframe : {0, 1}) {
    const int freed = after.keyframes[static_cast<std::size_t>(keyframe)].point_of_feature[0];
    if (freed >= 0) remove_point(after, freed);
    add_observation(after, index, {keyframe, 0}, {});
  }
  const MapDelta delta = difference(before, after);
  map.remove_keyframe(after.keyframes[1].id);
  apply(delta, map);
  EXPECT_EQ(map.find_keyframe(after.keyframes[0].id)->sightings[0].point, std::nullopt);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

}  // namespace
}  // namespace byre
