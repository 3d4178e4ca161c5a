#include "connected_site.h"

#include "byre/slam/tracking/mission_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

constexpr double kStep = 1.0 / 3.0;  // metres between poses
constexpr double kBetween = 10.0;    // metres between lanes
constexpr double kAside = 2.5;       // metres from the centre line of a lane to its walls
constexpr double kReach = 10.0;      // metres ahead
constexpr double kPixelSigma = 0.8;
constexpr double kDisparitySigma = 0.4;
constexpr double kOutliers = 0.03;

std::pair<int, int> cell_of(const Eigen::Vector3d& place) {
  return {static_cast<int>(std::floor(place.x() / kReach)), static_cast<int>(std::floor(place.z() / kReach))};
}

}  // namespace

ConnectedSite::ConnectedSite(int poses, int points)
    : lanes_(std::max(1, static_cast<int>(std::lround(std::sqrt(poses * kStep / (2.0 * kBetween)))))) {
  problem_.rigs = {simulated_rig()};
  const double length = poses * kStep / (2.0 * lanes_);
  for (int i = 0; i < poses; ++i) {
    const Pose pose = pose_after(kStep * i, length);
    problem_.poses.push_back({pose, 0, i == 0});
    cells_[cell_of(inverse(pose).translation)].push_back(i);
    truth_.push_back(pose);
  }
  while (static_cast<int>(problem_.points.size()) < points) add_point();
  std::ranges::stable_sort(problem_.observations, {}, &BundleObservation::pose);  // the order of keyframes
  for (BundlePose& pose : problem_.poses) {
    if (!pose.fixed) pose.camera_from_world = exp_pose(random_motion(0.03, 0.01)) * pose.camera_from_world;
  }
  for (BundlePoint& point : problem_.points) point.position_in_world += random_motion(0.05, 0.0).head<3>();
}

double ConnectedSite::position_error(const std::vector<Pose>& camera_from_world) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    sum += (inverse(camera_from_world[i]).translation - inverse(truth_[i]).translation).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth_.size()));
}

// Pose after a driven distance, metres. Lanes of the given length lie in the ground plane, x and z.
Pose ConnectedSite::pose_after(double distance, double length) const {
  const int lane = static_cast<int>(distance / length);
  const bool is_across = lane >= lanes_;
  const bool is_back = lane % 2 == 1;
  const double along = is_back ? length * (lane + 1) - distance : distance - length * lane;
  const double beside = kBetween * (0.5 + lane % lanes_);
  const double heading = (is_back ? std::numbers::pi : 0.0) + (is_across ? 0.5 * std::numbers::pi : 0.0);
  const Eigen::Vector3d place = is_across ? Eigen::Vector3d(along, 0.0, beside) : Eigen::Vector3d(beside, 0.0, along);
  return inverse(Pose{rotation_exp({0.0, heading, 0.0}), place});
}

Vector6 ConnectedSite::random_motion(double metres, double radians) {
  Vector6 motion;
  for (int i = 0; i < 6; ++i) motion[i] = normal(1.0) * (i < 3 ? metres : radians);
  return motion;
}

bool ConnectedSite::observes(int pose, const Eigen::Vector3d& point_in_world) const {
  const Rig& rig = problem_.rigs[0];
  const Eigen::Vector3d point_in_camera = truth_[static_cast<std::size_t>(pose)] * point_in_world;
  return point_in_camera.z() > 0.5 && point_in_camera.z() < kReach && std::abs(point_in_camera.x()) < kAside &&
         rig.contains(rig.project(point_in_camera).head<2>());
}

// Up to most poses that see a point: two of other lanes, and the nearest of the given pose's lane.
std::vector<int> ConnectedSite::observing_poses(const Eigen::Vector3d& point_in_world, int near,
                                                std::size_t most) const {
  constexpr int kSameLane = 30;  // poses apart
  constexpr std::size_t kOthers = 2;
  std::vector<int> same, others;
  const auto [x, z] = cell_of(point_in_world);
  for (const Cell& cell : {Cell{x - 1, z - 1}, Cell{x - 1, z}, Cell{x - 1, z + 1}, Cell{x, z - 1}, Cell{x, z},
                           Cell{x, z + 1}, Cell{x + 1, z - 1}, Cell{x + 1, z}, Cell{x + 1, z + 1}}) {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) continue;
    for (const int pose : found->second) {
      if (observes(pose, point_in_world)) (std::abs(pose - near) < kSameLane ? same : others).push_back(pose);
    }
  }
  std::ranges::sort(same, {}, [&](int pose) { return std::abs(pose - near); });
  others.resize(std::min(others.size(), kOthers));
  same.resize(std::min(same.size(), most - others.size()));
  same.insert(same.end(), others.begin(), others.end());
  return same;
}

// Adds a point with three to nine observations; none if too few poses see it.
void ConnectedSite::add_point() {
  const Rig& rig = problem_.rigs[0];
  const auto near = static_cast<int>(uniform(0.0, static_cast<double>(truth_.size())));
  const Eigen::Vector3d ray = rig.ray({uniform(0.0, rig.width), uniform(0.0, rig.height)});
  const Eigen::Vector3d point_in_world = inverse(truth_[static_cast<std::size_t>(near)]) * (uniform(1.5, 8.0) * ray);
  const std::vector<int> poses = observing_poses(point_in_world, near, static_cast<std::size_t>(uniform(3.0, 10.0)));
  if (poses.size() < 3) return;
  problem_.points.push_back({point_in_world, false});
  for (const int pose : poses) add_observation(pose);
}

// Adds the observation of the newest point by a pose.
void ConnectedSite::add_observation(int pose) {
  BundleObservation observation{.pose = pose, .point = static_cast<int>(problem_.points.size()) - 1, .measured = {}};
  observation.measured =
      problem_.rigs[0].project(truth_[static_cast<std::size_t>(pose)] * problem_.points.back().position_in_world) +
      Eigen::Vector3d{normal(kPixelSigma), normal(kPixelSigma), normal(kDisparitySigma)};
  if (uniform(0.0, 1.0) < kOutliers) observation.measured += 30.0 * random_motion(1.0, 0.0).head<3>();
  observation.pixel_sigma = kPixelSigma;
  observation.disparity_sigma = kDisparitySigma;
  problem_.observations.push_back(observation);
}

}  // namespace byre
