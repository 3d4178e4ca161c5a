// SLAM on features from another source instead of images: here simulated landmarks on the walls of a room, each with
// 256 random bits as descriptor, observed by a stereo camera on a lap through the room.
//
//   04_own_features

#include "byre/byre.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace {

struct Landmark {
  Eigen::Vector3d in_world;  // metres
  byre::Descriptor descriptor{};
};

std::vector<Landmark> landmarks_on_walls(int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  std::vector<Landmark> landmarks(static_cast<std::size_t>(count));
  for (Landmark& landmark : landmarks) {
    const double along = 6.0 * share(random), across = share(random) < 0.0 ? -6.0 : 6.0, height = 2.0 * share(random);
    landmark.in_world =
        share(random) < 0.0 ? Eigen::Vector3d(along, across, height) : Eigen::Vector3d(across, along, height);
    for (std::uint64_t& bits : landmark.descriptor) bits = random();
  }
  return landmarks;
}

// A pair of parallel cameras 12 cm apart.
byre::Calibration stereo_camera() {
  byre::Calibration calibration;
  calibration.left = {byre::CameraModel::pinhole, 640, 480, 400.0, 400.0, 319.5, 239.5, {}};
  byre::Pose right_from_left;
  right_from_left.translation.x() = -0.12;
  calibration.right = byre::StereoPartner{calibration.left, right_from_left};
  return calibration;
}

// On a circle of radius 2 m, looking along it; camera axes are x right, y down, z forward.
byre::Pose world_from_camera(int frame) {
  const double angle = 2.0 * std::numbers::pi * frame / 400.0;
  Eigen::Matrix3d axes;
  axes.col(2) = Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0);
  axes.col(1) = -Eigen::Vector3d::UnitZ();
  axes.col(0) = axes.col(1).cross(axes.col(2));
  return {Eigen::Quaterniond(axes), {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0}};
}

byre::Frame observed(const std::vector<Landmark>& landmarks, const byre::Rig& rig, int frame) {
  const byre::Pose camera_from_world = inverse(world_from_camera(frame));
  std::vector<byre::Keypoint> keypoints;
  std::vector<byre::Descriptor> descriptors;
  for (const Landmark& landmark : landmarks) {
    const Eigen::Vector3d in_camera = camera_from_world * landmark.in_world;
    if (in_camera.z() < 0.3) continue;
    const byre::StereoPixel pixel = rig.project(in_camera);
    if (!rig.contains(pixel.head<2>(), 1.0)) continue;
    byre::Keypoint keypoint;
    keypoint.pixel = pixel.head<2>().cast<float>();
    keypoint.disparity = static_cast<float>(pixel.z());
    keypoint.disparity_sigma = 0.3f;
    keypoints.push_back(keypoint);
    descriptors.push_back(landmark.descriptor);
  }
  byre::Frame result;
  result.time = std::chrono::milliseconds(50) * frame;
  result.features = std::make_shared<const byre::Features>(rig.width, rig.height, std::move(keypoints),
                                                           std::move(descriptors), std::vector<byre::Patch>{});
  return result;
}

}  // namespace

int main() {
  byre::SlamOptions options;
  options.workers = byre::Workers::repeatable;
  byre::Slam slam = byre::Slam::mapping(stereo_camera(), options);
  const std::vector<Landmark> landmarks = landmarks_on_walls(3000);
  double worst = 0.0;
  int poses = 0;
  for (int i = 0; i < 400; ++i) {
    const byre::FrameReport report = slam.process(observed(landmarks, slam.rig(), i));
    if (!report.map_from_body) continue;
    // The map's origin is the robot's first pose.
    const byre::Pose truth = inverse(world_from_camera(0)) * world_from_camera(i);
    worst = std::max(worst, (report.map_from_body->translation - truth.translation).norm());
    ++poses;
  }
  slam.finish();
  std::printf("%d of %d frames have a pose; the worst is off by %.1f mm\n", poses, slam.frames(), 1e3 * worst);
  return 0;
}
