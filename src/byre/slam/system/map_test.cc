#include "byre/map.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/map/plan/floor_plan_scene.h"
#include "byre/map/stored_map_scene.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/slam.h"

#include <limits>
#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Map small_map() {
  return Map(StoredMapScene().stored());
}

template <typename Attempt>
std::string refusal(Attempt attempt) {
  try {
    attempt();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Map, IsTheSameAfterSavingAndLoading) {
  const fs::path path = fs::path(testing::TempDir()) / ("byre_map_test." + std::to_string(getpid()) + ".byre");
  small_map().save(path);
  const Map loaded = Map::load(path);
  fs::remove(path);
  EXPECT_EQ(loaded.to_bytes(), small_map().to_bytes());
  EXPECT_EQ(Map::from_bytes(loaded.to_bytes(), "bytes").to_bytes(), loaded.to_bytes());
  EXPECT_THAT(refusal([&] { Map::load(path); }), HasSubstr(path.string()));
  EXPECT_THAT(refusal([] { Map::from_bytes({}, "nothing"); }), HasSubstr("nothing"));
}

TEST(Map, ListsKeyframesWithTheirMeasurements) {
  const StoredMap stored = StoredMapScene().stored();
  const Map map(stored);
  EXPECT_EQ(map.keyframes(), 6);
  for (int i = 0; i < map.keyframes(); ++i) {
    const MapKeyframe keyframe = map.keyframe(i);
    const Keyframe& inner = *stored.map.find_keyframe({Origin::offline, static_cast<std::uint32_t>(i)});
    EXPECT_EQ(keyframe.id, i);
    EXPECT_EQ(keyframe.time, inner.frame.time);
    EXPECT_THAT(keyframe.map_from_camera * inner.camera_from_world, PoseNear(Pose{}, 1e-12, 1e-12));
    EXPECT_THAT(keyframe.map_from_body * keyframe.rig.body_from_camera,
                PoseNear(keyframe.map_from_camera, 1e-12, 1e-12));
    EXPECT_THAT(keyframe.pixels, SizeIs(static_cast<std::size_t>(keyframe.features->size())));
    EXPECT_THAT(keyframe.points, SizeIs(keyframe.pixels.size()));
    for (std::size_t feature = 0; feature < keyframe.points.size(); ++feature) {
      const Sighting& sighting = inner.sightings[feature];
      EXPECT_EQ(keyframe.points[feature], sighting.point ? static_cast<int>(sighting.point->number) : -1);
      EXPECT_EQ(keyframe.pixels[feature], sighting.pixel);
    }
  }
  EXPECT_FALSE(map.keyframe(0).parent);
  EXPECT_EQ(map.keyframe(1).parent, 0);
}

TEST(Map, ListsObservationsFromBothSides) {
  const Map map = small_map();
  int observations = 0;
  for (int point = 0; point < map.points(); ++point) {
    for (const MapObservation& seen : map.observations(point)) {
      const MapKeyframe keyframe = map.keyframe(seen.keyframe);
      EXPECT_EQ(keyframe.points.at(static_cast<std::size_t>(seen.feature)), point);
      EXPECT_EQ(keyframe.pixels.at(static_cast<std::size_t>(seen.feature)), seen.pixel);
      ++observations;
    }
  }
  EXPECT_EQ(map.observations(), observations);
  EXPECT_GT(observations, map.points());
  const std::vector<int> counts = map.observation_counts();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0), observations);
}

TEST(Map, CountsTheRecordingsOfAPoint) {
  const Map map = small_map();
  const std::vector<int> counts = map.recording_counts();
  ASSERT_THAT(counts, SizeIs(static_cast<std::size_t>(map.points())));
  std::set<int> different;
  for (int point = 0; point < map.points(); ++point) {
    std::set<int> recordings;
    for (const MapObservation& seen : map.observations(point)) {
      recordings.insert(map.keyframe(seen.keyframe).recording);
    }
    EXPECT_EQ(counts[static_cast<std::size_t>(point)], static_cast<int>(recordings.size()));
    different.insert(static_cast<int>(recordings.size()));
  }
  EXPECT_THAT(different, ElementsAre(1, 2));
}

TEST(Map, DescribesItself) {
  EXPECT_EQ(small_map().summary(), "6 keyframes, 16 points, 2 recordings, metric");
  EXPECT_THAT(Map(StoredMapScene().stored_with_plan()).summary(), HasSubstr("registered on barn 3, ground floor"));
  EXPECT_EQ(small_map().recordings().front().name, "barn_morning");
  EXPECT_EQ(small_map().notes().at("site"), "barn 3");
  EXPECT_THAT(small_map().trajectory(0), SizeIs(5));
  EXPECT_THAT(small_map().trajectory(1), SizeIs(1));
}

TEST(Map, FindsPointsInView) {
  const Map map = small_map();
  const MapKeyframe keyframe = map.keyframe(0);
  const std::vector<int> far = map.points_in_view(keyframe.map_from_body, 100.0);
  const std::vector<int> near = map.points_in_view(keyframe.map_from_body, 8.0);
  EXPECT_THAT(far, SizeIs(testing::Gt(near.size())));
  for (int point = 0; point < map.points(); ++point) {
    const Eigen::Vector3d in_camera = inverse(keyframe.map_from_camera) * map.position(point);
    const bool is_in_view = in_camera.z() > 0.0 && keyframe.rig.contains(keyframe.rig.project(in_camera).head<2>());
    EXPECT_EQ(std::ranges::binary_search(far, point), is_in_view);
    EXPECT_EQ(std::ranges::binary_search(near, point), is_in_view && in_camera.norm() <= 8.0);
  }
}

TEST(Map, FindsTheNearestPointsAndKeyframes) {
  const Map map = small_map();
  const Eigen::Vector3d place = map.position(7);
  const std::vector<int> nearest = map.nearest_points(place, 4);
  ASSERT_THAT(nearest, SizeIs(4));
  EXPECT_EQ(nearest.front(), 7);
  const double farthest = (map.position(nearest.back()) - place).norm();
  EXPECT_THAT(map.points_in_sphere(place, farthest), testing::UnorderedElementsAreArray(nearest));
  EXPECT_THAT(map.nearest_points(place, 1000), SizeIs(static_cast<std::size_t>(map.points())));
  EXPECT_THAT(map.nearest_points(place, -1), IsEmpty());
  EXPECT_EQ(map.keyframes_near(map.keyframe(2).map_from_camera.translation, 100.0).front(), 2);
  EXPECT_THAT(map.keyframes_near(map.keyframe(2).map_from_camera.translation, 1e-6), ElementsAre(2));
}

TEST(Map, FindsPointsOfABoxAndOfAPolygonOnThePlan) {
  const Map map(StoredMapScene().stored_with_plan());
  const Eigen::Vector3d low(-5.0, -10.0, -1.0), high(5.0, 2.0, 3.0);
  const std::vector<int> in_box = map.points_in_box(low, high);
  EXPECT_THAT(in_box, SizeIs(testing::AllOf(testing::Gt(1u), testing::Lt(16u))));
  for (int point = 0; point < map.points(); ++point) {
    const Eigen::Vector3d& at = map.position(point);
    const bool is_inside = (at.array() >= low.array()).all() && (at.array() <= high.array()).all();
    EXPECT_EQ(std::ranges::binary_search(in_box, point), is_inside);
  }
  // The same box seen from above, as the registration turns about z.
  std::vector<Eigen::Vector2d> corners;
  for (const auto& [x, y] : {std::pair(-5.0, -10.0), {5.0, -10.0}, {5.0, 2.0}, {-5.0, 2.0}}) {
    corners.push_back((map.plan()->plan_from_map * Eigen::Vector3d(x, y, 0.0)).head<2>());
  }
  EXPECT_EQ(map.points_in_polygon(corners), in_box);
  EXPECT_THAT(refusal([&] { small_map().points_in_polygon(corners); }), HasSubstr("not registered"));
}

TEST(Map, WithoutPointsIsValidAndKeepsTheOthers) {
  const Map map = small_map();
  const std::vector<int> removed = {0, 3, 5, 5, -1, 1000};
  const Map edited = map.without_points(removed);
  EXPECT_THAT(find_faults(edited.stored()), IsEmpty());
  ASSERT_EQ(edited.points(), map.points() - 3);
  EXPECT_EQ(map.points(), 16) << "the map itself does not change";
  int kept = 0;
  for (int point = 0; point < map.points(); ++point) {
    if (std::ranges::find(removed, point) != removed.end()) continue;
    EXPECT_EQ(edited.position(kept), map.position(point));
    EXPECT_EQ(edited.observation_counts()[static_cast<std::size_t>(kept)],
              map.observation_counts()[static_cast<std::size_t>(point)]);
    ++kept;
  }
  EXPECT_EQ(Map::from_bytes(edited.to_bytes(), "edited").to_bytes(), edited.to_bytes());
}

TEST(Map, DiffersFromItsEditByTheRemovedPoints) {
  const Map map = small_map();
  const std::vector<int> removed = {2, 5, 7};
  const MapDifference difference = map.difference(map.without_points(removed));
  EXPECT_EQ(difference.removed_points, removed);
  EXPECT_THAT(difference.added_points, IsEmpty());
  EXPECT_THAT(difference.removed_keyframes, IsEmpty());
  const MapDifference reversed = map.without_points(removed).difference(map);
  EXPECT_EQ(reversed.added_points, removed);
}

TEST(Map, WithoutPointsHasNoKeyframesThatLostAllOfThem) {
  const Map map = small_map();
  std::vector<int> first_half(8);  // points of keyframes 0 to 2; keyframe 0 has no parent
  std::iota(first_half.begin(), first_half.end(), 0);
  const Map edited = map.without_points(first_half);
  EXPECT_THAT(find_faults(edited.stored()), IsEmpty());
  ASSERT_EQ(edited.keyframes(), map.keyframes() - 2);
  EXPECT_THAT(edited.keyframe(0).points, IsEmpty());
  EXPECT_EQ(edited.keyframe(1).time, map.keyframe(3).time);
  EXPECT_THAT(edited.keyframe(1).map_from_body, PoseNear(map.keyframe(3).map_from_body, 1e-12, 1e-12));
}

TEST(Map, TransformsPosesAndRefusesWhatIsNoSimilarity) {
  const Similarity target_from_map{2.0, {rotation_exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}}};
  const Map map = small_map();
  const Map moved = map.transformed(target_from_map);
  EXPECT_THAT(moved.keyframe(1).map_from_camera.translation,
              PointNear(target_from_map * map.keyframe(1).map_from_camera.translation, 1e-12));
  EXPECT_THAT(moved.position(3), PointNear(target_from_map * map.position(3), 1e-12));
  EXPECT_NEAR(moved.keyframe(0).rig.baseline, 2.0 * map.keyframe(0).rig.baseline, 1e-12);
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(refusal([&] { map.transformed({scale, {}}); }), HasSubstr("not a similarity"));
  }
}

TEST(Map, IsRegisteredOnAPlanByPicks) {
  FloorPlanScene scene;
  StoredMap stored;
  stored.map = scene.driven_map(scene.path_in_map());
  const Map map(stored);
  std::vector<PlanCorrespondence> picks;
  for (const auto& [x, y] : {std::pair(2.0, 1.0), {35.0, -4.0}, {20.0, 6.0}, {10.0, -5.0}, {30.0, 5.0}}) {
    picks.push_back({"", scene.in_map({x, y, 1.0}), {x, y}, 0.05});
  }
  const PlanFit fit = map.register_on_plan("barn.png", picks);
  EXPECT_LT(fit.rms, 1e-3);
  const Map on_plan = map.with_plan(fit);
  EXPECT_EQ(on_plan.plan()->plan, "barn.png");
  EXPECT_THAT(on_plan.plan()->plan_from_map * picks[1].point_in_map, PointNear(Eigen::Vector3d(35.0, -4.0, 1.0), 0.1));
  const Tag tag{{TagFamily::tag36h11, 3}, 0.2, SurveyedTag{{35.0, -4.0, 1.0}, 0.02, 0.0}};
  EXPECT_THAT(refusal([&] { map.with_tags({&tag, 1}); }), HasSubstr("not registered on a floor plan"));
  const auto tags = on_plan.with_tags({&tag, 1}).tags();
  ASSERT_EQ(tags.size(), 1U);
  EXPECT_THAT(on_plan.plan()->plan_from_map * tags[0].map_from_tag.translation, PointNear(tag.survey->position, 1e-6));
  EXPECT_THAT(refusal([&] { map.register_on_plan("barn.png", {}); }), HasSubstr("two distant points"));
  EXPECT_THAT(refusal([&] { Map(StoredMap()).register_on_plan("barn.png", picks); }), HasSubstr("vertical"));
  EXPECT_THAT(refusal([&] { map.with_plan(fit, -1.0); }), HasSubstr("residuals"));
}

class MapOfARoom : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const fs::path path = fs::path(testing::TempDir()) / ("byre_map_of_a_room." + std::to_string(getpid()) + ".byre");
    SlamOptions options;
    options.workers = Workers::repeatable;
    const auto recording = open_recording(RenderedFixture::shared().folder(), {});
    Slam slam = Slam::mapping(recording->calibration(), options);
    for (int i = 0; i < recording->size(); ++i) slam.process(view_of(recording->read(i).value()));
    slam.finish();
    slam.save(path);
    map_.emplace(Map::load(path));
    fs::remove(path);
  }
  static void TearDownTestSuite() { map_.reset(); }

  static ImageFrame image(int index) {
    return open_recording(RenderedFixture::shared().folder(), {})->read(index).value();
  }
  // True motion of the body since the first frame, which is the map's frame.
  static Pose true_pose(std::size_t index) {
    const Trajectory& truth = RenderedFixture::shared().truth();
    return inverse(truth.front().world_from_body) * truth[index].world_from_body;
  }

  inline static std::optional<Map> map_;
};

TEST_F(MapOfARoom, LocalisesImagesOfItsCamera) {
  Localiser localiser(*map_);
  for (const int frame : {5, 13}) {
    const LocalisationReport report = localiser.localise(view_of(image(frame)));
    ASSERT_TRUE(report.map_from_body) << to_string(report.failure);
    EXPECT_THAT(*report.map_from_body, PoseNear(true_pose(static_cast<std::size_t>(frame)), 0.03, 0.01));
    EXPECT_GE(report.inliers, 40);
    EXPECT_GT(report.covariance.trace(), 0.0);
    EXPECT_EQ(report.failure, LocalisationFailure::none);
  }
}

TEST_F(MapOfARoom, LocalisesTheLeftImageAlone) {
  const ImageFrame frame = image(5);
  CameraImages images = view_of(frame);
  images.right.reset();
  const Calibration stereo = map_->recordings().front().calibration;
  const Calibration left{stereo.left, std::nullopt, stereo.body_from_left};
  for (const Calibration& calibration : {stereo, left}) {
    const LocalisationReport report = Localiser(*map_, calibration).localise(images);
    ASSERT_TRUE(report.map_from_body) << to_string(report.failure);
    EXPECT_THAT(*report.map_from_body, PoseNear(true_pose(5), 0.03, 0.01));
  }
}

TEST_F(MapOfARoom, GivesAReasonForAnImageThatIsNotFound) {
  ImageFrame frame = image(5);
  std::ranges::fill(frame.left.pixels, std::uint8_t{100});
  frame.right.reset();
  Localiser localiser(*map_);
  const LocalisationReport report = localiser.localise(view_of(frame));
  EXPECT_FALSE(report.map_from_body);
  EXPECT_EQ(report.failure, LocalisationFailure::too_few_features);
  frame.left.width /= 2;
  frame.left.pixels.resize(frame.left.pixels.size() / 2);
  EXPECT_THAT(refusal([&] { localiser.localise(view_of(frame)); }), HasSubstr("cannot be localised"));
}

TEST_F(MapOfARoom, LocalisesInItsTransformedCopy) {
  const Similarity target_from_map{1.0, {rotation_exp({0.4, -0.3, 1.2}), {5.0, -3.0, 2.0}}};
  const Map moved = map_->transformed(target_from_map);
  const LocalisationReport report = Localiser(moved).localise(view_of(image(5)));
  ASSERT_TRUE(report.map_from_body) << to_string(report.failure);
  EXPECT_THAT(*report.map_from_body, PoseNear(target_from_map.target_from_source * true_pose(5), 0.03, 0.01));
}

TEST_F(MapOfARoom, LocalisesAfterAnEdit) {
  std::vector<int> every_fourth;
  for (int point = 0; point < map_->points(); point += 4) every_fourth.push_back(point);
  const Map edited = map_->without_points(every_fourth);
  EXPECT_THAT(find_faults(edited.stored()), IsEmpty());
  const LocalisationReport report = Localiser(edited).localise(view_of(image(5)));
  ASSERT_TRUE(report.map_from_body) << to_string(report.failure);
  EXPECT_THAT(*report.map_from_body, PoseNear(true_pose(5), 0.03, 0.01));
}

TEST_F(MapOfARoom, IsMergedWithAMapInAnotherFrame) {
  const Similarity other_from_map{1.0, {rotation_exp({0.0, 0.0, 0.7}), {4.0, -1.0, 0.5}}};
  const Map merged = map_->merged_with(map_->transformed(other_from_map));
  EXPECT_THAT(find_faults(merged.stored()), IsEmpty());
  EXPECT_GT(merged.keyframes(), map_->keyframes());
  EXPECT_EQ(merged.recordings().size(), 2u);
  const LocalisationReport report = Localiser(merged).localise(view_of(image(5)));
  ASSERT_TRUE(report.map_from_body) << to_string(report.failure);
  EXPECT_THAT(*report.map_from_body, PoseNear(true_pose(5), 0.03, 0.01));
}

TEST_F(MapOfARoom, IsNotMergedWithAMapOfOtherPoints) {
  StoredMap mirrored = map_->stored();
  for (const PointId id : mirrored.map.point_ids()) {
    MapPoint point = *mirrored.map.find_point(id);
    point.position_in_world.x() *= -1.0;
    mirrored.map.update_point(id, point);
  }
  EXPECT_THAT(refusal([&] { Map(std::move(mirrored)).merged_with(*map_); }), HasSubstr("cannot be merged"));
}

TEST_F(MapOfARoom, HasGreyValuesOfItsPoints) {
  int known = 0;
  for (int point = 0; point < map_->points(); ++point) known += map_->grey(point).has_value() ? 1 : 0;
  EXPECT_EQ(known, map_->points());
}

TEST(Localiser, NeedsKeyframesAndACalibration) {
  EXPECT_THAT(refusal([] { Localiser{Map(StoredMap{})}; }), HasSubstr("no keyframes"));
  StoredMap stored = StoredMapScene().stored();
  stored.recordings.clear();
  EXPECT_THAT(refusal([&] { Localiser{Map(stored)}; }), HasSubstr("does not contain the calibration"));
}

}  // namespace
}  // namespace byre
