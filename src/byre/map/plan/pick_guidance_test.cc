#include "byre/map/plan/pick_guidance.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/plan/floor_plan_scene.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::SizeIs;

// The driven barn, in which each keyframe sees points on the walls ahead; every keyframe has a picture but the third.
class PickGuidance : public testing::Test {
 protected:
  PickGuidance() : map_(with_features(scene_.driven_map(scene_.path_in_map()))) {
    for (int x = 0; x <= 40; ++x) {
      for (const double y : {-6.0, 6.0}) add_point(scene_.in_map({static_cast<double>(x), y, 1.0}));
    }
    for (const KeyframeId id : map_.keyframe_ids()) {
      if (id.number != 2) map_.set_picture(id, StoredPicture(std::vector<std::byte>(5)));
    }
  }

  std::optional<Eigen::Vector2d> pixel_of(KeyframeId id, const Eigen::Vector3d& point) const {
    const Keyframe& keyframe = *map_.find_keyframe(id);
    const Eigen::Vector3d in_camera = keyframe.camera_from_world * point;
    const Rig& rig = map_.rigs()[0];
    if (!(in_camera.z() > 1.0) || in_camera.z() > 15.0) return std::nullopt;
    const Eigen::Vector2d pixel = rig.project(in_camera).head<2>();
    return rig.contains(pixel) ? std::optional(pixel) : std::nullopt;
  }

  void add_point(const Eigen::Vector3d& position) {
    std::optional<PointId> id;
    for (const KeyframeId keyframe : map_.keyframe_ids()) {
      const auto pixel = pixel_of(keyframe, position);
      if (!pixel) continue;
      if (used_.size() <= keyframe.number) used_.resize(keyframe.number + 1);
      const Observation observation{keyframe, used_[keyframe.number]++};
      if (!id) {
        MapPoint point;
        point.position_in_world = position;
        point.reference = observation;
        id = map_.add_point(point);
      }
      map_.add_observation(observation, {*id, pixel->cast<float>(), 1.0F});
    }
  }

  static MapGraph with_features(const MapGraph& map) {
    MapGraph made(Origin::offline);
    made.add_rig(map.rigs()[0]);
    for (const KeyframeId id : map.keyframe_ids()) {
      Keyframe keyframe = *map.find_keyframe(id);
      keyframe.frame.features = std::make_shared<const Features>(320, 240, std::vector<Keypoint>(100),
                                                                 std::vector<Descriptor>(100), std::vector<Patch>{});
      made.add_keyframe(std::move(keyframe));
    }
    return made;
  }

  FloorPlanScene scene_;
  MapGraph map_;
  std::vector<int> used_;
};

TEST_F(PickGuidance, ShowsAPlaceInFurtherPictures) {
  const Eigen::Vector3d post = scene_.in_map({20.0, 6.0, 1.0});
  const KeyframeId first{Origin::offline, 8};
  const std::vector<KeyframePixel> views = further_views(map_, {first, pixel_of(first, post).value()});
  ASSERT_FALSE(views.empty());
  for (const auto& [id, pixel] : views) {
    EXPECT_NE(id, first);
    EXPECT_NE(id.number, 2U) << "no picture";
    const auto expected = pixel_of(id, post);
    if (expected) {
      EXPECT_LT((pixel - *expected).norm(), 40.0);
    }
  }
  EXPECT_TRUE(pixel_of(views.front().keyframe, post));
}

TEST_F(PickGuidance, PrefersWideViews) {
  const Eigen::Vector3d up = scene_.up_of_rig_in_map();
  const double at_the_end = width_of_view(map_, *map_.find_keyframe({Origin::offline, 36}), up);
  EXPECT_GT(width_of_view(map_, *map_.find_keyframe({Origin::offline, 10}), up), at_the_end);
}

TEST_F(PickGuidance, SuggestsAPickAtTheFarEnd) {
  auto picks = scene_.correspondences(4);
  for (PlanCorrespondence& pick : picks) {  // all within ten metres of the western end
    const Eigen::Vector2d place(0.25 * pick.point_in_plan.x(), pick.point_in_plan.y());
    pick.point_in_plan = place;
    pick.point_in_map = scene_.in_map({place.x(), place.y(), 1.0});
  }
  const DrivingPlane plane = scene_.plane();
  const auto fit = register_on_plan(picks, plane, Scale::fixed);
  ASSERT_TRUE(fit.has_value());
  const auto next = next_pick(map_, plane, fit->registration, 0.05);
  ASSERT_TRUE(next.has_value());
  EXPECT_GT(next->point_in_plan.x(), 25.0);
  EXPECT_THAT(next->views, SizeIs(2));
  EXPECT_LT(next->sigma_after, 0.7 * next->sigma_before);
  EXPECT_FALSE(next_pick(scene_.driven_map(scene_.path_in_map()), plane, fit->registration, 0.05)) << "no points";
}

}  // namespace
}  // namespace byre
