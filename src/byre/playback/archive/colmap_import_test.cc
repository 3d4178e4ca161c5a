#include "byre/playback/archive/colmap_import.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/playback/archive/colmap_export.h"
#include "byre/playback/archive/colmap_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using std::chrono::seconds;

class ImportedMap : public testing::Test {
 protected:
  static ColmapImport import(const ColmapModel& model, const ColmapImportOptions& options = {}) {
    const std::filesystem::path images = RenderedFixture::shared().folder() / "mav0/cam0/data";
    return import_colmap(model, "model", images, options, {[] { return false; }, [](int) {}});
  }

  StoredMap exported_ = rendered_map();
  ColmapModel model_ = colmap_model_of(exported_, {});
};

TEST_F(ImportedMap, PreservesPointsAndCamerasOfTheExportedMap) {
  const ColmapImport imported = import(model_);
  const MapGraph& map = imported.stored.map;
  EXPECT_THAT(find_faults(imported.stored), IsEmpty());
  EXPECT_EQ(imported.stored.pose_source, PoseSource::imported);
  EXPECT_THAT(imported.warnings, IsEmpty());
  ASSERT_EQ(map.keyframe_count(), exported_.map.keyframe_count());
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& before = *exported_.map.find_keyframe(id);
    const Keyframe& after = *map.find_keyframe(id);
    EXPECT_EQ(after.frame.time, before.frame.time);
    EXPECT_THAT(inverse(after.camera_from_world).translation,
                PointNear(inverse(before.camera_from_world).translation, 1e-9));
  }
  ASSERT_GT(imported.colmap_ids.size(), 100u);
  for (std::uint32_t i = 0; i < imported.colmap_ids.size(); ++i) {
    const PointId before{Origin::offline, static_cast<std::uint32_t>(imported.colmap_ids[i] - 1)};
    EXPECT_THAT(map.find_point({Origin::offline, i})->position_in_world,
                PointNear(exported_.map.find_point(before)->position_in_world, 1e-9));
  }
}

TEST_F(ImportedMap, IsRejectedIfPosesContradictThePoints) {
  const auto refusal = [](const ColmapModel& model) -> std::string {
    try {
      import(model);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  ColmapModel stale = model_;
  double sign = 1.0;  // metres
  for (auto& [id, image] : stale.images) image.camera_from_world.translation.x() += (sign = -sign);
  EXPECT_THAT(refusal(stale), HasSubstr("has inconsistent image poses and points: the median reprojection error is"));
  ColmapModel rough = model_;
  for (auto& [id, image] : rough.images) {
    for (ColmapKeypoint& keypoint : image.keypoints) keypoint.pixel.x() += 3.0;
  }
  EXPECT_EQ(refusal(rough), "");
}

TEST_F(ImportedMap, ObservesItsPointsAtTheirProjections) {
  for (const ImportedImage& image : import(model_).images) {
    EXPECT_GT(image.points_attached, 20) << image.name;
    EXPECT_GE(image.features, image.points_attached);
    EXPECT_LT(image.median_error, 1.0) << image.name;
  }
}

TEST_F(ImportedMap, HasNoMetricScaleByDefault) {
  EXPECT_EQ(import(model_).stored.scale, MapScale::unknown);
  ColmapImportOptions halved;
  halved.metres_per_unit = 0.5;
  const ColmapImport imported = import(model_, halved);
  EXPECT_EQ(imported.stored.scale, MapScale::metric);
  const KeyframeId last{Origin::offline, 7};
  EXPECT_THAT(inverse(imported.stored.map.camera_from_world(last)).translation,
              PointNear(0.5 * inverse(exported_.map.camera_from_world(last)).translation, 1e-9));
  const Eigen::Vector3d& position = imported.stored.map.find_point({Origin::offline, 0})->position_in_world;
  EXPECT_THAT(position, PointNear(0.5 * model_.points.at(imported.colmap_ids.front()).position_in_world, 1e-9));
}

TEST_F(ImportedMap, UsesTheCameraAsBodyByDefault) {
  const auto body_from_camera = [](const ColmapImport& imported) {
    return imported.stored.map.rigs().front().body_from_camera;
  };
  EXPECT_THAT(body_from_camera(import(model_)), PoseNear(Pose{}, 1e-12, 1e-12));
  ColmapImportOptions options;
  options.body_from_camera = exported_.recordings.front().calibration.body_from_left;
  EXPECT_THAT(body_from_camera(import(model_, options)), PoseNear(options.body_from_camera, 1e-12, 1e-12));
}

TEST_F(ImportedMap, SkipsUnusableImages) {
  model_.images.at(2).name = "missing.png";
  model_.cameras[2] = model_.cameras.at(1);
  model_.cameras[2].width += 1;
  model_.images.at(3).camera_id = 2;
  const ColmapImport imported = import(model_);
  EXPECT_EQ(imported.stored.map.keyframe_count(), 6);
  EXPECT_THAT(imported.warnings, SizeIs(2));
  EXPECT_THAT(find_faults(imported.stored), IsEmpty());
}

TEST_F(ImportedMap, NeedsAnImage) {
  for (auto& [id, image] : model_.images) image.name = "missing.png";
  EXPECT_THROW(import(model_), InputError);
}

TEST_F(ImportedMap, NeedsAModelWithImagesAndPoints) {
  const auto error_of = [](const ColmapModel& model) -> std::string {
    try {
      import(model);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of({}), HasSubstr("model: is a model without images, so it cannot be imported"));
  model_.points.clear();
  EXPECT_THAT(error_of(model_), HasSubstr("model: is a model without points, so it cannot be imported"));
}

TEST_F(ImportedMap, ReportsAnUnknownCamera) {
  model_.cameras.at(1) = {"EQUIRECTANGULAR", 188, 120, {100, 100, 94, 60}};
  try {
    import(model_);
    FAIL() << "imported";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("model: camera 1: has an unknown model"));
  }
}

TEST(TimesOfNames, AreParsedFromNames) {
  EXPECT_THAT(times_of_names({"1403715273262142976.png", "a/1403715280562142976.jpg"}),
              ElementsAre(Timestamp(1403715273262142976), Timestamp(1403715280562142976)));
}

TEST(TimesOfNames, AreCountedIfANameHasNoTime) {
  EXPECT_THAT(times_of_names({"c.png", "1403715273262142976.png", "b.png"}),
              ElementsAre(seconds(2), seconds(0), seconds(1)));
  EXPECT_THAT(times_of_names({"b/7.png", "a/7.png"}), ElementsAre(seconds(1), seconds(0)));
  EXPECT_THAT(times_of_names({}), IsEmpty());
}

}  // namespace
}  // namespace byre
