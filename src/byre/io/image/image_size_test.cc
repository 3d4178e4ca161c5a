#include "byre/io/image/image_size.h"

#include "byre/io/image/image_file.h"
#include "byre/io/recording/folder_scene.h"

#include <algorithm>
#include <iterator>
#include <vector>

namespace byre {
namespace {

class StatedSize : public TestFolder {
 protected:
  std::vector<std::uint8_t> bytes_of(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(StatedSize, MatchesTheImageInEveryFormat) {
  for (const char* const name : {"a.png", "a.jpg", "a.bmp", "a.tif", "a.pgm"}) {
    write_image(name, 37, 21, 100);
    const std::optional<ImageSize> size = stated_size(folder_ / name);
    ASSERT_TRUE(size) << name;
    EXPECT_EQ(size->width, 37u) << name;
    EXPECT_EQ(size->height, 21u) << name;
  }
}

TEST_F(StatedSize, IsEmptyForOtherFiles) {
  write("text.txt", "Perhaps");
  write("nothing.png", "");
  EXPECT_FALSE(stated_size(folder_ / "text.txt"));
  EXPECT_FALSE(stated_size(folder_ / "nothing.png"));
  EXPECT_FALSE(stated_size(folder_ / "absent.png"));
}

TEST_F(StatedSize, IsReadSafelyFromAnyPrefix) {
  for (const char* const name : {"a.png", "a.jpg", "a.bmp", "a.tif", "a.pgm"}) {
    write_image(name, 37, 21, 100);
    const std::vector<std::uint8_t> bytes = bytes_of(name);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      stated_size(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)));
    }
  }
}

TEST_F(StatedSize, PreventsDecodingOversizedImages) {
  write("huge.pgm", "P5\n30000 30000\n255\n");
  write("wide.pgm", "P5\n# a comment of 7 words with 2 numbers\n4294967295 2\n255\n");
  EXPECT_FALSE(read_image(folder_ / "huge.pgm"));
  EXPECT_FALSE(read_image(folder_ / "wide.pgm"));
  EXPECT_GT(stated_size(folder_ / "wide.pgm")->pixels(), kMaxPixels);
}

}  // namespace
}  // namespace byre
