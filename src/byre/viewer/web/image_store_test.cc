#include "byre/viewer/web/web_run.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

std::string image_of(std::size_t frame) {
  std::string bytes(100, ' ');
  bytes.replace(0, std::to_string(frame).size(), std::to_string(frame));
  return bytes;
}

TEST(ImageStore, FindsTheNearestImage) {
  ImageStore store(1000);
  EXPECT_EQ(store.find_nearest(3), nullptr);
  store.add(10, image_of(10));
  store.add(20, image_of(20));
  EXPECT_EQ(*store.find_nearest(0), image_of(10));
  EXPECT_EQ(*store.find_nearest(14), image_of(10));
  EXPECT_EQ(*store.find_nearest(16), image_of(20));
  EXPECT_EQ(*store.find_nearest(20), image_of(20));
  EXPECT_EQ(*store.find_nearest(99), image_of(20));
}

TEST(ImageStore, ThinsOutOlderImages) {
  ImageStore store(1000);
  for (std::size_t frame = 0; frame < 1000; ++frame) {
    store.add(frame, image_of(frame));
    ASSERT_LE(store.bytes(), 1000u);
    ASSERT_EQ(*store.find_nearest(frame), image_of(frame));
  }
  EXPECT_GE(store.count(), 5u);
  EXPECT_EQ(store.bytes(), 100 * store.count());
  EXPECT_EQ(*store.find_nearest(0), image_of(0));
}

TEST(ImageStore, ReplacesAnImageOfTheSameFrame) {
  ImageStore store(1000);
  store.add(1, image_of(1));
  store.add(1, image_of(2));
  EXPECT_EQ(store.bytes(), 100u);
  EXPECT_EQ(*store.find_nearest(1), image_of(2));
}

}  // namespace
}  // namespace byre
