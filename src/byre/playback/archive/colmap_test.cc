#include "byre/colmap.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/playback/archive/colmap_scene.h"

#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ColmapRoundTrip : public testing::Test {
 protected:
  ~ColmapRoundTrip() override { fs::remove_all(folder_); }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("byre_colmap_test." + std::to_string(getpid()));
  const fs::path images_ = RenderedFixture::shared().folder() / "mav0/cam0/data";
  const Map map_{rendered_map()};
};

TEST_F(ColmapRoundTrip, KeepsPosesAndPoints) {
  export_colmap(map_, folder_ / "model", RenderedFixture::shared().folder());
  const Map again = import_colmap(folder_ / "model", images_, 1.0, false);
  EXPECT_TRUE(again.is_metric());
  ASSERT_EQ(again.keyframes(), map_.keyframes());
  for (int i = 0; i < map_.keyframes(); ++i) {
    const Pose body_from_left = map_.recordings().front().calibration.body_from_left;
    EXPECT_THAT(again.keyframe(i).map_from_body, PoseNear(map_.keyframe(i).map_from_body * body_from_left, 1e-9, 1e-9));
  }
  ASSERT_GT(again.points(), 100);
  for (int i = 0; i < again.points(); ++i) {
    EXPECT_THAT(again.position(i), PointNear(map_.position(map_.nearest_points(again.position(i), 1).front()), 1e-9));
  }
}

TEST_F(ColmapRoundTrip, HasNoScaleUnlessGiven) {
  export_colmap(map_, folder_);
  EXPECT_FALSE(import_colmap(folder_, images_).is_metric());
  EXPECT_GT(import_colmap(folder_, images_).points(), import_colmap(folder_, images_, {}, false).points());
  EXPECT_THROW(import_colmap(folder_, images_, 0.0), InputError);
}

TEST_F(ColmapRoundTrip, NeedsAllImages) {
  export_colmap(map_, folder_);
  fs::create_directories(folder_ / "images");
  fs::copy(images_, folder_ / "images");
  const std::string first = std::to_string(map_.keyframe(0).time.count()) + ".png";
  fs::remove(folder_ / "images" / first);
  try {
    import_colmap(folder_, folder_ / "images");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(first));
  }
}

}  // namespace
}  // namespace byre
