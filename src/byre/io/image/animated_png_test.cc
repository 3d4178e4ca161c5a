#include "byre/io/image/animated_png.h"

#include "byre/io/image/grey_png.h"

#include <random>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <libdeflate.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::Lt;
using Bytes = std::vector<std::uint8_t>;

constexpr int kWidth = 40, kHeight = 24;

// A square that moves over stripes.
std::vector<cv::Mat> moving_square(int frames) {
  std::vector<cv::Mat> made;
  for (int i = 0; i < frames; ++i) {
    cv::Mat frame(kHeight, kWidth, CV_8UC3, cv::Scalar(255, 255, 255));
    for (int y = 0; y < kHeight; y += 4) frame.row(y).setTo(cv::Scalar(40, 80, 200));
    frame(cv::Rect(2 + 5 * i, 3, 6, 6)).setTo(cv::Scalar(20, 160, 30));
    made.push_back(frame);
  }
  return made;
}

std::uint32_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size = 4) {
  std::uint32_t number = 0;
  for (const std::uint8_t byte : bytes.subspan(at, size)) number = number << 8 | byte;
  return number;
}

struct ShownFrame {
  cv::Mat bgr;
  std::uint32_t duration_ms = 0;
};

Bytes inflated(std::span<const std::uint8_t> packed, std::size_t size) {
  Bytes bytes(size);
  libdeflate_decompressor* const inflater = libdeflate_alloc_decompressor();
  EXPECT_EQ(libdeflate_zlib_decompress(inflater, packed.data(), packed.size(), bytes.data(), size, nullptr),
            LIBDEFLATE_SUCCESS);
  libdeflate_free_decompressor(inflater);
  return bytes;
}

// A viewer: decodes the frames and lays each over the one before.
std::vector<ShownFrame> shown_frames(const Bytes& png) {
  const auto chunks = png_chunks(png);
  if (!chunks) return {};
  std::vector<ShownFrame> frames;
  std::span<const std::uint8_t> palette;
  cv::Mat canvas(kHeight, kWidth, CV_8UC3, cv::Scalar::all(0));
  cv::Rect part;
  std::uint32_t sequence = 0;
  for (const PngChunk& chunk : *chunks) {
    const auto data = chunk.data();
    if (chunk.type() == "PLTE") palette = data;
    if (chunk.type() == "fcTL") {
      EXPECT_EQ(number_at(data, 0), sequence++);
      part = cv::Rect(static_cast<int>(number_at(data, 12)), static_cast<int>(number_at(data, 16)),
                      static_cast<int>(number_at(data, 4)), static_cast<int>(number_at(data, 8)));
      EXPECT_EQ(part & cv::Rect({}, canvas.size()), part);
      frames.push_back({{}, 1000 * number_at(data, 20, 2) / number_at(data, 22, 2)});
    }
    const bool is_later = chunk.type() == "fdAT";
    if (!is_later && chunk.type() != "IDAT") continue;
    if (is_later) {
      EXPECT_EQ(number_at(data, 0), sequence++);
    }
    const auto row = static_cast<std::size_t>(part.width) + 1;
    const Bytes rows = inflated(data.subspan(is_later ? 4 : 0), row * static_cast<std::size_t>(part.height));
    for (int y = 0; y < part.height; ++y) {
      for (int x = 0; x < part.width; ++x) {
        const std::size_t index = rows[static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x) + 1];
        if (index == 0) continue;  // transparent
        canvas.at<cv::Vec3b>(part.y + y, part.x + x) = {palette[3 * index + 2], palette[3 * index + 1],
                                                        palette[3 * index]};
      }
    }
    frames.back().bgr = canvas.clone();
  }
  return frames;
}

double difference(const cv::Mat& one, const cv::Mat& other) {
  return cv::norm(one, other, cv::NORM_INF);
}

TEST(AnimatedPng, ShowsFramesOfFewColoursExactly) {
  const std::vector<cv::Mat> frames = moving_square(4);
  const std::vector<ShownFrame> shown =
      shown_frames(encode_animated_png(frames, {.frame_ms = 80, .last_frame_ms = 900}));
  ASSERT_EQ(shown.size(), frames.size());
  std::vector<std::uint32_t> durations;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(difference(shown[i].bgr, frames[i]), 0.0) << "frame " << i;
    durations.push_back(shown[i].duration_ms);
  }
  EXPECT_THAT(durations, ElementsAre(80, 80, 80, 900));
}

TEST(AnimatedPng, IsAPngOfItsFirstFrameForOtherReaders) {
  const std::vector<cv::Mat> frames = moving_square(3);
  const cv::Mat read = cv::imdecode(encode_animated_png(frames, {}), cv::IMREAD_COLOR);
  ASSERT_EQ(read.size(), frames.front().size());
  EXPECT_EQ(difference(read, frames.front()), 0.0);
}

TEST(AnimatedPng, ApproximatesManyColours) {
  constexpr double kTolerance = 48.0;  // grey values
  cv::Mat noise(kHeight, kWidth, CV_8UC3);
  std::mt19937 random(3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto grey = static_cast<std::uint8_t>(6 * x + random() % 8);
      noise.at<cv::Vec3b>(y, x) = {grey, static_cast<std::uint8_t>(10 * y), grey};
    }
  }
  const std::vector<ShownFrame> shown = shown_frames(encode_animated_png({noise}, {}));
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_LT(difference(shown[0].bgr, noise), kTolerance);
}

TEST(AnimatedPng, StoresLittleForEqualFrames) {
  const Bytes png = encode_animated_png(std::vector<cv::Mat>(20, moving_square(1).front()), {});
  std::vector<std::size_t> sizes;
  const auto chunks = png_chunks(png);
  ASSERT_TRUE(chunks);
  for (const PngChunk& chunk : *chunks) {
    if (chunk.type() == "fdAT") sizes.push_back(chunk.data().size());
  }
  EXPECT_EQ(sizes.size(), 19U);
  EXPECT_THAT(sizes, Each(Lt(20U)));
}

}  // namespace
}  // namespace byre
