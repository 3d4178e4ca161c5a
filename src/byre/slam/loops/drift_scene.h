#pragma once

// Maps with drift after a lap, without any recognised loop.

#include "byre/alignment.h"
#include "byre/slam/places/place_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace byre {

inline Rig monocular_rig() {
  Rig rig = simulated_rig();
  rig.baseline = 0.0;
  return rig;
}

struct LapOptions {
  int frames = 72;  // total
  int step = 3;     // frames between keyframes
  // Maximum number of keyframes that see a point; later ones see a new point instead, as behind corners.
  std::size_t max_views = 1000;
};

// A lap and a fifth. The first half has no drift; from there on the drift grows evenly.
class DriftedLap {
 public:
  DriftedLap(const Rig& rig, const Similarity& whole_drift, const LapOptions& options = {})
      : mission(simulate_mission(rig, circling_trajectory(options.frames, 10.0, 2.0, 1.2),
                                 {.pixel_sigma = 0.2, .disparity_sigma = 0.1})),
        index(vocabulary_of(mission)),
        whole_drift_(whole_drift),
        max_views_(options.max_views) {
    const MapGraph truth = true_map(mission, options.step, Origin::online);
    map.add_rig(rig);
    keyframes_ = truth.keyframe_count();
    for (const KeyframeId id : truth.keyframe_ids()) add_keyframe(*truth.find_keyframe(id), id);
    for (const PointId id : truth.point_ids()) add_visits(truth, id);
  }

  // Drift at a keyframe: point_in_map = drift * point_in_truth.
  Similarity drift_at(KeyframeId id) const {
    const double half = 0.5 * keyframes_;
    const double share = std::max(0.0, (id.number - half) / (keyframes_ - 1 - half));
    const Pose& whole = whole_drift_.target_from_source;
    return {std::pow(whole_drift_.scale, share),
            {rotation_exp(share * rotation_log(whole.rotation)), share * whole.translation}};
  }

  KeyframeId newest() const { return map.keyframe_ids().back(); }

  Pose true_pose(KeyframeId id) const {
    return true_camera_from_world(mission, frame_at(mission, map.find_keyframe(id)->frame.time));
  }

  // Largest position error of a keyframe after alignment with the truth, metres.
  double worst_error(const MapGraph& adjusted, Scale scale) const {
    std::vector<Eigen::Vector3d> estimated, truth;
    for (const KeyframeId id : adjusted.keyframe_ids()) {
      estimated.push_back(inverse(adjusted.camera_from_world(id)).translation);
      truth.push_back(inverse(true_pose(id)).translation);
    }
    const auto truth_from_map = align(estimated, truth, scale);
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      worst = std::max(worst, (*truth_from_map * estimated[i] - truth[i]).norm());
    }
    return worst;
  }

  SimulatedMission mission;
  MapGraph map{Origin::online};
  PlaceIndex index;

 private:
  void add_keyframe(Keyframe keyframe, KeyframeId id) {
    keyframe.camera_from_world = move_camera(drift_at(id), keyframe.camera_from_world);
    for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
    keyframe.words = index.vocabulary().words_of(*keyframe.frame.features);
    index.add(map.add_keyframe(keyframe), keyframe.words);
  }

  // A landmark that reappears after more than kLongestGap keyframes becomes a new point.
  void add_visits(const MapGraph& truth, PointId id) {
    constexpr std::uint32_t kLongestGap = 4;  // keyframes
    std::vector<Observation> visit;
    for (const Observation& seen : truth.observations(id)) {
      const bool is_over = visit.size() == max_views_ ||
                           (!visit.empty() && seen.keyframe.number > visit.back().keyframe.number + kLongestGap);
      if (is_over) {
        add_point(*truth.find_point(id), visit);
        visit.clear();
      }
      visit.push_back(seen);
    }
    add_point(*truth.find_point(id), visit);
  }

  void add_point(MapPoint point, const std::vector<Observation>& visit) {
    if (visit.size() < 2) return;
    const Similarity drift = drift_at(visit.front().keyframe);
    point.position_in_world = drift * point.position_in_world;
    point.min_distance *= static_cast<float>(drift.scale);
    point.max_distance *= static_cast<float>(drift.scale);
    point.reference = visit.front();
    const PointId added = map.add_point(point);
    for (const Observation& seen : visit) {
      const Keypoint& keypoint = map.find_keyframe(seen.keyframe)->frame.features->keypoint(seen.feature);
      map.add_observation(seen, {added, keypoint.pixel, kScaleOfOctave[keypoint.octave]});
    }
  }

  Similarity whole_drift_;
  std::size_t max_views_;
  int keyframes_ = 0;
};

}  // namespace byre
