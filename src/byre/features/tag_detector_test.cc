#include "byre/features/tag_detector.h"

#include "byre/features/tag_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::vector<TagSighting> detect(const Image& image, TagFamily family) {
  return TagDetector(std::span(&family, 1)).detect(view_of(image));
}

TEST(TagDetector, FindsTheCornersOfEachFamilyToAFractionOfAPixel) {
  const Rig rig = rig_of_tags();
  for (const TagFamily family : {TagFamily::tag36h11, TagFamily::tag25h9, TagFamily::tag_standard41h12}) {
    const Tag tag{{family, 5}, 0.2};
    const Pose camera_from_tag = camera_from_upright_tag({0.3, -0.1, 1.5}, 0.4);
    const auto found = detect(image_of_tag(rig, tag, camera_from_tag), family);
    ASSERT_THAT(found, SizeIs(1)) << to_string(tag.id);
    EXPECT_EQ(found[0].id, tag.id);
    const auto in_tag = tag_corners(tag.size);
    for (std::size_t i = 0; i < in_tag.size(); ++i) {
      const Eigen::Vector2d expected = rig.project(camera_from_tag * in_tag[i]).head<2>();
      EXPECT_LT((found[0].corners[i] - expected).norm(), 0.35) << to_string(tag.id) << " corner " << i;
    }
  }
}

TEST(TagDetector, MeasuresTheRangeOfATagAtThreeMetresWithinThreeCentimetres) {
  const Rig rig = rig_of_tags();
  const Tag tag{{TagFamily::tag36h11, 7}, 0.24};
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Pose camera_from_tag = camera_from_upright_tag({0.2 * seed - 0.7, -0.3, 3.0}, 0.15 * seed - 0.5);
    const auto found = detect(image_of_tag(rig, tag, camera_from_tag, seed), tag.id.family);
    ASSERT_THAT(found, SizeIs(1)) << "seed " << seed;
    const TagView view{{}, rig, found[0].corners};
    const auto estimates = estimate_tag_pose(std::span(&view, 1), tag.size);
    ASSERT_FALSE(estimates.empty()) << "seed " << seed;
    EXPECT_LT((estimates[0].world_from_tag.translation - camera_from_tag.translation).norm(), 0.03) << "seed " << seed;
  }
}

TEST(TagDetector, FindsNoTagsOfOtherFamiliesAndNoneInNoise) {
  const Rig rig = rig_of_tags();
  const Tag tag{{TagFamily::tag36h11, 7}, 0.24};
  const Image image = image_of_tag(rig, tag, camera_from_upright_tag({0.0, 0.0, 2.0}, 0.0));
  EXPECT_THAT(detect(image, TagFamily::tag25h9), IsEmpty());
  const Image wall = image_of_tag(rig, tag, camera_from_upright_tag({0.0, 0.0, -2.0}, 0.0));
  EXPECT_THAT(detect(wall, TagFamily::tag36h11), IsEmpty());
}

TEST(TagDetector, LeavesOutATagThatIsSeenTwice) {
  Rig rig = rig_of_tags();
  const Tag tag{{TagFamily::tag36h11, 7}, 0.24};
  Image image = image_of_tag(rig, tag, camera_from_upright_tag({-0.6, 0.0, 2.0}, 0.0));
  const int half = image.width / 2;
  for (int row = 0; row < image.height; ++row) {
    const auto begin = image.pixels.begin() + static_cast<std::ptrdiff_t>(row) * image.width;
    std::copy_n(begin, half, begin + half);
  }
  EXPECT_THAT(detect(image, TagFamily::tag36h11), IsEmpty());
}

}  // namespace
}  // namespace byre
