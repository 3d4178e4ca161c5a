#include "byre/map/mapped_tag.h"

#include "byre/alignment.h"
#include "byre/base/numbers_by_name.h"
#include "byre/base/text_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace byre {
namespace {

constexpr std::string_view kPrefix = "tag ";
constexpr std::array kFamilies = {TagFamily::tag36h11, TagFamily::tag25h9, TagFamily::tag_standard41h12};

std::optional<TagId> id_of_note(std::string_view key) {
  if (!key.starts_with(kPrefix)) return std::nullopt;
  key.remove_prefix(kPrefix.size());
  for (const TagFamily family : kFamilies) {
    const std::string name = std::string(to_string(family)) + " ";
    if (!key.starts_with(name)) continue;
    const auto number = parse_whole<int>(key.substr(name.size()));
    if (number && *number >= 0) return TagId{family, *number};
  }
  return std::nullopt;
}

std::optional<MappedTag> tag_of_note(const TagId& id, std::string_view note) {
  constexpr double kUnit = 1e-3;
  constexpr double kFarthest = 1e6;  // metres
  const NumbersByName numbers(note);
  MappedTag tag{id};
  std::array<double, 4> rotation{};
  Eigen::Vector3d& position = tag.map_from_tag.translation;
  const bool is_whole = numbers.get("size_m", tag.size) && numbers.get("map_from_tag_wxyz", rotation) &&
                        numbers.get("position_m", std::span(position.data(), 3)) && numbers.get("sigma_m", tag.sigma);
  if (!is_whole) return std::nullopt;
  const Eigen::Quaterniond read(rotation[0], rotation[1], rotation[2], rotation[3]);
  const bool is_sound = tag.size > 0.0 && tag.size < kFarthest && tag.sigma >= 0.0 && tag.sigma < kFarthest &&
                        std::abs(read.norm() - 1.0) < kUnit && position.cwiseAbs().maxCoeff() < kFarthest;
  if (!is_sound) return std::nullopt;
  tag.map_from_tag.rotation = read.normalized();
  return tag;
}

double size_of(const TagId& id, std::span<const Tag> tags) {
  return std::ranges::find(tags, id, &Tag::id)->size;
}

// Views of the tags with a known size.
std::map<TagId, std::vector<TagView>> views_of_tags(const MapGraph& map, std::span<const Tag> tags) {
  constexpr std::size_t kMostViews = 40;  // bounds the time
  std::map<TagId, std::vector<TagView>> views;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    for (const TagSighting& seen : keyframe.frame.tags) {
      if (std::ranges::find(tags, seen.id, &Tag::id) == tags.end()) continue;
      const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
      views[seen.id].push_back({keyframe.camera_from_world, rig, seen.corners});
    }
  }
  for (auto& [id, all] : views) {
    if (all.size() <= kMostViews) continue;
    for (std::size_t i = 0; i < kMostViews; ++i) all[i] = all[i * all.size() / kMostViews];  // evenly
    all.resize(kMostViews);
  }
  return views;
}

bool differ(const UnitEstimate& one, const UnitEstimate& other) {
  constexpr double kLeast = 0.05;  // natural logarithm
  constexpr double kSigmas = 4.0;
  const double difference = std::abs(std::log(one.lengths_per_metre / other.lengths_per_metre));
  return difference > std::max(kLeast, kSigmas * std::hypot(one.sigma, other.sigma));
}

UnitEstimate mean_of(std::span<const UnitEstimate> units) {
  constexpr double kSigmaOfBlur = 0.01;  // common to all tags
  double sum = 0.0, weights = 0.0;
  for (const UnitEstimate& unit : units) {
    const double weight = 1.0 / (unit.sigma * unit.sigma);
    sum += weight * std::log(unit.lengths_per_metre);
    weights += weight;
  }
  return {std::exp(sum / weights), std::max(kSigmaOfBlur, 1.0 / std::sqrt(weights))};
}

// Largest distance between places of a tag by single near views of it.
double distance_between_places(std::span<const TagView> views, double size) {
  constexpr double kMaxSigma = 0.1;  // metres; a far view is off by more
  std::vector<Eigen::Vector3d> places;
  for (const TagView& view : views) {
    const auto estimates = estimate_tag_pose({&view, 1}, size);
    if (estimates.empty()) continue;
    const Matrix6& covariance = estimates[0].covariance;
    const bool is_near = position_variance(covariance) <= kMaxSigma * kMaxSigma;
    if (is_near) places.push_back(estimates[0].world_from_tag.translation);
  }
  double farthest = 0.0;
  for (const Eigen::Vector3d& one : places) {
    for (const Eigen::Vector3d& other : places) farthest = std::max(farthest, (one - other).norm());
  }
  return farthest;
}

}  // namespace

std::map<TagId, UnitEstimate> units_by_tags(const MapGraph& map, std::span<const Tag> tags) {
  std::map<TagId, UnitEstimate> units;
  for (const auto& [id, views] : views_of_tags(map, tags)) {
    const auto unit = estimate_unit(views, size_of(id, tags));
    if (unit) units.emplace(id, *unit);
  }
  return units;
}

std::optional<UnitEstimate> common_unit(const std::map<TagId, UnitEstimate>& units) {
  std::vector<UnitEstimate> best;  // agree with one of them
  for (const auto& [id, unit] : units) {
    std::vector<UnitEstimate> agreeing;
    for (const auto& [other_id, other] : units) {
      if (!differ(other, unit)) agreeing.push_back(other);
    }
    if (agreeing.size() > best.size()) best = std::move(agreeing);
  }
  if (best.size() < 2 || 2 * best.size() <= units.size()) return std::nullopt;
  return mean_of(best);
}

TagMapping map_tags(const MapGraph& map, std::span<const Tag> tags) {
  constexpr double kLeastShare = 0.8;  // share of the views that agree with the pose
  constexpr double kFarApart = 1.0;    // metres, far more than errors of places by near views
  TagMapping mapping;
  const auto leave_out = [&mapping](const TagId& id, const std::string& fault, const std::string& remedy) {
    mapping.warnings.push_back(
        {MotionSensor::tags, {}, to_string(id) + " " + fault + "; the map leaves it out", remedy});
  };
  for (const auto& [id, views] : views_of_tags(map, tags)) {
    const double size = size_of(id, tags);
    const auto unit = estimate_unit(views, size);
    if (unit && differ(*unit, {})) {
      leave_out(id, fmt::format("measures {:.3g} m in the map instead of {:g} m", size * unit->lengths_per_metre, size),
                "correct its size in the file of tags, and map again");
      continue;
    }
    const std::vector<TagEstimate> estimates = estimate_tag_pose(views, size);
    const auto agreeing = estimates.empty() ? 0 : estimates[0].views;
    const double apart = distance_between_places(views, size);
    if (agreeing < kLeastShare * static_cast<double>(views.size()) || apart > kFarApart) {
      leave_out(id, fmt::format("is seen at places {:.3g} m apart", apart),
                "remove tags with the same number, or one that moves, and map again");
      continue;
    }
    if (!unit || estimates.size() != 1) continue;
    const double variance = position_variance(estimates[0].covariance) / 3.0;
    mapping.tags.push_back({id, size, estimates[0].world_from_tag, std::sqrt(variance)});
  }
  return mapping;
}

void write_tags(std::span<const MappedTag> tags, std::map<std::string, std::string>& notes) {
  for (const MappedTag& tag : tags) {
    const Eigen::Quaterniond& rotation = tag.map_from_tag.rotation;
    NumbersByName numbers;
    numbers.add("size_m", tag.size);
    numbers.add("map_from_tag_wxyz", std::array{rotation.w(), rotation.x(), rotation.y(), rotation.z()});
    numbers.add("position_m", std::span(tag.map_from_tag.translation.data(), 3));
    numbers.add("sigma_m", tag.sigma);
    notes[std::string(kPrefix) + to_string(tag.id)] = numbers.text();
  }
}

std::vector<MappedTag> stored_tags(const std::map<std::string, std::string>& notes) {
  std::vector<MappedTag> tags;
  for (const auto& [key, note] : notes) {
    const auto id = id_of_note(key);
    const auto tag = id ? tag_of_note(*id, note) : std::nullopt;
    if (tag) tags.push_back(*tag);
  }
  std::ranges::sort(tags, {}, &MappedTag::id);
  return tags;
}

std::vector<MappedTag> moved(std::vector<MappedTag> tags, const Similarity& target_from_map) {
  const auto& [scale, pose] = target_from_map;
  for (MappedTag& tag : tags) {
    tag.size *= scale;
    tag.sigma *= scale;
    tag.map_from_tag = pose * scale_lengths(tag.map_from_tag, scale);
  }
  return tags;
}

void add_surveyed_tags(StoredMap& stored, std::span<const Tag> tags) {
  const Similarity& plan_from_map = stored.plan.value().plan_from_map;
  const Pose map_from_plan = inverse(plan_from_map.target_from_source);
  const std::vector<MappedTag> known = stored_tags(stored.notes);
  std::vector<MappedTag> on_plan;
  for (const Tag& tag : tags) {
    const bool is_known = std::ranges::find(known, tag.id, &MappedTag::id) != known.end();
    if (is_known || !tag.survey || !tag.survey->heading) continue;
    const double heading = *tag.survey->heading;
    Eigen::Matrix3d axes;  // x, y and z of the tag on the plan
    axes << -std::sin(heading), 0.0, -std::cos(heading), std::cos(heading), 0.0, -std::sin(heading), 0.0, -1.0, 0.0;
    const Pose map_from_tag = map_from_plan * Pose{Eigen::Quaterniond(axes), tag.survey->position};
    on_plan.push_back({tag.id, tag.size, map_from_tag, tag.survey->sigma});
  }
  write_tags(moved(std::move(on_plan), {1.0 / plan_from_map.scale, {}}), stored.notes);
}

}  // namespace byre
