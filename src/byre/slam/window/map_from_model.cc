#include "byre/slam/window/map_from_model.h"

#include "byre/geometry/median.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/window/model_sightings.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

namespace byre {
namespace {

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
