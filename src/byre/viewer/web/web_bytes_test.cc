#include "byre/viewer/web/web_messages.h"

#include <cstring>

#include <gmock/gmock.h>

namespace byre {
namespace {

template <typename Value>
Value value_at(const std::string& bytes, std::size_t offset) {
  Value value{};
  std::memcpy(&value, bytes.data() + offset, sizeof(Value));
  return value;
}

TEST(WebBytes, EncodeAMapInColumns) {
  MapScene scene;
  scene.points = {{{1.0f, 2.0f, 3.0f}, Origin::offline}, {{4.0f, 5.0f, 6.0f}, Origin::online}};
  scene.keyframes = {{{}, {Eigen::Quaterniond::Identity(), {7.0, 8.0, 9.0}}, Origin::online}};
  const std::string bytes = map_bytes(scene);
  ASSERT_EQ(bytes.size(), 8u + 2 * 12 + 28 + 3);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 0), 2u);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 1u);
  EXPECT_EQ(value_at<float>(bytes, 8), 1.0f);
  EXPECT_EQ(value_at<float>(bytes, 8 + 12), 4.0f);
  EXPECT_EQ(value_at<float>(bytes, 8 + 24), 7.0f);
  EXPECT_EQ(value_at<float>(bytes, 8 + 24 + 24), 1.0f);  // w
  EXPECT_EQ(bytes.substr(8 + 24 + 28), std::string("\0\1\1", 3));
}

TEST(WebBytes, EncodeAnImageAfterItsPoints) {
  std::vector<SeenPoint> seen(2);
  seen[0] = {{Origin::offline, 3}, {10.5f, 20.5f}, true};
  seen[1] = {{Origin::online, 4}, {30.0f, 40.0f}, false};
  const std::vector<unsigned char> jpeg = {0xff, 0xd8};
  const std::string bytes = image_bytes(17, seen, jpeg);
  ASSERT_EQ(bytes.size(), 8u + 16 + 2 + 2);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 0), 17u);
  EXPECT_EQ(value_at<std::uint32_t>(bytes, 4), 2u);
  EXPECT_EQ(value_at<float>(bytes, 12), 20.5f);
  EXPECT_EQ(value_at<float>(bytes, 16), 30.0f);
  EXPECT_EQ(bytes.substr(24), "\x02\x01\xff\xd8");
}

}  // namespace
}  // namespace byre
