#include "byre/map/map_file.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace byre {
namespace {

using Faults = std::vector<std::string>;

void add_fault(std::string_view fault, std::string_view thing, std::size_t number, Faults& faults) {
  if (fault.empty()) return;
  faults.push_back(std::string(thing) + " " + std::to_string(number) + " " + std::string(fault));
}

template <typename Matrix>
std::string_view covariance_fault(const Matrix& covariance) {
  constexpr double kTolerance = 1e-9;
  if (!covariance.allFinite()) return "has a covariance that is not finite";
  const double largest = covariance.cwiseAbs().maxCoeff();
  const double asymmetry = (covariance - covariance.transpose()).cwiseAbs().maxCoeff();
  return asymmetry <= kTolerance * largest ? "" : "has an asymmetric covariance";
}

template <typename Id>
bool are_dense(const std::vector<Id>& ids) {
  return ids.empty() || ids.back().number + std::size_t{1} == ids.size();
}

bool are_in_grid_order(const Features& features, const Rig& rig) {
  const Features sorted(rig.width, rig.height, to_vector(features.keypoints()), to_vector(features.descriptors()), {});
  return std::ranges::equal(sorted.keypoints(), features.keypoints(), {}, &Keypoint::pixel, &Keypoint::pixel);
}

std::string_view feature_fault(const Features& features, const Rig& rig) {
  if (const auto fault = fault_in(rig); !fault.empty()) return "has an invalid rig";
  for (int i = 0; i < features.size(); ++i) {
    if (const auto fault = fault_in(features.keypoint(i), rig); !fault.empty()) return fault;
    const Patch* const patch = features.find_patch(i);
    if (patch && !fault_in(*patch).empty()) return fault_in(*patch);
  }
  return are_in_grid_order(features, rig) ? "" : "has keypoints that are not sorted by grid cell";
}

std::string_view sighting_fault(const Keyframe& keyframe) {
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    if (sighting.point->origin != Origin::offline) return "observes an online point";
    if (const auto fault = fault_in(sighting); !fault.empty()) return fault;
  }
  return "";
}

std::string_view word_fault(const Keyframe& keyframe, std::uint64_t vocabulary_checksum) {
  if (keyframe.words.empty()) return "";
  if (keyframe.words.size() != keyframe.sightings.size()) return "does not have one word per feature";
  return vocabulary_checksum != 0 ? "" : "has words without a vocabulary";
}

void check_keyframe(const StoredMap& stored, KeyframeId id, Faults& faults) {
  const Keyframe& keyframe = *stored.map.find_keyframe(id);
  const auto add = [&](std::string_view fault) { add_fault(fault, "keyframe", id.number, faults); };
  const bool has_recording = keyframe.recording >= 0 && std::cmp_less(keyframe.recording, stored.recordings.size());
  if (!has_recording) add("belongs to a recording that is not listed");
  add(covariance_fault(keyframe.covariance));
  const bool has_rig = keyframe.rig >= 0 && std::cmp_less(keyframe.rig, stored.map.rigs().size());
  if (has_rig && keyframe.frame.features) {
    add(feature_fault(*keyframe.frame.features, stored.map.rigs()[static_cast<std::size_t>(keyframe.rig)]));
  }
  add(sighting_fault(keyframe));
  add(word_fault(keyframe, stored.vocabulary_checksum));
}

void check_plan(const StoredMap& stored, Faults& faults) {
  if (!stored.plan) return;
  const auto add = [&faults](std::string_view fault) {
    if (!fault.empty()) faults.push_back("the plan " + std::string(fault));
  };
  add(fault_in(*stored.plan));
  if (stored.plan->covariance.allFinite()) add(covariance_fault(stored.plan->covariance));
}

}  // namespace

std::vector<std::string> find_faults(const StoredMap& stored) {
  Faults faults = find_faults(stored.map);
  const std::vector<KeyframeId> keyframes = stored.map.keyframe_ids();
  const std::vector<PointId> points = stored.map.point_ids();
  if (stored.map.origin() != Origin::offline) faults.push_back("the map is not offline");
  if (!are_dense(keyframes)) faults.push_back("the numbers of keyframes have gaps");
  if (!are_dense(points)) faults.push_back("the numbers of points have gaps");
  for (std::size_t i = 0; i < stored.map.rigs().size(); ++i)
    add_fault(fault_in(stored.map.rigs()[i]), "rig", i, faults);
  for (std::size_t i = 0; i < stored.recordings.size(); ++i) {
    add_fault(fault_in(stored.recordings[i]), "recording", i, faults);
  }
  for (const KeyframeId id : keyframes) check_keyframe(stored, id, faults);
  check_plan(stored, faults);
  for (const PointId id : points) {
    const MapPoint& point = *stored.map.find_point(id);
    add_fault(fault_in(point), "point", id.number, faults);
    if (point.covariance.allFinite()) add_fault(covariance_fault(point.covariance), "point", id.number, faults);
  }
  return faults;
}

}  // namespace byre
