#include "byre/playback/archive/point_cloud.h"

#include "byre/map/stored_map_scene.h"

#include <cstring>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(PointCloud, ContainsEveryPoint) {
  const StoredMap stored = StoredMapScene(4, 9).stored();
  const std::vector<std::byte> bytes = point_cloud(stored.map);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_THAT(text, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(text, HasSubstr("element vertex 16\n"));
  constexpr std::size_t kVertexBytes = 3 * 4 + 3 + 4;
  const std::size_t begin = text.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size() - begin, 16 * kVertexBytes);
  Eigen::Vector3f first;
  std::memcpy(first.data(), bytes.data() + begin, 3 * sizeof(float));
  EXPECT_EQ(first, stored.map.find_point({Origin::offline, 0})->position_in_world.cast<float>());
  std::int32_t observations = 0;
  std::memcpy(&observations, bytes.data() + begin + 15, sizeof(observations));
  EXPECT_EQ(observations, 3);
}

TEST(PointCloud, ColoursPointsByTheirObservations) {
  const StoredMap stored = StoredMapScene(4, 9).stored();  // point 0 has three observations, point 15 one
  const std::vector<std::byte> bytes = point_cloud(stored.map);
  constexpr std::size_t kVertexBytes = 19;
  const auto blue_of = [&bytes](std::size_t point) {
    return std::to_integer<int>(bytes[bytes.size() - (16 - point) * kVertexBytes + 14]);
  };
  EXPECT_EQ(blue_of(15), 255);
  EXPECT_LT(blue_of(0), 255);
}

}  // namespace
}  // namespace byre
