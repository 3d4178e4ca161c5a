// Maps a simulated wall of random bricks, along which a stereo camera moves sideways, and prints the result with all
// digits.

#include "byre/slam.h"

#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

constexpr int kWidth = 640;                // pixels
constexpr int kHeight = 480;               // pixels
constexpr double kFocal = 400.0;           // pixels
constexpr double kBaseline = 0.1;          // metres
constexpr double kNear = 2.0, kFar = 4.0;  // metres; the upper half of the wall is nearer

byre::Calibration calibration() {
  byre::Calibration calibration;
  calibration.left = {byre::CameraModel::pinhole, kWidth, kHeight, kFocal, kFocal, 319.5, 239.5, {}};
  calibration.right = byre::StereoPartner{calibration.left, {}};
  calibration.right->right_from_left.translation.x() = -kBaseline;
  return calibration;
}

std::uint8_t grey_of_brick(int column, int row) {
  std::uint32_t mixed =
      static_cast<std::uint32_t>(column) * 2654435761U ^ static_cast<std::uint32_t>(row) * 2246822519U;
  mixed ^= mixed >> 15U;
  mixed *= 2654435761U;
  return static_cast<std::uint8_t>(40 + (mixed >> 24U) * 3 / 4);
}

std::vector<std::uint8_t> draw(double camera_x) {  // metres along the wall
  constexpr int kBrick = 12, kFarAway = 100'000;   // pixels
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < kHeight; ++v) {
    const double depth = v < kHeight / 2 ? kNear : kFar;
    const int shift = static_cast<int>(kFocal * camera_x / depth) + kFarAway;
    for (int u = 0; u < kWidth; ++u) pixels.push_back(grey_of_brick((u + shift) / kBrick, v / kBrick));
  }
  return pixels;
}

byre::FrameReport process_frame(byre::Slam& slam, int frame) {
  const double x = 0.02 * frame;  // metres
  const std::vector<std::uint8_t> left = draw(x), right = draw(x + kBaseline);
  const byre::Timestamp time = std::chrono::milliseconds(50) * (frame + 1);
  byre::CameraImages images;
  images.left = {left.data(), kWidth, kHeight, 0, byre::PixelFormat::grey8, 16, time};
  images.right = {right.data(), kWidth, kHeight, 0, byre::PixelFormat::grey8, 16, time};
  return slam.process(images);
}

void print_report(const byre::FrameReport& report) {
  std::printf("%s, %s", std::string(to_string(report.state)).c_str(), std::string(to_string(report.input)).c_str());
  if (report.map_from_body) {
    const Eigen::Vector3d& place = report.map_from_body->translation;
    std::printf(", %.17g %.17g %.17g", place.x(), place.y(), place.z());
  }
  std::printf("\n");
}

}  // namespace

int main() {
  byre::SlamOptions options;
  options.workers = byre::Workers::repeatable;
  byre::Slam slam = byre::Slam::mapping(calibration(), options);
  print_report(slam.process(byre::CameraImages{}));
  for (int frame = 0; frame < 20; ++frame) print_report(process_frame(slam, frame));
  slam.finish();
  std::printf("%d keyframes, %d points\n", slam.keyframes(), slam.points());
  try {
    byre::Slam::on_map(calibration(), "no-such.byre");
  } catch (const byre::InputError& error) {
    std::printf("%s\n", error.place().c_str());
  }
  return 0;
}
