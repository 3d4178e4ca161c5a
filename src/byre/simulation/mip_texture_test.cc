#include "byre/simulation/mip_texture.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector2f;
using ::testing::FloatNear;

constexpr int kTextureSize = 64;
constexpr float kTexel = 1.0f / kTextureSize;
constexpr float kStep = 1.0f / 255.0f;  // step between stored values

// Alternating columns of 0 and 1, each width texels wide.
MipTexture columns(int width) {
  std::vector<float> texels;
  for (int i = 0; i < kTextureSize * kTextureSize; ++i)
    texels.push_back(i % kTextureSize / width % 2 == 0 ? 0.0f : 1.0f);
  return {kTextureSize, texels};
}

TEST(MipTexture, ReturnsItsTexelsAtTheirCentres) {
  const MipTexture texture = columns(1);
  for (int i = 0; i < 4; ++i) {
    const Vector2f centre((static_cast<float>(i) + 0.5f) * kTexel, 0.5f * kTexel);
    EXPECT_THAT(texture.sample(centre, 0.5f * kTexel), FloatNear(i % 2 == 0 ? 0.0f : 1.0f, kStep));
  }
}

TEST(MipTexture, InterpolatesBetweenTexels) {
  EXPECT_THAT(columns(1).sample({kTexel, 0.3f}, 0.5f * kTexel), FloatNear(0.5f, kStep));
}

TEST(MipTexture, RepeatsInBothDirections) {
  const MipTexture texture = columns(8);
  for (const float x : {0.05f, 0.21f, 0.63f}) {
    EXPECT_THAT(texture.sample({x, 0.4f}, kTexel), FloatNear(texture.sample({x - 3.0f, 5.4f}, kTexel), 1e-4f));
  }
}

TEST(MipTexture, AveragesWideFootprints) {
  const MipTexture texture = columns(1);
  for (const float x : {0.01f, 0.33f, 0.77f}) {
    EXPECT_THAT(texture.sample({x, 0.5f}, 8.0f * kTexel), FloatNear(0.5f, 2.0f * kStep));
  }
}

TEST(MipTexture, KeepsDetailInNarrowFootprints) {
  const MipTexture texture = columns(4);
  const TextureFootprint along_columns{{kTexel, 0.0f}, {0.0f, 4.0f * kTexel}};
  EXPECT_THAT(texture.sample({2.0f * kTexel, 0.5f}, along_columns), FloatNear(0.0f, 0.05f));
  const TextureFootprint across_columns{{0.0f, kTexel}, {16.0f * kTexel, 0.0f}};
  EXPECT_THAT(texture.sample({2.0f * kTexel, 0.5f}, across_columns), FloatNear(0.5f, 0.1f));
}

}  // namespace
}  // namespace byre
