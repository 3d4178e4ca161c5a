#include "byre/simulation/simulated_mission_scene.h"

#include "byre/features/descriptor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>

namespace byre {
namespace {

using Random = std::mt19937_64;

struct Landmark {
  Eigen::Vector3d position_in_world;
  Eigen::Vector3d direction_in_world;  // in its surface; determines the angle of its keypoints
  double size = 0.0;                   // metres across its descriptor patch
  float response = 0.0f;
  Descriptor descriptor{};
};

double draw_uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

double draw_normal(Random& random, double sigma) {
  return sigma * std::normal_distribution<double>()(random);
}

bool draw_chance(Random& random, double probability) {
  return draw_uniform(random, 0.0, 1.0) < probability;
}

double draw_log_uniform(Random& random, double low, double high) {
  return std::exp(draw_uniform(random, std::log(low), std::log(high)));
}

// Axis perpendicular to a face of the room, drawn in proportion to face area.
int draw_axis(Random& random, const Eigen::Vector3d& room_size) {
  const double volume = room_size.prod();
  std::discrete_distribution<int> by_area{volume / room_size.x(), volume / room_size.y(), volume / room_size.z()};
  return by_area(random);
}

Landmark draw_landmark(Random& random, const Eigen::Vector3d& room_size) {
  const int across = draw_axis(random, room_size);
  const int first = (across + 1) % 3;
  const int second = (across + 2) % 3;
  const Eigen::Vector3d half_size = 0.5 * room_size;
  Landmark landmark;
  landmark.position_in_world[across] = draw_chance(random, 0.5) ? half_size[across] : -half_size[across];
  landmark.position_in_world[first] = draw_uniform(random, -half_size[first], half_size[first]);
  landmark.position_in_world[second] = draw_uniform(random, -half_size[second], half_size[second]);

  const double angle = draw_uniform(random, 0.0, 2.0 * std::numbers::pi);
  landmark.direction_in_world[across] = 0.0;
  landmark.direction_in_world[first] = std::cos(angle);
  landmark.direction_in_world[second] = std::sin(angle);

  landmark.size = draw_log_uniform(random, 0.25, 1.1);
  landmark.response = static_cast<float>(draw_uniform(random, 20.0, 120.0));
  for (std::uint64_t& word : landmark.descriptor) word = random();
  return landmark;
}

std::vector<Landmark> draw_landmarks(const SimulationOptions& options) {
  Random random(options.seed);
  std::vector<Landmark> landmarks;
  landmarks.reserve(static_cast<std::size_t>(options.landmarks));
  for (int i = 0; i < options.landmarks; ++i) landmarks.push_back(draw_landmark(random, options.room_size));
  return landmarks;
}

// Octave in which the landmark fills a descriptor patch; empty when none fits.
std::optional<std::uint8_t> octave_of(const Landmark& landmark, double focal, double distance) {
  constexpr double kPatchSize = 31.0;  // octave pixels (ORB, Rublee 2011)
  const double scale = landmark.size * focal / (distance * kPatchSize);
  const auto octave = std::lround(std::log(scale) / std::log(kOctaveScale));
  if (octave < 0 || octave >= kOctaves) return std::nullopt;
  return static_cast<std::uint8_t>(octave);
}

float angle_of(const Landmark& landmark, const Rig& rig, const Pose& camera_from_world,
               const Eigen::Vector3d& point_in_camera) {
  const Eigen::Vector3d direction_in_camera = camera_from_world.rotation * landmark.direction_in_world;
  const Eigen::Vector3d motion = rig.projection_jacobian(point_in_camera) * direction_in_camera;
  return static_cast<float>(std::atan2(motion.y(), motion.x()));
}

// Noise-free projection; empty when the landmark is not visible.
std::optional<Keypoint> project(const Landmark& landmark, const Rig& rig, const Pose& camera_from_world) {
  constexpr double kMinDepth = 0.1;  // metres
  const Eigen::Vector3d point_in_camera = camera_from_world * landmark.position_in_world;
  if (point_in_camera.z() < kMinDepth) return std::nullopt;
  const StereoPixel pixel = rig.project(point_in_camera);
  const auto octave = octave_of(landmark, rig.focal, point_in_camera.norm());
  if (!octave || !rig.contains(pixel.head<2>())) return std::nullopt;

  Keypoint keypoint;
  keypoint.pixel = pixel.head<2>().cast<float>();
  keypoint.disparity = static_cast<float>(pixel.z());
  keypoint.angle = angle_of(landmark, rig, camera_from_world, point_in_camera);
  keypoint.response = landmark.response;
  keypoint.octave = *octave;
  return keypoint;
}

// Adds measurement noise; the pixel may leave the image.
Keypoint disturb(Keypoint keypoint, const SimulationOptions& options, Random& random) {
  const double scale = kScaleOfOctave[keypoint.octave];
  keypoint.pixel.x() += static_cast<float>(draw_normal(random, options.pixel_sigma * scale));
  keypoint.pixel.y() += static_cast<float>(draw_normal(random, options.pixel_sigma * scale));
  const double disparity = keypoint.disparity;
  const double measured = disparity + draw_normal(random, options.disparity_sigma * scale);
  const bool is_matched = disparity > 0.0 && disparity >= options.min_disparity && measured > 0.0;
  keypoint.disparity = is_matched ? static_cast<float>(measured) : -1.0f;
  keypoint.disparity_sigma = is_matched ? static_cast<float>(options.disparity_sigma * scale) : -1.0f;
  return keypoint;
}

// The keypoint moved to a random pixel and disparity: an outlier.
Keypoint displace(Keypoint keypoint, const Rig& rig, const SimulationOptions& options, Random& random) {
  constexpr double kNearestDepth = 0.5;  // metres
  keypoint.pixel.x() = static_cast<float>(draw_uniform(random, 0.0, rig.width - 1.0));
  keypoint.pixel.y() = static_cast<float>(draw_uniform(random, 0.0, rig.height - 1.0));
  const double max_disparity = std::max(options.min_disparity, rig.focal * rig.baseline / kNearestDepth);
  const double disparity = draw_uniform(random, options.min_disparity, max_disparity);
  if (keypoint.has_disparity()) keypoint.disparity = static_cast<float>(disparity);
  return keypoint;
}

Descriptor flip_bits(Descriptor descriptor, double ratio, Random& random) {
  for (std::uint64_t& word : descriptor) {
    for (int bit = 0; bit < 64; ++bit) {
      if (draw_chance(random, ratio)) word ^= std::uint64_t{1} << bit;
    }
  }
  return descriptor;
}

struct Detection {
  Keypoint keypoint;
  Descriptor descriptor{};
  int landmark = -1;
};

std::vector<Detection> detect(const std::vector<Landmark>& landmarks, const Rig& rig, const Pose& camera_from_world,
                              const SimulationOptions& options, Random& random) {
  std::vector<Detection> detections;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const std::optional<Keypoint> seen = project(landmarks[i], rig, camera_from_world);
    if (!seen || draw_chance(random, options.missing_ratio)) continue;
    const bool is_outlier = draw_chance(random, options.outlier_ratio);
    Detection detection{disturb(*seen, options, random), {}, is_outlier ? -1 : static_cast<int>(i)};
    if (is_outlier) detection.keypoint = displace(detection.keypoint, rig, options, random);
    if (!rig.contains(detection.keypoint.pixel.cast<double>())) continue;
    detection.descriptor = flip_bits(landmarks[i].descriptor, options.descriptor_flip_ratio, random);
    detections.push_back(detection);
  }
  return detections;
}

void keep_strongest(std::vector<Detection>& detections, int max_count) {
  const auto count = std::min(detections.size(), static_cast<std::size_t>(std::max(max_count, 0)));
  std::ranges::stable_sort(detections, std::greater<>{}, [](const Detection& d) { return d.keypoint.response; });
  detections.resize(count);
}

Features to_features(const std::vector<Detection>& detections, const Rig& rig) {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (const Detection& detection : detections) {
    keypoints.push_back(detection.keypoint);
    descriptors.push_back(detection.descriptor);
  }
  return Features(rig.width, rig.height, std::move(keypoints), std::move(descriptors), {});
}

// Maps features to landmarks: Features reorders its input, so pixel and descriptor identify a detection.
std::vector<int> landmarks_of(const Features& features, const std::vector<Detection>& detections) {
  const auto key_of = [](const Keypoint& keypoint, const Descriptor& descriptor) {
    return std::tuple(keypoint.pixel.x(), keypoint.pixel.y(), descriptor);
  };
  std::map<std::tuple<float, float, Descriptor>, int> landmark_of;
  for (const auto& [keypoint, descriptor, landmark] : detections) landmark_of[key_of(keypoint, descriptor)] = landmark;
  std::vector<int> landmarks;
  for (int i = 0; i < features.size(); ++i) {
    landmarks.push_back(landmark_of.at(key_of(features.keypoint(i), features.descriptor(i))));
  }
  return landmarks;
}

// Observations of each landmark by a map's keyframes, ascending.
using Tracks = std::vector<std::vector<Observation>>;

Pose camera_from_world_at(const SimulatedMission& mission, std::size_t frame) {
  return inverse(mission.truth[frame].world_from_body * mission.rig.body_from_camera);
}

// Adds every n-th frame to the map as a keyframe without points. Returns the landmarks' observations.
Tracks add_keyframes(MapGraph& map, const SimulatedMission& mission, int frames_per_keyframe) {
  Tracks tracks(mission.landmarks_in_world.size());
  std::optional<KeyframeId> parent;
  for (std::size_t i = 0; i < mission.frames.size(); i += static_cast<std::size_t>(frames_per_keyframe)) {
    Keyframe keyframe;
    keyframe.frame = mission.frames[i];
    keyframe.camera_from_world = camera_from_world_at(mission, i);
    for (const Keypoint& keypoint : keyframe.frame.features->keypoints()) {
      keyframe.sightings.push_back({std::nullopt, keypoint.pixel, kScaleOfOctave[keypoint.octave]});
    }
    keyframe.parent = parent;
    const KeyframeId id = map.add_keyframe(std::move(keyframe));
    const std::vector<int>& landmarks = mission.landmark_of_feature[i];
    for (std::size_t feature = 0; feature < landmarks.size(); ++feature) {
      if (landmarks[feature] < 0) continue;
      tracks[static_cast<std::size_t>(landmarks[feature])].push_back({id, static_cast<int>(feature)});
    }
    parent = id;
  }
  return tracks;
}

const Features& features_of(const MapGraph& map, const Observation& observation) {
  return *map.find_keyframe(observation.keyframe)->frame.features;
}

// Descriptor with the least Hamming distance to all others.
Descriptor central_descriptor(const MapGraph& map, const std::vector<Observation>& observations) {
  std::vector<Descriptor> descriptors;
  for (const Observation& seen : observations) descriptors.push_back(features_of(map, seen).descriptor(seen.feature));
  const auto distance_to_all = [&](const Descriptor& candidate) {
    int sum = 0;
    for (const Descriptor& other : descriptors) sum += hamming_distance(candidate, other);
    return sum;
  };
  return *std::ranges::min_element(descriptors, {}, distance_to_all);
}

MapPoint to_point(const MapGraph& map, const Eigen::Vector3d& position_in_world,
                  const std::vector<Observation>& observations) {
  const auto ray_from = [&](const Observation& observation) -> Eigen::Vector3d {
    return position_in_world - inverse(map.camera_from_world(observation.keyframe)).translation;
  };
  Eigen::Vector3d directions = Eigen::Vector3d::Zero();
  for (const Observation& observation : observations) directions += ray_from(observation).normalized();

  MapPoint point;
  point.position_in_world = position_in_world;
  point.mean_viewing_direction = directions.normalized().cast<float>();
  point.descriptor = central_descriptor(map, observations);
  point.reference = observations.front();
  const Keypoint& keypoint = features_of(map, point.reference).keypoint(point.reference.feature);
  point.max_distance = static_cast<float>(ray_from(point.reference).norm()) * kScaleOfOctave[keypoint.octave];
  point.min_distance = point.max_distance / kScaleOfOctave.back();
  return point;
}

bool can_be_mapped(const MapGraph& map, const std::vector<Observation>& observations) {
  return observations.size() > 1 || std::ranges::any_of(observations, [&](const Observation& observation) {
           return features_of(map, observation).keypoint(observation.feature).has_disparity();
         });
}

void add_landmark(MapGraph& map, const Eigen::Vector3d& position_in_world,
                  const std::vector<Observation>& observations) {
  const PointId id = map.add_point(to_point(map, position_in_world, observations));
  for (const Observation& observation : observations) {
    const std::vector<Sighting>& sightings = map.find_keyframe(observation.keyframe)->sightings;
    Sighting sighting = sightings[static_cast<std::size_t>(observation.feature)];
    sighting.point = id;
    map.add_observation(observation, sighting);
  }
}

}  // namespace

SimulatedMission simulate_mission(const Rig& rig, const Trajectory& truth, const SimulationOptions& options) {
  const std::vector<Landmark> landmarks = draw_landmarks(options);
  SimulatedMission mission;
  mission.rig = rig;
  mission.truth = truth;
  for (const Landmark& landmark : landmarks) mission.landmarks_in_world.push_back(landmark.position_in_world);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    std::seed_seq frame_seed{options.seed, options.noise_seed, static_cast<std::uint64_t>(i)};
    Random random(frame_seed);
    std::vector<Detection> detections = detect(landmarks, rig, camera_from_world_at(mission, i), options, random);
    keep_strongest(detections, options.max_features);
    const auto features = std::make_shared<const Features>(to_features(detections, rig));
    mission.frames.push_back({truth[i].time, features});
    mission.landmark_of_feature.push_back(landmarks_of(*features, detections));
  }
  return mission;
}

MapGraph true_map(const SimulatedMission& mission, int frames_per_keyframe, Origin origin) {
  MapGraph map(origin);
  map.add_rig(mission.rig);
  const Tracks tracks = add_keyframes(map, mission, frames_per_keyframe);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (can_be_mapped(map, tracks[i])) add_landmark(map, mission.landmarks_in_world[i], tracks[i]);
  }
  return map;
}

}  // namespace byre
