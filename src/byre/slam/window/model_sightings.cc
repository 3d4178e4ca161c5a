#include "byre/slam/window/model_sightings.h"

#include "byre/features/descriptor.h"

#include <algorithm>
#include <map>
#include <utility>

namespace byre {
namespace {

constexpr int kUnlike = 80;  // bits; a descriptor at this distance counts like a missing one

const PosedFrame& image_of(const SfmModel& model, int image) {
  return model.images[static_cast<std::size_t>(image)];
}

const Descriptor& descriptor_of(const SfmModel& model, const ModelView& candidate) {
  return image_of(model, candidate.image).frame.features->descriptor(candidate.feature);
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

}  // namespace

CameraView view_of(const SfmModel& model, int image) {
  const PosedFrame& entry = image_of(model, image);
  return {*entry.frame.features, model.rigs[static_cast<std::size_t>(entry.rig)], entry.camera_from_world};
}

std::optional<Eigen::Vector2d> project(const CameraView& view, const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d point_in_camera = view.camera_from_world * point_in_world;
  if (point_in_camera.z() <= 0.0) return std::nullopt;
  return view.rig.project(point_in_camera).head<2>();
}

std::optional<PixelMeasurement> measure_against(const ViewedFeature& reference, const Eigen::Vector3d& point_in_world,
                                                const CameraView& view, int feature, float max_error) {
  const auto projected = project(view, point_in_world);
  if (!projected) return std::nullopt;
  const PixelMeasurement measured = measure_pixel(reference, point_in_world, view, feature);
  const float error = (projected->cast<float>() - measured.pixel).norm();
  if (error > max_error * kScaleOfOctave[view.features.keypoint(feature).octave]) return std::nullopt;
  return measured;
}

const ModelView& most_central(const SfmModel& model, const std::vector<ModelView>& views) {
  return *std::ranges::min_element(views, {}, [&](const ModelView& view) {
    return std::pair(descriptor_distance(model, views, descriptor_of(model, view)), view.offset);
  });
}

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

}  // namespace byre
