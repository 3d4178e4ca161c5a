#include "degradation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr double kPi = std::numbers::pi;

// A header over the image's own pixels; read-only use.
cv::Mat as_matrix(const Image& image) {
  return {image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())};
}

// Rounded and clipped to 8 bits.
Image to_image(const cv::Mat& grey) {
  cv::Mat bytes;
  grey.convertTo(bytes, CV_8U);
  return {bytes.cols, bytes.rows, std::vector<std::uint8_t>(bytes.datastart, bytes.dataend)};
}

Image scaled(const Image& image, double scale, double offset) {
  cv::Mat result;
  as_matrix(image).convertTo(result, CV_32F, scale, offset);
  return to_image(result);
}

cv::Mat white_noise(cv::Size size, double sigma, std::uint64_t seed) {
  cv::Mat noise(size, CV_32F);
  cv::RNG random(seed * 0x9E3779B97F4A7C15u + 1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  return noise;
}

// Gaussian noise of this standard deviation, without detail below this number of pixels.
cv::Mat smooth_noise(cv::Size size, double sigma, double pixels, std::uint64_t seed) {
  cv::Mat noise;
  cv::GaussianBlur(white_noise(size, 1.0, seed), noise, {}, pixels);
  const double left = 1.0 / (2.0 * std::sqrt(kPi) * pixels);  // deviation left by the blur of unit noise
  return noise * (sigma / left);
}

// 0 for values below -width / 2, 1 above width / 2, smooth between.
double soft_step(double value, double width) {
  const double t = std::clamp(value / width + 0.5, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

float quantile_of(const cv::Mat1f& values, double share) {
  std::vector<float> sorted(values.begin(), values.end());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

// A hand, drawn on a canvas of twice the image's height and 1.25 times its width, so that it can enter from below.
class Hand {
 public:
  Hand(cv::Size image, double coverage)
      : image_(image), at_rest_(image.width / 8, image.height, image.width, image.height) {
    const cv::Size size(image.width * 5 / 4, 2 * image.height);
    const cv::Mat1f distance = distance_from_middle(size);
    const double outline = quantile_of(distance(at_rest_).clone(), coverage);
    const cv::Mat1f skin = smooth_noise(size, 9.0, 60.0, 8) + smooth_noise(size, 3.0, 4.0, 9);
    grey_.create(size);
    opacity_.create(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const double depth = 1.0 - distance(y, x) / outline;  // 0 on the outline, 1 in the middle
        opacity_(y, x) = static_cast<float>(soft_step(depth, 0.14));
        grey_(y, x) = static_cast<float>(62.0 + 55.0 * std::exp(-4.0 * std::max(depth, 0.0))) + skin(y, x);
      }
    }
  }

  // The image with the hand shifted right and down from its position of rest, pixels.
  Image before(const Image& image, int right, int down) const {
    const cv::Rect seen = at_rest_ - cv::Point(right, down);
    cv::Mat scene;
    as_matrix(image).convertTo(scene, CV_32F);
    const cv::Mat1f opacity = opacity_(seen);
    return to_image(scene.mul(1.0 - opacity) + grey_(seen).mul(opacity));
  }

 private:
  // Distance from the middle, 1 on an outline with five bulges, the knuckles.
  cv::Mat1f distance_from_middle(cv::Size size) const {
    const double centre_x = at_rest_.x + 0.42 * image_.width, centre_y = at_rest_.y + 0.62 * image_.height;
    cv::Mat1f distance(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const double dx = (x - centre_x) / image_.width, dy = 1.2 * (y - centre_y) / image_.height;
        const double angle = std::atan2(dy, dx);
        const double outline = 1.0 + 0.12 * std::cos(2.0 * angle + 0.4) + 0.07 * std::cos(5.0 * angle + 2.0);
        distance(y, x) = static_cast<float>(std::hypot(dx, dy) / outline);
      }
    }
    return distance;
  }

  cv::Size image_;
  cv::Rect at_rest_;  // part of the canvas that the left image shows when the hand rests
  cv::Mat1f grey_;
  cv::Mat1f opacity_;
};

template <typename Change>
ImageFrame transform_images(const ImageFrame& images, Change change) {
  ImageFrame changed{images.time, change(images.left, 0), std::nullopt};
  if (images.right) changed.right = change(*images.right, 1);
  return changed;
}

std::uint64_t seed_of(int step, int camera) {
  return 2 * static_cast<std::uint64_t>(step) + static_cast<std::uint64_t>(camera);
}

}  // namespace

Image without_light(const Image& image, std::uint64_t seed) {
  return to_image(white_noise({image.width, image.height}, 0.8, seed) + 1.0);
}

Image motion_blurred(const Image& image, double pixels, double angle) {
  const int half = static_cast<int>(std::ceil(pixels / 2.0));
  cv::Mat1f path(2 * half + 1, 2 * half + 1, 0.0f);
  constexpr int kMoments = 200;  // samples of the motion path
  for (int i = 0; i < kMoments; ++i) {
    const double along = ((i + 0.5) / kMoments - 0.5) * pixels;
    const double x = half + along * std::cos(angle), y = half + along * std::sin(angle);
    path(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x))) += 1.0f / kMoments;
  }
  cv::Mat blurred;
  cv::filter2D(as_matrix(image), blurred, CV_32F, path, {-1, -1}, 0.0, cv::BORDER_REFLECT_101);
  return to_image(blurred);
}

Image exposed(const Image& image, double times) {
  return scaled(image, times, 0.0);
}

Image hazed(const Image& image, double transmission) {
  constexpr double kHazeGrey = 200.0;
  return scaled(image, transmission, (1.0 - transmission) * kHazeGrey);
}

Image flattened(const Image& image, double share) {
  return scaled(image, share, (1.0 - share) * cv::mean(as_matrix(image))[0]);
}

Image dirtied(const Image& image, int spots, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  cv::Mat1f covered(image.height, image.width, 0.0f);
  for (int i = 0; i < spots; ++i) {
    const cv::Point centre(static_cast<int>(any(random) * image.width), static_cast<int>(any(random) * image.height));
    const cv::Size axes(static_cast<int>(8 + 28 * any(random)), static_cast<int>(8 + 28 * any(random)));
    const double angle = 180.0 * any(random), opacity = 0.4 + 0.5 * any(random);
    cv::ellipse(covered, centre, axes, angle, 0.0, 360.0, opacity, cv::FILLED);
  }
  cv::GaussianBlur(covered, covered, {}, 7.0);
  cv::Mat clean;
  as_matrix(image).convertTo(clean, CV_32F);
  constexpr double kDirtGrey = 70.0;
  return to_image(clean.mul(1.0 - covered) + kDirtGrey * covered);
}

Image blank_wall(const Image& image, std::uint64_t seed) {
  cv::Mat1f wall(image.height, image.width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double right = static_cast<double>(x) / image.width - 0.5,
                   down = static_cast<double>(y) / image.height - 0.5;
      wall(y, x) = static_cast<float>(205.0 + 14.0 * right - 10.0 * down - 45.0 * (right * right + down * down));
    }
  }
  return to_image(wall + white_noise(wall.size(), 1.5, seed));
}

Degradation black_frames() {
  return [](const ImageFrame& images, int step) {
    return transform_images(
        images, [&](const Image& image, int camera) { return without_light(image, seed_of(step, camera)); });
  };
}

Degradation hand_over_the_lens(double coverage) {
  const auto drawn = std::make_shared<std::optional<Hand>>();  // drawn once the image size is given
  return [coverage, drawn](const ImageFrame& images, int step) {
    constexpr int kComing = 5;  // steps until it rests
    if (!*drawn) drawn->emplace(cv::Size(images.left.width, images.left.height), coverage);
    const int to_go = std::max(0, kComing - 1 - step);
    const int down = images.left.height * to_go / (kComing + 1);
    return transform_images(images, [&](const Image& image, int camera) {
      return (*drawn)->before(image, camera == 0 ? 0 : -image.width / 16, down);
    });
  };
}

Degradation motion_blur(double pixels) {
  return [pixels](const ImageFrame& images, int step) {
    const double angle = 0.7 + 2.4 * step;  // radians; differs in every step
    return transform_images(images, [&](const Image& image, int) { return motion_blurred(image, pixels, angle); });
  };
}

Degradation exposure_jumps(double factor, int steps_per_level) {
  return [factor, steps_per_level](const ImageFrame& images, int step) {
    const std::array<double, 4> levels = {factor, 1.0, 1.0 / factor, 1.0};
    const double level = levels[static_cast<std::size_t>(step / steps_per_level) % levels.size()];
    return transform_images(images, [&](const Image& image, int) { return exposed(image, level); });
  };
}

Degradation blank_close_up() {
  return [](const ImageFrame& images, int step) {
    return transform_images(images,
                            [&](const Image& image, int camera) { return blank_wall(image, seed_of(step, camera)); });
  };
}

Degradation haze(double transmission) {
  return [transmission](const ImageFrame& images, int) {
    return transform_images(images, [&](const Image& image, int) { return hazed(image, transmission); });
  };
}

Degradation dirt(int spots) {
  return [spots](const ImageFrame& images, int) {
    return transform_images(images,
                            [&](const Image& image, int camera) { return dirtied(image, spots, seed_of(3, camera)); });
  };
}

namespace {

// cv::flip of an image; code: its axis.
Image flipped(const Image& image, int code) {
  cv::Mat result;
  cv::flip(as_matrix(image), result, code);
  return to_image(result);
}

Image with_noise(const Image& image, double sigma, std::uint64_t seed) {
  cv::Mat grey;
  as_matrix(image).convertTo(grey, CV_32F);
  return to_image(grey + white_noise(grey.size(), sigma, seed));
}

// Delays images by a number of steps; returns the first image until then. Step 0 restarts.
class Delay {
 public:
  explicit Delay(int steps) : steps_(steps) {}

  Image pass(const Image& image, int step) {
    if (step == 0) waiting_.clear();
    waiting_.push_back(image);
    if (std::cmp_greater(waiting_.size(), steps_ + 1)) waiting_.pop_front();
    return waiting_.front();
  }

 private:
  int steps_;
  std::deque<Image> waiting_;
};

template <typename Change>
ImageFrame change_right(const ImageFrame& images, Change change) {
  ImageFrame changed = images;
  if (images.right) changed.right = change(*images.right);
  return changed;
}

}  // namespace

Degradation frozen(double sigma) {
  const auto shown = std::make_shared<std::optional<ImageFrame>>();
  return [shown, sigma](const ImageFrame& images, int step) {
    if (step == 0) *shown = images;
    const ImageFrame repeated{images.time, (*shown)->left, (*shown)->right};
    if (sigma == 0.0) return repeated;
    return transform_images(
        repeated, [&](const Image& image, int camera) { return with_noise(image, sigma, seed_of(step, camera)); });
  };
}

Degradation right_exposed(double times) {
  return [times](const ImageFrame& images, int step) {
    return change_right(images, [&](const Image& right) {
      return times > 0.0 ? exposed(right, times) : without_light(right, seed_of(step, 1));
    });
  };
}

Degradation right_noisy(double sigma) {
  return [sigma](const ImageFrame& images, int step) {
    return change_right(images, [&](const Image& right) { return with_noise(right, sigma, seed_of(step, 1)); });
  };
}

Degradation right_late(int steps) {
  const auto delay = std::make_shared<Delay>(steps);
  return [delay](const ImageFrame& images, int step) {
    return change_right(images, [&](const Image& right) { return delay->pass(right, step); });
  };
}

Degradation left_late(int steps) {
  const auto delay = std::make_shared<Delay>(steps);
  return [delay](const ImageFrame& images, int step) {
    ImageFrame changed = images;
    changed.left = delay->pass(images.left, step);
    return changed;
  };
}

Degradation swapped() {
  return [](const ImageFrame& images, int) {
    ImageFrame changed = images;
    if (images.right) std::swap(changed.left, *changed.right);
    return changed;
  };
}

Degradation mirrored() {
  return [](const ImageFrame& images, int) {
    return transform_images(images, [](const Image& image, int) { return flipped(image, 1); });
  };
}

Degradation upside_down() {
  return [](const ImageFrame& images, int) {
    return transform_images(images, [](const Image& image, int) { return flipped(image, 0); });
  };
}

Degradation contrast_loss(double share) {
  return [share](const ImageFrame& images, int) {
    return transform_images(images, [&](const Image& image, int) { return flattened(image, share); });
  };
}

}  // namespace byre
