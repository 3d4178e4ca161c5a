#include "byre/viewer/plan_picture.h"

#include "byre/viewer/palette.h"
#include "byre/viewer/picture_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using ::testing::HasSubstr;
using ::testing::Not;

// Barn of 40 x 20 m at 20 pixels per metre below the head. Picture rows count down from y = 20.
constexpr double kPixels = 20.0;
constexpr int kHead = 38;

PlanPictureOptions whole_barn() {
  PlanPictureOptions options;
  options.width = 800;
  options.height = 800;
  options.shown = AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(40.0, 20.0));
  return options;
}

PlanScene level_scene() {
  PlanScene scene;
  scene.ground.is_level = true;
  return scene;
}

ScenePoint point_at(double x, double y, double height, Origin origin) {
  return {Eigen::Vector3d(x, y, height).cast<float>(), origin};
}

cv::Mat drawn(const PlanScene& scene, const PlanPictureOptions& options = whole_barn()) {
  return decoded(to_png(plan_picture(scene, options)));
}

Colour colour_on(const cv::Mat& drawn, double x, double y) {
  return colour_at(drawn, static_cast<int>(kPixels * x), kHead + static_cast<int>(kPixels * (20.0 - y)));
}

bool is_greenish(const Colour& colour) {
  return colour.green > colour.red + 30 && colour.green > colour.blue + 20;
}

bool is_purplish(const Colour& colour) {
  return colour.red > colour.green + 30 && colour.blue > colour.green + 30;
}

// Straight path along y = 10 from x = 5, ten poses per metre and per second.
PlanPath straight_path(int poses) {
  PlanPath path{"round", {}, {}};
  for (int i = 0; i < poses; ++i) {
    path.map_from_body.push_back({from_seconds(0.1 * i), {Eigen::Quaterniond::Identity(), {5.0 + 0.1 * i, 10.0, 0.0}}});
  }
  return path;
}

TEST(PlanPicture, DrawsPointsInTheColourOfTheirMap) {
  PlanScene scene = level_scene();
  scene.map.points = {point_at(10.025, 14.975, 1.0, Origin::offline), point_at(30.025, 4.975, 1.0, Origin::online)};
  const cv::Mat barn = drawn(scene);
  EXPECT_TRUE(is_greenish(colour_on(barn, 10.01, 14.99)));
  EXPECT_TRUE(is_purplish(colour_on(barn, 30.01, 4.99)));
  EXPECT_FALSE(is_greenish(colour_on(barn, 10.5, 15.2)));
}

TEST(PlanPicture, OmitsFloorAndCeilingOnLevelGround) {
  PlanScene scene = level_scene();
  scene.map.points = {point_at(10.0, 15.0, 0.0, Origin::offline), point_at(11.0, 15.0, 2.0, Origin::offline),
                      point_at(12.0, 15.0, 4.0, Origin::offline)};
  EXPECT_EQ(moves_in_class(to_svg(plan_picture(scene, whole_barn())), "offline-points"), 1);
  PlanPictureOptions high = whole_barn();
  high.heights = {1.5, 10.0};
  EXPECT_EQ(moves_in_class(to_svg(plan_picture(scene, high)), "offline-points"), 2);
  scene.ground.is_level = false;
  EXPECT_EQ(moves_in_class(to_svg(plan_picture(scene, whole_barn())), "offline-points"), 3);
}

TEST(PlanPicture, DrawsCoincidentPointsOnceAndOutsideOnesNever) {
  PlanScene scene = level_scene();
  scene.map.points.assign(50, point_at(10.0, 15.0, 1.0, Origin::offline));
  scene.map.points.push_back(point_at(100.0, 15.0, 1.0, Origin::offline));
  EXPECT_EQ(moves_in_class(to_svg(plan_picture(scene, whole_barn())), "offline-points"), 1);
}

TEST(PlanPicture, TransformsTheMapToTheGround) {
  PlanScene scene = level_scene();
  scene.ground.ground_from_map = {
      2.0, {Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), {20.0, 10.0, 0.5}}};
  scene.map.points = {point_at(2.9875, 4.9875, 0.5, Origin::offline)};  // (10.025, 15.975, 1.5) on the ground
  EXPECT_TRUE(is_greenish(colour_on(drawn(scene), 10.01, 15.99)));
}

TEST(PlanPicture, ColoursAPathByVerdict) {
  PlanScene scene = level_scene();
  PlanPath path = straight_path(300);
  path.verdicts.assign(100, Verdict::trusted);
  path.verdicts.resize(200, Verdict::degraded);
  path.verdicts.resize(300, Verdict::untrusted);
  scene.paths = {path};
  const cv::Mat barn = drawn(scene);
  EXPECT_EQ(colour_on(barn, 10.0, 10.0), palette::kTrusted);
  const auto has = [&barn](double from, double to, const Colour& colour) {
    bool found = false;
    for (double x = from; x < to; x += 0.05) found = found || colour_on(barn, x, 10.0) == colour;
    return found;
  };
  EXPECT_TRUE(has(16.0, 24.0, palette::kDegraded));
  EXPECT_TRUE(has(16.0, 24.0, palette::kPaper)) << "dashed";
  EXPECT_TRUE(has(26.0, 34.0, palette::kUntrusted));
  const std::string svg = to_svg(plan_picture(scene, whole_barn()));
  for (const char* const text : {">round, trusted<", ">round, degraded<", ">round, untrusted<", ">start<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(PlanPicture, LeavesGapsWithoutPose) {
  PlanScene scene = level_scene();
  PlanPath path = straight_path(100);
  PlanPath later = straight_path(300);
  path.map_from_body.insert(path.map_from_body.end(), later.map_from_body.begin() + 200, later.map_from_body.end());
  scene.paths = {path};
  const cv::Mat barn = drawn(scene);
  EXPECT_EQ(colour_on(barn, 12.0, 10.0), palette::kPaths[0]);
  EXPECT_EQ(colour_on(barn, 30.0, 10.0), palette::kPaths[0]);
  EXPECT_NE(colour_on(barn, 20.0, 10.0), palette::kPaths[0]);
}

TEST(PlanPicture, DistinguishesPathsByColourAndName) {
  PlanScene scene = level_scene();
  scene.paths = {straight_path(100), straight_path(100)};
  scene.paths[1].name = "evening & night";
  for (StampedPose& sample : scene.paths[1].map_from_body) sample.world_from_body.translation.y() = 4.0;
  const cv::Mat barn = drawn(scene);
  EXPECT_EQ(colour_on(barn, 10.0, 10.0), palette::kPaths[0]);
  EXPECT_EQ(colour_on(barn, 10.0, 4.0), palette::kPaths[1]);
  EXPECT_THAT(to_svg(plan_picture(scene)), HasSubstr(">evening &amp; night<"));
}

TEST(PlanPicture, DrawsTheViewingDirectionAsAWedge) {
  PlanScene scene = level_scene();
  Eigen::Matrix3d map_from_camera;  // level, looking along x of the map
  map_from_camera << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  scene.camera = PlanCamera{{Eigen::Quaterniond(map_from_camera), {20.0, 10.0, 0.0}}, 1.2};
  const cv::Mat barn = drawn(scene);
  EXPECT_EQ(colour_on(barn, 20.0, 10.0), palette::kCamera);
  const Colour ahead = colour_on(barn, 22.3, 10.3);
  EXPECT_GT(ahead.blue, ahead.red + 40);
  const Colour behind = colour_on(barn, 17.7, 10.3);
  EXPECT_EQ(behind.blue, behind.red);
}

TEST(PlanPicture, DerivesTheViewingDirectionFromTheBody) {
  Rig rig{752, 480, 376.0, 376.0, 240.0, 0.1, {}};
  rig.body_from_camera.translation = {0.5, 0.0, 1.0};
  const PlanCamera camera = plan_camera({Eigen::Quaterniond::Identity(), {1.0, 1.0, 1.0}}, rig);
  EXPECT_NEAR(camera.field_of_view, M_PI / 2.0, 1e-9);
  EXPECT_EQ(camera.map_from_camera.translation, Eigen::Vector3d(1.5, 1.0, 2.0));
}

TEST(PlanPicture, JoinsKeyframesExceptAcrossLongGaps) {
  PlanScene scene = level_scene();
  for (int i = 0; i < 20; ++i) {
    SceneKeyframe keyframe{from_seconds(i), {}, Origin::offline};
    keyframe.map_from_body.translation = {(i < 10 ? 2.0 : 20.0) + i, 8.0, 0.0};
    scene.map.keyframes.push_back(keyframe);
  }
  const std::string svg = to_svg(plan_picture(scene, whole_barn()));
  EXPECT_EQ(moves_in_class(svg, "keyframes"), 20);
  const cv::Mat barn = drawn(scene);
  EXPECT_LT(colour_on(barn, 5.5, 8.0).red, 200) << "joined";
  EXPECT_GT(colour_on(barn, 20.5, 8.0).red, 200);
}

// White plan of 400 x 200 pixels of 0.1 m, with a black square of 1 m at (30..31, 4..5).
PlanScene scene_on_plan() {
  PlanScene scene = level_scene();
  FloorPlan plan;
  plan.width = 400;
  plan.height = 200;
  plan.metres_per_pixel = Vector2d(0.1, -0.1).asDiagonal();
  plan.top_left_in_plan = {0.05, 19.95};
  Image image{400, 200, std::vector<std::uint8_t>(80000, 255)};
  for (int row = 150; row < 160; ++row) {
    for (int column = 300; column < 310; ++column) image.pixels[static_cast<std::size_t>(row * 400 + column)] = 0;
  }
  scene.ground.plan = plan;
  scene.ground.image = std::make_shared<const Image>(image);
  return scene;
}

TEST(PlanPicture, DrawsThePlanFirst) {
  const cv::Mat barn = drawn(scene_on_plan());
  EXPECT_LT(colour_on(barn, 30.5, 4.5).red, 140);
  EXPECT_EQ(colour_on(barn, 29.5, 4.5), palette::kPaper);
  EXPECT_EQ(colour_on(barn, 31.5, 4.5), palette::kPaper);
  EXPECT_EQ(colour_on(barn, 30.5, 5.5), palette::kPaper);
}

TEST(PlanPicture, ShowsTheWholePlan) {
  PlanScene scene = scene_on_plan();
  scene.paths = {straight_path(200)};
  const AlignedBox2d shown = shown_ground(scene, {});
  EXPECT_LT((shown.min() - Vector2d(0.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((shown.max() - Vector2d(40.0, 20.0)).norm(), 1e-9);
}

TEST(PlanPicture, ShowsThePartOfALargeSiteWhereTheMapIs) {
  PlanScene scene = scene_on_plan();
  scene.ground.plan->metres_per_pixel *= 20.0;  // 800 x 400 m
  scene.paths = {straight_path(300)};
  const AlignedBox2d shown = shown_ground(scene, {});
  EXPECT_LT(shown.sizes().x(), 60.0);
  EXPECT_TRUE(shown.contains(Vector2d(5.0, 10.0)));
}

TEST(PlanPicture, ShowsTheMapExceptItsFarthestPoints) {
  PlanScene scene = level_scene();
  for (int i = 0; i < 1000; ++i) scene.map.points.push_back(point_at(0.03 * i, 5.0 + i % 7, 1.0, Origin::offline));
  scene.map.points.push_back(point_at(900.0, -500.0, 1.0, Origin::offline));
  const AlignedBox2d shown = shown_ground(scene, {});
  EXPECT_TRUE(shown.contains(Vector2d(15.0, 8.0)));
  EXPECT_LT(shown.max().x(), 35.0);
  EXPECT_GT(shown.min().y(), 2.0);
}

TEST(PlanPicture, FitsTheRequestedSize) {
  PlanPictureOptions options = whole_barn();
  EXPECT_EQ(plan_picture(level_scene(), options).width, 800);
  options.shown = AlignedBox2d(Vector2d(0.0, 0.0), Vector2d(20.0, 40.0));
  const Picture high = plan_picture(level_scene(), options);
  EXPECT_EQ(high.panes[1].height, 800);
}

TEST(PlanPicture, HasALegend) {
  PlanScene scene = level_scene();
  scene.title = "barn <1>";
  scene.map.points = {point_at(10.0, 15.0, 1.0, Origin::offline)};
  const std::string svg = to_svg(plan_picture(scene, whole_barn()));
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_THAT(svg, HasSubstr(">barn &lt;1&gt;<"));
  EXPECT_THAT(svg, HasSubstr(">5 m<")) << "scale bar";
  EXPECT_THAT(svg, HasSubstr(">offline map<"));
  EXPECT_THAT(svg, HasSubstr("from 0.1 to 2.5 m above the driving plane"));
  EXPECT_THAT(svg, Not(HasSubstr(">online map<"))) << "there is none";
}

}  // namespace
}  // namespace byre
