#include "byre/playback/report/inspection_report.h"

#include "byre/base/enum_names.h"
#include "byre/odometry/odometry_calibration.h"
#include "byre/playback/archive/register_map.h"
#include "byre/playback/report/calibration_report.h"

#include <string_view>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

std::string size_text(std::size_t bytes) {
  constexpr double kKilobyte = 1e3;
  constexpr double kMegabyte = 1e6;
  const auto size = static_cast<double>(bytes);
  if (size < kKilobyte) return fmt::format("{} B", bytes);
  return size < kMegabyte ? fmt::format("{:.1f} kB", size / kKilobyte) : fmt::format("{:.1f} MB", size / kMegabyte);
}

std::string_view name_of(MapScale scale) {
  return scale == MapScale::metric ? "metric" : "unknown";
}

std::string_view name_of(PoseSource source) {
  return name_among<PoseSource::imported>({"slam", "given", "imported"}, source);
}

std::string_view describe(PoseSource source) {
  return name_among<PoseSource::imported>(
      {"byre's own tracking and mapping", "a given trajectory", "an imported model"}, source);
}

Json distribution_json(const Distribution& values) {
  if (values.count == 0) return nullptr;
  return {{"count", values.count}, {"mean", values.mean}, {"p50", values.p50},
          {"p95", values.p95},     {"p99", values.p99},   {"max", values.max}};
}

// figures: null without values.
void add_distribution(const char* label, Json figures, const char* unit, Report& report) {
  figures["unit"] = unit;
  report.detail(
      label,
      "[mean {mean:.2f}{unit}, median {p50:.2f}, 95 % below {p95:.2f}, 99 % below {p99:.2f}, max {max:.2f}|none]",
      figures);
}

// Sizes in bytes by name; as text for the report's text.
Json sizes_json(const std::vector<SectionSize>& sizes, bool as_text = false) {
  Json json = Json::object();
  for (const SectionSize& size : sizes) json[size.name] = as_text ? Json(size_text(size.bytes)) : Json(size.bytes);
  return json;
}

Json box_json(const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return nullptr;
  return {{"min", list_json(box.min())}, {"max", list_json(box.max())}};
}

Json recording_json(const SourceRecording& recording, int keyframes, const std::string& camera) {
  return {{"name", recording.name},
          {"keyframes", keyframes},
          {"first_time_ns", recording.first_time.count()},
          {"last_time_ns", recording.last_time.count()},
          {"camera", camera},
          {"stereo", recording.calibration.right.has_value()},
          {"refined_calibration", recording.refined ? calibration_json(*recording.refined) : Json()}};
}

void add_recordings(const StoredMap& stored, const MapInspection& inspection, Report& report) {
  for (std::size_t i = 0; i < stored.recordings.size(); ++i) {
    const SourceRecording& recording = stored.recordings[i];
    Json figures =
        recording_json(recording, inspection.counts.keyframes_of_recordings[i], inspection.cameras_of_recordings[i]);
    report.figures["recordings"].push_back(figures);
    figures["duration_s"] = to_seconds(recording.last_time - recording.first_time);
    figures["last_time_s"] = to_seconds(recording.last_time);
    report.row("recording",
               "{name}, {duration_s:.1f} s, last frame at {last_time_s:.3f} s, {keyframes} keyframes, {camera}",
               figures);
    if (recording.refined) add_calibration(*recording.refined, report);
  }
}

void add_notes(const StoredMap& stored, Report& report) {
  const OdometryCalibration extrinsics = read_odometry_calibration(stored.notes);
  for (const auto& [key, note] : stored.notes) {
    const bool is_mounting = (key == "wheels" && extrinsics.wheels) || (key == "gyroscope" && extrinsics.gyroscope);
    report.row(key, "{note}", {{"note", is_mounting ? "extrinsics stored, initial values of missions" : note}});
  }
}

void add_box(const Eigen::AlignedBox3d& box, Json more, Report& report) {
  if (!box.isEmpty()) more["size"] = list_json(box.sizes());
  report.row("extent",
             "[{size.0:.1f} x {size.1:.1f} x {size.2:.1f} {unit}: "
             "x {bounding_box.min.0:.1f} to {bounding_box.max.0:.1f}, "
             "y {bounding_box.min.1:.1f} to {bounding_box.max.1:.1f}, "
             "z {bounding_box.min.2:.1f} to {bounding_box.max.2:.1f}|none]",
             more);
}

void add_sizes(const InspectedFile& file, const MapInspection& inspection, Report& report) {
  const int keyframes = inspection.counts.keyframes;
  Json per_keyframe;
  if (keyframes > 0) per_keyframe = 1e-3 * static_cast<double>(file.bytes) / keyframes;
  report.row("file", "{size}[, {kilobytes_per_keyframe:.1f} kB per keyframe]",
             {{"size", size_text(file.bytes)}, {"kilobytes_per_keyframe", per_keyframe}});
  report.detail("sections", "{sizes}", {{"sizes", sizes_json(file.sections, true)}});
  std::size_t memory = 0;
  for (const SectionSize& part : inspection.memory) memory += part.bytes;
  report.row("memory", "about {size}", {{"size", size_text(memory)}});
  report.detail("memory", "{sizes}", {{"sizes", sizes_json(inspection.memory, true)}});
}

void conclude(const StoredMap& stored, Report& report) {
  report.conclude(
      "[{?faults}The map is damaged. Use a copy, or make the map again."
      "|Ready for missions[{?is_unscaled}, of arbitrary scale (\"byre scale\" sets it)]. Next: byre run RECORDING "
      "--map "
      "{file.name}[{?is_on_plan}, whose poses are on the plan"
      "|, or byre register {file.name} --plan PLAN.yaml --points PICKS.csv -o MAP.byre]]",
      {{"is_unscaled", stored.scale == MapScale::unknown}, {"is_on_plan", stored.plan.has_value()}});
}

}  // namespace

std::string next_step_with(const StoredMap& stored, const std::string& file_name) {
  Report report{{{"file", {{"name", file_name}}}, {"faults", find_faults(stored)}}};
  conclude(stored, report);
  return report.conclusion;
}

Report inspection_report(const StoredMap& stored, const MapInspection& inspection, const InspectedFile& file) {
  const MapCounts& counts = inspection.counts;
  const Json unit = {{"unit", stored.scale == MapScale::metric ? "m" : "units"}};
  Report report{
      {{"file", {{"name", file.name}, {"bytes", file.bytes}, {"section_bytes", sizes_json(file.sections)}}},
       {"scale", name_of(stored.scale)},
       {"pose_source", name_of(stored.pose_source)},
       {"recordings", Json::array()},
       {"notes", stored.notes},
       {"plan", stored.plan ? registration_json(*stored.plan) : Json()},
       {"vocabulary_checksum", fmt::format("{:016x}", static_cast<unsigned long long>(stored.vocabulary_checksum))},
       {"counts",
        {{"keyframes", counts.keyframes},
         {"keyframes_with_words", counts.keyframes_with_words},
         {"keyframes_with_picture", counts.keyframes_with_picture},
         {"picture_bytes", counts.picture_bytes},
         {"points", counts.points},
         {"features", counts.features},
         {"observations", counts.observations},
         {"patches", counts.patches}}},
       {"observations_per_point", distribution_json(inspection.observations_per_point)},
       {"reprojection_error",
        {{"pixel_px", distribution_json(inspection.errors.pixel)},
         {"disparity_px", distribution_json(inspection.errors.disparity)},
         {"observations_behind_camera", inspection.errors.behind_camera}}},
       {"bounding_box", box_json(inspection.points_in_world)},
       {"path_length", inspection.path_length},
       {"memory_bytes", sizes_json(inspection.memory)},
       {"faults", inspection.faults}}};
  report.label_width = 14;
  report.row("map", "{file.name}");
  report.row("poses", "{source}", {{"source", describe(stored.pose_source)}});
  report.row("scale", "{scale}");
  add_recordings(stored, inspection, report);
  add_notes(stored, report);
  if (stored.plan) report.row("plan", "{origin}", {{"origin", describe_origin(*stored.plan)}});
  report.row("keyframes", "{counts.keyframes}, with {counts.features} features, {counts.patches} with a patch");
  report.row("pictures", "[{?counts.keyframes_with_picture}of {counts.keyframes_with_picture} keyframes, {size}|none]",
             {{"size", size_text(counts.picture_bytes)}});
  report.row("points", "{counts.points}, with {counts.observations} observations");
  add_distribution("seen by", report.figures["observations_per_point"], " keyframes", report);
  report.detail("words",
                "[{?counts.keyframes_with_words}of {counts.keyframes_with_words} keyframes, "
                "vocabulary {vocabulary_checksum}|none]");
  add_distribution("pixel error", report.figures["reprojection_error"]["pixel_px"], " px", report);
  add_distribution("disparity", report.figures["reprojection_error"]["disparity_px"], " px", report);
  report.row("behind camera",
             "{?reprojection_error.observations_behind_camera}{reprojection_error.observations_behind_camera} "
             "observations");
  add_box(inspection.points_in_world, unit, report);
  report.row("path", "{path_length:.2f} {unit}", unit);
  add_sizes(file, inspection, report);
  report.row("faults", "{!faults}none");
  for (const std::string& fault : inspection.faults) report.row("fault", "{fault}", {{"fault", fault}});
  conclude(stored, report);
  return report;
}

}  // namespace byre
