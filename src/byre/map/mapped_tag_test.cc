#include "byre/map/mapped_tag.h"

#include "byre/features/tag_scene.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/geometry/tag_pose.h"

#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr TagId kDoor{TagFamily::tag36h11, 12};
const Tag kTag{kDoor, 0.2};
const Pose kWorldFromTag{rotation_exp({0.0, 0.4, 0.0}), {0.3, -0.2, 3.0}};

Rig rig() {
  Rig rig;
  rig.width = 640;
  rig.height = 480;
  rig.focal = 450.0;
  rig.cx = 320.0;
  rig.cy = 240.0;
  return rig;
}

Keyframe keyframe_at(double x) {
  Keyframe keyframe;
  keyframe.frame.features = std::make_shared<const Features>();
  keyframe.camera_from_world = {Eigen::Quaterniond::Identity(), {-x, 0.0, 0.0}};
  TagSighting seen{kDoor, {}};
  const auto in_tag = tag_corners(kTag.size);
  for (std::size_t i = 0; i < in_tag.size(); ++i) {
    seen.corners[i] = rig().project(keyframe.camera_from_world * kWorldFromTag * in_tag[i]).head<2>();
  }
  keyframe.frame.tags = {seen};
  return keyframe;
}

MapGraph map_with_views(int views) {
  MapGraph map(Origin::online);
  map.add_rig(rig());
  for (int i = 0; i < views; ++i) map.add_keyframe(keyframe_at(0.3 * i));
  return map;
}

MappedTag mapped() {
  return {kDoor, 0.2, kWorldFromTag, 0.01};
}

TEST(MapTags, EstimatesThePoseByTheCornersInKeyframes) {
  const auto [tags, warnings] = map_tags(map_with_views(5), std::span(&kTag, 1));
  EXPECT_THAT(warnings, IsEmpty());
  ASSERT_THAT(tags, SizeIs(1));
  EXPECT_EQ(tags[0].id, kDoor);
  EXPECT_GT(tags[0].sigma, 0.0);
  EXPECT_LT(tags[0].sigma, 0.03);
  EXPECT_THAT(tags[0].map_from_tag, PoseNear(kWorldFromTag, 1e-5, 1e-5));
}

TEST(MapTags, LeavesOutTagsOfOneViewAndUnknownTags) {
  EXPECT_THAT(map_tags(map_with_views(1), std::span(&kTag, 1)).tags, IsEmpty());
  const Tag other{{TagFamily::tag36h11, 13}, 0.2};
  EXPECT_THAT(map_tags(map_with_views(5), std::span(&other, 1)).tags, IsEmpty());
}

TEST(MappedTagNotes, AreReadBackUnchanged) {
  std::map<std::string, std::string> notes{{"site", "barn"}};
  const MappedTag tag = mapped();
  write_tags(std::span(&tag, 1), notes);
  const auto read = stored_tags(notes);
  ASSERT_THAT(read, SizeIs(1));
  EXPECT_EQ(read[0].id, tag.id);
  EXPECT_EQ(read[0].size, tag.size);
  EXPECT_EQ(read[0].sigma, tag.sigma);
  EXPECT_EQ(read[0].map_from_tag.translation, tag.map_from_tag.translation);
  EXPECT_THAT(read[0].map_from_tag, PoseNear(tag.map_from_tag, 0.0, 1e-12));
}

TEST(MappedTagNotes, InAnotherFormatAreIgnored) {
  std::map<std::string, std::string> notes;
  const MappedTag tag = mapped();
  write_tags(std::span(&tag, 1), notes);
  const std::string sound = notes.at("tag tag36h11 12");
  EXPECT_THAT(
      stored_tags({{"tag", sound}, {"tag tag36h11", sound}, {"tag tag36h11 -1", sound}, {"tag tag36h11 1x", sound}}),
      IsEmpty());
  EXPECT_THAT(stored_tags({{"tag tag36h11 12", ""}}), IsEmpty());
  for (const auto& [part, wrong] : {std::pair("size_m 0.2", "size_m -1"), std::pair("size_m 0.2", "size_m nan"),
                                    std::pair("position_m 0.3", "position_m 1e300"), std::pair("sigma_m", "sigma"),
                                    std::pair("sigma_m 0.01", "sigma_m -1")}) {
    std::string damaged = sound;
    ASSERT_NE(damaged.find(part), std::string::npos) << part;
    damaged.replace(damaged.find(part), std::string(part).size(), wrong);
    EXPECT_THAT(stored_tags({{"tag tag36h11 12", damaged}}), IsEmpty()) << wrong;
  }
}

TEST(MovedTags, HaveScaledLengthsInTheOtherFrame) {
  const Pose turn{rotation_exp({0.0, 0.0, 0.5}), {1.0, 2.0, 3.0}};
  const MappedTag there = moved({mapped()}, {2.0, turn}).front();
  EXPECT_DOUBLE_EQ(there.size, 0.4);
  EXPECT_DOUBLE_EQ(there.sigma, 0.02);
  const Similarity target_from_map{2.0, turn};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d corner = there.map_from_tag * tag_corners(there.size)[i];
    EXPECT_THAT(corner, PointNear(target_from_map * (kWorldFromTag * tag_corners(0.2)[i]), 1e-12));
  }
}

TEST(SurveyedTags, AreAddedAtTheirPlaceOnThePlanUnlessTheMapHasThem) {
  StoredMap stored;
  PlanRegistration plan;
  plan.plan_from_map = {1.0, {rotation_exp({0.0, 0.0, 0.3}), {5.0, 6.0, 0.7}}};
  stored.plan = plan;
  const MappedTag known = mapped();
  write_tags(std::span(&known, 1), stored.notes);
  Tag on_wall{{TagFamily::tag36h11, 3}, 0.16, SurveyedTag{{4.0, 1.0, 1.5}, 0.03, 0.5 * std::numbers::pi}};
  Tag same{kDoor, 0.2, on_wall.survey}, without_heading{{TagFamily::tag36h11, 4}, 0.2, SurveyedTag{{1.0, 1.0, 1.0}}};
  add_surveyed_tags(stored, std::vector{on_wall, same, without_heading});
  const auto tags = stored_tags(stored.notes);
  ASSERT_THAT(tags, SizeIs(2));
  EXPECT_EQ(tags[1].map_from_tag.translation, known.map_from_tag.translation);
  const Pose plan_from_tag = plan.plan_from_map.target_from_source * tags[0].map_from_tag;
  EXPECT_THAT(plan_from_tag.translation, PointNear(Eigen::Vector3d(4.0, 1.0, 1.5), 1e-9));
  EXPECT_THAT(plan_from_tag.rotation * -Eigen::Vector3d::UnitZ(), PointNear(Eigen::Vector3d::UnitY(), 1e-9))
      << "faces the heading";
  EXPECT_THAT(plan_from_tag.rotation * -Eigen::Vector3d::UnitY(), PointNear(Eigen::Vector3d::UnitZ(), 1e-9))
      << "is upright";
}

// Keyframes in another unit than metres.
MapGraph map_with_unit(double lengths_per_metre) {
  MapGraph map(Origin::online);
  map.add_rig(rig());
  for (int i = 0; i < 8; ++i) {
    Keyframe keyframe = keyframe_at(0.2 * i);
    keyframe.camera_from_world.translation *= lengths_per_metre;
    map.add_keyframe(keyframe);
  }
  return map;
}

TEST(UnitsByTags, AreThoseOfTheKeyframes) {
  const auto units = units_by_tags(map_with_unit(2.5), std::span(&kTag, 1));
  ASSERT_THAT(units, SizeIs(1));
  EXPECT_NEAR(units.at(kDoor).lengths_per_metre, 2.5, 1e-3);
  EXPECT_THAT(units_by_tags(map_with_unit(2.5), {}), IsEmpty());
}

TEST(UnitsByTags, AreEmptyForAStandingCamera) {
  MapGraph map(Origin::online);
  map.add_rig(rig());
  for (int i = 0; i < 8; ++i) map.add_keyframe(keyframe_at(0.0));
  EXPECT_THAT(units_by_tags(map, std::span(&kTag, 1)), IsEmpty());
}

TEST(CommonUnit, NeedsTwoTagsThatAgreeAndFewerThatDoNot) {
  const TagId one{TagFamily::tag36h11, 1}, two{TagFamily::tag36h11, 2}, three{TagFamily::tag36h11, 3},
      four{TagFamily::tag36h11, 4};
  const UnitEstimate right{2.5, 0.02}, close{2.55, 0.02}, wrong{5.6, 0.02};
  EXPECT_FALSE(common_unit({}));
  EXPECT_FALSE(common_unit({{one, right}})) << "its size may be wrong";
  EXPECT_FALSE(common_unit({{one, right}, {two, wrong}}));
  EXPECT_FALSE(common_unit({{one, right}, {two, close}, {three, wrong}, {four, wrong}}));
  const auto unit = common_unit({{one, right}, {two, wrong}, {three, close}});
  ASSERT_TRUE(unit);
  EXPECT_NEAR(unit->lengths_per_metre, 2.525, 0.005);
}

// Images of tags on a wall in front of a camera that drives along it, detected and mapped.
TagMapping mapped_from_images(const std::vector<std::pair<Tag, Pose>>& hung, std::span<const Tag> given) {
  const std::array families = {TagFamily::tag36h11};
  TagDetector detector(families);
  MapGraph map(Origin::online);
  map.add_rig(rig_of_tags());
  for (int i = 0; i < 12; ++i) {
    for (const auto& [tag, world_from_tag] : hung) {
      Keyframe keyframe;
      keyframe.frame.features = std::make_shared<const Features>();
      keyframe.camera_from_world = {Eigen::Quaterniond::Identity(), {-0.4 * i, 0.0, 0.0}};
      const Pose camera_from_tag = keyframe.camera_from_world * world_from_tag;
      if (std::abs(camera_from_tag.translation.x()) > 1.6) continue;
      const Image image = image_of_tag(rig_of_tags(), tag, camera_from_tag);
      keyframe.frame.tags = detector.detect(view_of(image));
      map.add_keyframe(keyframe);
    }
  }
  return map_tags(map, given);
}

TEST(MapTags, FindsTagsInImagesWithinACentimetre) {
  if (!can_detect_tags()) GTEST_SKIP() << "built without libapriltag";
  const Pose world_from_tag = camera_from_upright_tag({2.0, -0.3, 3.0}, 0.2);
  const auto [tags, warnings] = mapped_from_images({{kTag, world_from_tag}}, {&kTag, 1});
  EXPECT_THAT(warnings, IsEmpty());
  ASSERT_THAT(tags, SizeIs(1));
  EXPECT_THAT(tags[0].map_from_tag, PoseNear(world_from_tag, 0.01, 0.02));
}

TEST(MapTags, LeavesOutATagOfAnotherSizeWithTheRightSizeInAWarning) {
  if (!can_detect_tags()) GTEST_SKIP() << "built without libapriltag";
  const Tag printed{kDoor, 0.45}, sound{{TagFamily::tag36h11, 7}, 0.2};
  const std::vector given{Tag{kDoor, 0.2}, sound};
  const auto [tags, warnings] = mapped_from_images({{printed, camera_from_upright_tag({1.0, -0.3, 3.0}, 0.2)},
                                                    {sound, camera_from_upright_tag({2.5, 0.2, 2.5}, -0.2)}},
                                                   given);
  ASSERT_THAT(tags, SizeIs(1));
  EXPECT_EQ(tags[0].id, sound.id);
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_THAT(to_text(warnings[0]), HasSubstr("tag36h11 12 measures 0.45 m in the map instead of 0.2 m"));
  EXPECT_THAT(warnings[0].remedy, HasSubstr("correct its size"));
}

TEST(MapTags, LeavesOutATagWithACopyWithAWarning) {
  if (!can_detect_tags()) GTEST_SKIP() << "built without libapriltag";
  const auto [tags, warnings] = mapped_from_images(
      {{kTag, camera_from_upright_tag({0.5, -0.3, 3.0}, 0.2)}, {kTag, camera_from_upright_tag({4.5, -0.3, 3.0}, 0.2)}},
      {&kTag, 1});
  EXPECT_THAT(tags, IsEmpty());
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_THAT(to_text(warnings[0]), HasSubstr("tag36h11 12 is seen at places 4"));
  EXPECT_THAT(warnings[0].remedy, HasSubstr("remove tags with the same number"));
}

}  // namespace
}  // namespace byre
