#include "byre/io/image/grey_png.h"

#include <string>

#include <boost/crc.hpp>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes some_png() {
  Bytes bytes;
  cv::Mat picture(20, 30, CV_8UC1);
  cv::randu(picture, 0, 255);
  cv::imencode(".png", picture, bytes);
  return bytes;
}

void append_number(Bytes& bytes, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
}

Bytes chunk(const std::string& type, const std::string& data) {
  Bytes bytes;
  append_number(bytes, static_cast<std::uint32_t>(data.size()));
  const std::string named = type + data;
  bytes.insert(bytes.end(), named.begin(), named.end());
  boost::crc_32_type checksum;
  checksum.process_bytes(named.data(), named.size());
  append_number(bytes, static_cast<std::uint32_t>(checksum.checksum()));
  return bytes;
}

TEST(PngChunks, AreKeptIfAllContainPixels) {
  const Bytes png = some_png();
  ASSERT_TRUE(is_png(png));
  EXPECT_EQ(png_of_pixels(*png_chunks(png)), png);
}

TEST(PngChunks, AreRemovedIfAncillary) {
  const Bytes png = some_png();
  constexpr std::ptrdiff_t kAfterHeader = 8 + 25;
  Bytes with_profile = png;
  const Bytes profile = chunk("iCCP", "a profile that does not suit");
  with_profile.insert(with_profile.begin() + kAfterHeader, profile.begin(), profile.end());
  EXPECT_EQ(png_of_pixels(*png_chunks(with_profile)), png);
}

TEST(PngChunks, AreEmptyInATruncatedFile) {
  const Bytes png = some_png();
  for (std::size_t size = 8; size < png.size(); ++size) {
    EXPECT_FALSE(png_chunks(std::span(png).first(size))) << size;
  }
}

TEST(PngChunks, RevealDamageOfAnyByte) {
  const Bytes png = some_png();
  for (std::size_t i = 8; i < png.size(); ++i) {
    Bytes damaged = png;
    damaged[i] ^= 0x10;
    EXPECT_FALSE(png_chunks(damaged)) << i;
  }
}

TEST(PngChunks, EndWithTheLastChunk) {
  Bytes followed = some_png();
  const Bytes png = followed;
  followed.insert(followed.end(), {1, 2, 3});
  EXPECT_EQ(png_of_pixels(*png_chunks(followed)), png);
}

TEST(PngChunks, AreIteratedInOrder) {
  const Bytes png = some_png();
  const auto chunks = png_chunks(png);
  ASSERT_TRUE(chunks);
  ASSERT_GE(chunks->size(), 3u);
  EXPECT_EQ(chunks->front().type(), "IHDR");
  EXPECT_EQ(chunks->front().data().size(), 13u);
  EXPECT_EQ(chunks->back().type(), "IEND");
}

TEST(PngChunks, AreFoundInPngFilesOnly) {
  EXPECT_FALSE(is_png({}));
  EXPECT_FALSE(is_png(Bytes{0xFF, 0xD8, 0, 0, 0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace byre
