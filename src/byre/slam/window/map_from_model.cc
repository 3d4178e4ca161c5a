#include "byre/slam/window/map_from_model.h"

#include "byre/features/descriptor.h"
#include "byre/geometry/median.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/tracking/measurement.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

namespace byre {
namespace {

// A feature that shows a point of a model.
struct ModelView {
  int image = 0;  // index into SfmModel::images
  int feature = 0;
  float offset = 0.0f;  // octave pixels from the projection of the point
};

struct ModelSightings {
  int point = 0;                 // index into SfmModel::points
  std::vector<ModelView> views;  // ascending by image, at least two
};

constexpr int kUnlike = 80;  // bits; a descriptor at this distance counts like a missing one

const PosedFrame& image_of(const SfmModel& model, int image) {
  return model.images[static_cast<std::size_t>(image)];
}

const Descriptor& descriptor_of(const SfmModel& model, const ModelView& candidate) {
  return image_of(model, candidate.image).frame.features->descriptor(candidate.feature);
}

CameraView view_of(const SfmModel& model, int image) {
  const PosedFrame& entry = image_of(model, image);
  return {*entry.frame.features, model.rigs[static_cast<std::size_t>(entry.rig)], entry.camera_from_world};
}

// Empty behind the camera.
std::optional<Eigen::Vector2d> project(const CameraView& view, const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d point_in_camera = view.camera_from_world * point_in_world;
  if (point_in_camera.z() <= 0.0) return std::nullopt;
  return view.rig.project(point_in_camera).head<2>();
}

// Measurement of a point by a feature; empty if it is more than max_error (octave pixels) off the projection.
std::optional<PixelMeasurement> measure_against(const ViewedFeature& reference, const Eigen::Vector3d& point_in_world,
                                                const CameraView& view, int feature, float max_error) {
  const auto projected = project(view, point_in_world);
  if (!projected) return std::nullopt;
  const PixelMeasurement measured = measure_pixel(reference, point_in_world, view, feature);
  const float error = (projected->cast<float>() - measured.pixel).norm();
  if (error > max_error * kScaleOfOctave[view.features.keypoint(feature).octave]) return std::nullopt;
  return measured;
}

void append_candidates(const SfmModel& model, const Eigen::Vector3d& point_in_world, int image, float radius,
                       std::vector<ModelView>& candidates) {
  const CameraView view = view_of(model, image);
  const auto projected = project(view, point_in_world);
  if (!projected || !view.rig.contains(*projected)) return;
  const Eigen::Vector2f pixel = projected->cast<float>();
  view.features.visit_area(pixel, radius * kScaleOfOctave.back(), 0, kOctaves - 1, [&](int feature) {
    const Keypoint& keypoint = view.features.keypoint(feature);
    const float offset = (keypoint.pixel - pixel).norm() / kScaleOfOctave[keypoint.octave];
    if (offset <= radius) candidates.push_back({image, feature, offset});
  });
}

std::vector<ModelView> find_candidates(const SfmModel& model, const ModelPoint& point, float radius) {
  std::vector<int> images = point.images;
  std::ranges::sort(images);
  images.erase(std::unique(images.begin(), images.end()), images.end());
  std::vector<ModelView> candidates;
  for (const int image : images) append_candidates(model, point.position_in_world, image, radius, candidates);
  return candidates;
}

// The most similar candidate of each image.
std::vector<ModelView> most_similar_views(const SfmModel& model, const std::vector<ModelView>& candidates,
                                          const Descriptor& descriptor, int max_distance) {
  std::vector<ModelView> chosen;
  int best = 0;
  for (const ModelView& candidate : candidates) {
    const int distance = hamming_distance(descriptor, descriptor_of(model, candidate));
    if (distance > max_distance) continue;
    const bool same_image = !chosen.empty() && chosen.back().image == candidate.image;
    if (same_image && distance >= best) continue;
    if (same_image) chosen.pop_back();
    chosen.push_back(candidate);
    best = distance;
  }
  return chosen;
}

// Sum over the images of the distance of the best candidate to the descriptor, bits.
int descriptor_distance(const SfmModel& model, const std::vector<ModelView>& candidates, const Descriptor& descriptor) {
  int sum = 0;
  for (std::size_t i = 0; i < candidates.size();) {
    int best = kUnlike;
    const int image = candidates[i].image;
    for (; i < candidates.size() && candidates[i].image == image; ++i) {
      best = std::min(best, hamming_distance(descriptor, descriptor_of(model, candidates[i])));
    }
    sum += best;
  }
  return sum;
}

// Leaves each feature to one point: the one that projects nearest to it.
void resolve_claims(std::vector<ModelSightings>& sightings) {
  std::map<std::pair<int, int>, std::pair<float, int>> owners;  // by image and feature
  for (const ModelSightings& point : sightings) {
    for (const ModelView& view : point.views) {
      const std::pair claim(view.offset, point.point);
      const auto [owner, is_new] = owners.try_emplace({view.image, view.feature}, claim);
      if (!is_new) owner->second = std::min(owner->second, claim);
    }
  }
  for (ModelSightings& point : sightings) {
    std::erase_if(point.views, [&](const ModelView& view) {
      return owners.at({view.image, view.feature}).second != point.point;
    });
  }
}

// View whose descriptor is most similar to those of the other images. Precondition: views by image, at least one.
const ModelView& most_central(const SfmModel& model, const std::vector<ModelView>& views) {
  return *std::ranges::min_element(views, {}, [&](const ModelView& view) {
    return std::pair(descriptor_distance(model, views, descriptor_of(model, view)), view.offset);
  });
}

// Features that show the model's points: near the projection in the images that saw the point, with similar
// descriptors. A feature shows one point only. Points with fewer than two features are dropped; the others are
// ascending.
std::vector<ModelSightings> find_sightings(const SfmModel& model, const ModelMapOptions& options) {
  std::vector<ModelSightings> sightings;
  for (int i = 0; i < static_cast<int>(model.points.size()); ++i) {
    const std::vector<ModelView> candidates =
        find_candidates(model, model.points[static_cast<std::size_t>(i)], options.search_radius);
    if (candidates.empty()) continue;
    const Descriptor& central = descriptor_of(model, most_central(model, candidates));
    sightings.push_back({i, most_similar_views(model, candidates, central, options.max_distance)});
  }
  resolve_claims(sightings);
  std::erase_if(sightings, [](const ModelSightings& point) { return point.views.size() < 2; });
  return sightings;
}

// Median depth of the points in their reference views.
double median_depth(const MapGraph& map) {
  std::vector<double> depths;
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    depths.push_back((map.camera_from_world(point.reference.keyframe) * point.position_in_world).z());
  }
  return median(std::move(depths));
}

std::optional<PointId> point_at(const MapGraph& map, const Observation& seen) {
  return map.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)].point;
}

// The point of the map that most of these features show.
std::optional<PointId> known_point(const MapGraph& map, const std::vector<Observation>& observations) {
  std::map<PointId, int> counts;
  for (const Observation& seen : observations) {
    if (const auto point = point_at(map, seen)) ++counts[*point];
  }
  if (counts.empty()) return std::nullopt;
  return std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; })->first;
}

Sighting as_seen(const MapGraph& from, const Observation& seen, PointId point) {
  Sighting sighting = from.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)];
  sighting.point = point;
  return sighting;
}

void add_view(const SfmModel& model, PointId id, const Observation& seen, float max_error, MapGraph& map) {
  const MapPoint& point = *map.find_point(id);
  const CameraView reference = view_of(model, static_cast<int>(point.reference.keyframe.number));
  const Eigen::Vector2f reference_pixel =
      map.find_keyframe(point.reference.keyframe)->sightings[static_cast<std::size_t>(point.reference.feature)].pixel;
  const auto measured =
      measure_against({reference, point.reference.feature, reference_pixel}, point.position_in_world,
                      view_of(model, static_cast<int>(seen.keyframe.number)), seen.feature, max_error);
  if (measured) map.add_observation(seen, {id, measured->pixel, measured->sigma});
}

struct Measured {
  ModelView view;
  PixelMeasurement measurement;
};

// Covariance by the model's own views, with exact poses and this sigma of pixels; square units of the model.
std::optional<Eigen::Matrix3d> position_covariance(const SfmModel& model, const ModelPoint& point, double sigma) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const int image : point.images) {
    const CameraView view = view_of(model, image);
    const Eigen::Vector3d point_in_camera = view.camera_from_world * point.position_in_world;
    if (point_in_camera.z() <= 0.0) continue;
    const Eigen::Matrix<double, 2, 3> jacobian =
        view.rig.projection_jacobian(point_in_camera).topRows<2>() * view.camera_from_world.rotation.toRotationMatrix();
    information += jacobian.transpose() * jacobian / (sigma * sigma);
  }
  const Eigen::LLT<Eigen::Matrix3d> factors(information);
  if (factors.info() != Eigen::Success || factors.rcond() < 1e-14) return std::nullopt;
  const Eigen::Matrix3d covariance = factors.solve(Eigen::Matrix3d::Identity());
  return 0.5 * (covariance + covariance.transpose());
}

// The reference's patch defines the point at the projection, which is not exactly at the corner.
PixelMeasurement measure_reference(const CameraView& view, int feature, const Eigen::Vector3d& point_in_world) {
  if (view.features.find_patch(feature) == nullptr) return corner_measurement(view.features.keypoint(feature));
  return {project(view, point_in_world)->cast<float>(), reference_sigma(view.features, feature), true};
}

// Views of a point that agree with its reference in the image; the reference is the first.
std::vector<Measured> measure_views(const SfmModel& model, const ModelSightings& sightings,
                                    const ModelMapOptions& options) {
  const Eigen::Vector3d& point_in_world = model.points[static_cast<std::size_t>(sightings.point)].position_in_world;
  const ModelView reference = *std::ranges::min_element(sightings.views, {}, &ModelView::offset);
  const CameraView reference_view = view_of(model, reference.image);
  const PixelMeasurement defined = measure_reference(reference_view, reference.feature, point_in_world);
  std::vector<Measured> measured = {{reference, defined}};
  for (const ModelView& view : sightings.views) {
    if (view.image == reference.image) continue;
    const auto measurement = measure_against({reference_view, reference.feature, defined.pixel}, point_in_world,
                                             view_of(model, view.image), view.feature, options.max_error);
    if (measurement) measured.push_back({view, *measurement});
  }
  return measured;
}

Eigen::Vector3f mean_direction(const SfmModel& model, const std::vector<Measured>& views,
                               const Eigen::Vector3d& point_in_world) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Measured& seen : views) {
    const Pose& camera_from_world = view_of(model, seen.view.image).camera_from_world;
    sum += (point_in_world - inverse(camera_from_world).translation).normalized();
  }
  if (sum.norm() < 1e-3) return Eigen::Vector3f::UnitZ();
  return sum.normalized().cast<float>();
}

Descriptor central_descriptor(const SfmModel& model, const std::vector<Measured>& measured) {
  std::vector<ModelView> views;
  for (const Measured& seen : measured) views.push_back(seen.view);
  const ModelView& central = most_central(model, views);
  return view_of(model, central.image).features.descriptor(central.feature);
}

void add_images(const SfmModel& model, MapGraph& map) {
  std::optional<KeyframeId> previous;
  for (const PosedFrame& image : model.images) {
    previous = add_keyframe_at(image.camera_from_world, image.frame, model.rigs[static_cast<std::size_t>(image.rig)],
                               previous, map, image.rig);
  }
}

// Precondition: keyframe n is image n.
void add_model_point(const SfmModel& model, int index, const std::vector<Measured>& views,
                     const Eigen::Matrix3d& covariance, MapGraph& map) {
  const ModelPoint& point = model.points[static_cast<std::size_t>(index)];
  const auto observation_of = [](const ModelView& view) {
    return Observation{{Origin::online, static_cast<std::uint32_t>(view.image)}, view.feature};
  };
  const CameraView reference = view_of(model, views.front().view.image);
  MapPoint made = make_point(point.position_in_world, covariance, observation_of(views.front().view),
                             reference.features, reference.camera_from_world);
  made.mean_viewing_direction = mean_direction(model, views, point.position_in_world);
  made.descriptor = central_descriptor(model, views);
  const PointId id = map.add_point(made);
  for (const Measured& seen : views) {
    map.add_observation(observation_of(seen.view), {id, seen.measurement.pixel, seen.measurement.sigma});
  }
}

// Adds points for corners that show no point of the model, triangulated from the model's poses. If such a point turns
// out to be a point of the model, that point gets the views that measure it at its position.
void add_own_points(const SfmModel& model, const ModelMapOptions& options, MapGraph& map) {
  if (map.point_count() == 0) return;
  KnownPoseOptions own_options = options.own_points;
  own_options.assumed_depth = median_depth(map);
  const MapGraph own = map_from_poses(model.rigs, model.images, own_options);
  for (const PointId own_id : own.point_ids()) {
    const std::vector<Observation>& observations = own.observations(own_id);
    if (const auto known = known_point(map, observations)) {
      for (const Observation& seen : observations) add_view(model, *known, seen, options.max_error, map);
      continue;
    }
    const PointId id = map.add_point(*own.find_point(own_id));
    for (const Observation& seen : observations) map.add_observation(seen, as_seen(own, seen, id));
  }
}

}  // namespace

ModelMap map_from_model(const SfmModel& model, const ModelMapOptions& options) {
  ModelMap made;
  add_images(model, made.map);
  for (const ModelSightings& sightings : find_sightings(model, options)) {
    std::vector<Measured> views = measure_views(model, sightings, options);
    const auto covariance =
        position_covariance(model, model.points[static_cast<std::size_t>(sightings.point)], options.model_sigma);
    if (views.size() < 2 || !covariance) continue;
    add_model_point(model, sightings.point, views, *covariance, made.map);
    made.model_points.push_back(sightings.point);
  }
  if (options.add_own_points) add_own_points(model, options, made.map);
  return made;
}

}  // namespace byre
