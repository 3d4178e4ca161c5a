#include "byre/playback/report/inspection_report.h"

#include "byre/base/printable.h"
#include "byre/odometry/odometry_calibration.h"
#include "byre/playback/archive/register_map.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <string_view>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

std::string wide_row(std::string_view name, const std::string& content) {
  return fmt::format("{:14} {}\n", printable(name), printable(content));
}

std::string size_text(std::size_t bytes) {
  constexpr double kKilobyte = 1e3;
  constexpr double kMegabyte = 1e6;
  const auto size = static_cast<double>(bytes);
  if (size < kKilobyte) return fmt::format("{} B", bytes);
  return size < kMegabyte ? fmt::format("{:.1f} kB", size / kKilobyte) : fmt::format("{:.1f} MB", size / kMegabyte);
}

// A map of unknown scale has arbitrary units.
const char* unit_of(const StoredMap& stored) {
  return stored.scale == MapScale::metric ? "m" : "units";
}

std::string_view name_of(MapScale scale) {
  return scale == MapScale::metric ? "metric" : "unknown";
}

std::string_view name_of(PoseSource source) {
  switch (source) {
    case PoseSource::slam:
      return "slam";
    case PoseSource::given:
      return "given";
    case PoseSource::imported:
      return "imported";
  }
  return "";
}

std::string_view describe(PoseSource source) {
  switch (source) {
    case PoseSource::slam:
      return "byre's own tracking and mapping";
    case PoseSource::given:
      return "a given trajectory";
    case PoseSource::imported:
      return "an imported model";
  }
  return "";
}

std::string describe(const Distribution& values, const char* unit) {
  if (values.count == 0) return "none";
  return fmt::format("mean {:.2f}{}, median {:.2f}, 95 % below {:.2f}, 99 % below {:.2f}, max {:.2f}", values.mean,
                     unit, values.p50, values.p95, values.p99, values.max);
}

std::string describe_words(const StoredMap& stored, const MapCounts& counts) {
  if (counts.keyframes_with_words == 0) return "none";
  return fmt::format("of {} keyframes, vocabulary {:016x}", counts.keyframes_with_words,
                     static_cast<unsigned long long>(stored.vocabulary_checksum));
}

std::string describe_box(const std::optional<BoundingBox>& box, const char* unit) {
  if (!box) return "none";
  const Eigen::Vector3d size = box->max - box->min;
  return fmt::format("{:.1f} x {:.1f} x {:.1f} {}: ", size.x(), size.y(), size.z(), unit) +
         fmt::format("x {:.1f} to {:.1f}, y {:.1f} to {:.1f}, z {:.1f} to {:.1f}", box->min.x(), box->max.x(),
                     box->min.y(), box->max.y(), box->min.z(), box->max.z());
}

std::string describe(const SourceRecording& recording, int keyframes, const std::string& camera) {
  return recording.name +
         fmt::format(", {:.1f} s, last frame at {:.3f} s, {} keyframes, ",
                     to_seconds(recording.last_time - recording.first_time), to_seconds(recording.last_time),
                     keyframes) +
         camera;
}

template <typename Size>
std::string sizes_text(const std::vector<Size>& sizes) {
  std::string text;
  for (const Size& size : sizes) text += (text.empty() ? "" : ", ") + size.name + " " + size_text(size.bytes);
  return text;
}

std::size_t sum_of(const std::vector<PartSize>& parts) {
  std::size_t sum = 0;
  for (const PartSize& part : parts) sum += part.bytes;
  return sum;
}

std::string describe_file(const InspectedFile& file, int keyframes) {
  std::string text = size_text(file.bytes);
  if (keyframes > 0) {
    text += fmt::format(", {:.1f} kB per keyframe", 1e-3 * static_cast<double>(file.bytes) / keyframes);
  }
  return text;
}

std::string origin_text(const StoredMap& stored, const MapInspection& inspection) {
  std::string text = wide_row("poses", std::string(describe(stored.pose_source)));
  text += wide_row("scale", std::string(name_of(stored.scale)));
  for (std::size_t i = 0; i < stored.recordings.size(); ++i) {
    text += wide_row("recording", describe(stored.recordings[i], inspection.counts.keyframes_of_recordings[i],
                                           inspection.cameras_of_recordings[i]));
    if (!stored.recordings[i].refined) continue;
    text += wide_row("calibration", describe_calibration(*stored.recordings[i].refined)) +
            calibration_table(*stored.recordings[i].refined);
  }
  const OdometryCalibration extrinsics = read_odometry_calibration(stored.notes);
  for (const auto& [key, note] : stored.notes) {
    const bool is_mounting = (key == "wheels" && extrinsics.wheels) || (key == "gyroscope" && extrinsics.gyroscope);
    text += wide_row(key, is_mounting ? "extrinsics stored, initial values of missions" : note);
  }
  if (stored.plan) text += wide_row("plan", describe_origin(*stored.plan));
  return text;
}

std::string error_text(const ReprojectionErrors& errors) {
  std::string text = wide_row("pixel error", describe(errors.pixel, " px"));
  text += wide_row("disparity", describe(errors.disparity, " px"));
  if (errors.behind_camera > 0) text += wide_row("behind camera", fmt::format("{} observations", errors.behind_camera));
  return text;
}

std::string fault_text(const std::vector<std::string>& faults) {
  if (faults.empty()) return wide_row("faults", "none");
  std::string text;
  for (const std::string& fault : faults) text += wide_row("fault", fault);
  return text;
}

Json to_json(const Distribution& values) {
  if (values.count == 0) return nullptr;
  return {{"count", values.count}, {"mean", values.mean}, {"p50", values.p50},
          {"p95", values.p95},     {"p99", values.p99},   {"max", values.max}};
}

Json to_json(const MapCounts& counts) {
  return {{"keyframes", counts.keyframes},
          {"keyframes_with_words", counts.keyframes_with_words},
          {"points", counts.points},
          {"features", counts.features},
          {"observations", counts.observations},
          {"patches", counts.patches}};
}

Json box_json(const std::optional<BoundingBox>& box) {
  if (!box) return nullptr;
  return {{"min", {box->min.x(), box->min.y(), box->min.z()}}, {"max", {box->max.x(), box->max.y(), box->max.z()}}};
}

Json to_json(const SourceRecording& recording, int keyframes, const std::string& camera) {
  return {{"name", recording.name},
          {"keyframes", keyframes},
          {"first_time_ns", recording.first_time.count()},
          {"last_time_ns", recording.last_time.count()},
          {"camera", camera},
          {"stereo", recording.calibration.right.has_value()},
          {"refined_calibration", recording.refined ? calibration_json(*recording.refined) : Json()}};
}

template <typename Size>
Json sizes_json(const std::vector<Size>& sizes) {
  Json json = Json::object();
  for (const Size& size : sizes) json[size.name] = size.bytes;
  return json;
}

Json recordings_json(const std::vector<SourceRecording>& recordings, const MapInspection& inspection) {
  Json json = Json::array();
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    json.push_back(
        to_json(recordings[i], inspection.counts.keyframes_of_recordings[i], inspection.cameras_of_recordings[i]));
  }
  return json;
}

Json file_json(const InspectedFile& file) {
  return {{"name", file.name}, {"bytes", file.bytes}, {"section_bytes", sizes_json(file.sections)}};
}

Json errors_json(const ReprojectionErrors& errors) {
  return {{"pixel_px", to_json(errors.pixel)},
          {"disparity_px", to_json(errors.disparity)},
          {"observations_behind_camera", errors.behind_camera}};
}

}  // namespace

std::string to_text(const StoredMap& stored, const MapInspection& inspection, const InspectedFile& file) {
  const MapCounts& counts = inspection.counts;
  const char* const unit = unit_of(stored);
  std::string text = wide_row("map", file.name) + origin_text(stored, inspection);
  text += wide_row("keyframes", fmt::format("{}, with {} features, {} with a patch", counts.keyframes, counts.features,
                                            counts.patches));
  text += wide_row("points", fmt::format("{}, with {} observations", counts.points, counts.observations));
  text += wide_row("seen by", describe(inspection.observations_per_point, " keyframes"));
  text += wide_row("words", describe_words(stored, counts));
  text += error_text(inspection.errors);
  text += wide_row("extent", describe_box(inspection.points_in_world, unit));
  text += wide_row("path", fmt::format("{:.2f} {}", inspection.path_length, unit));
  text += wide_row("file", describe_file(file, counts.keyframes));
  text += wide_row("", sizes_text(file.sections));
  text += wide_row("memory", "about " + size_text(sum_of(inspection.memory)));
  text += wide_row("", sizes_text(inspection.memory));
  return text + fault_text(inspection.faults);
}

std::string to_json(const StoredMap& stored, const MapInspection& inspection, const InspectedFile& file) {
  const Json json = {
      {"file", file_json(file)},
      {"scale", name_of(stored.scale)},
      {"pose_source", name_of(stored.pose_source)},
      {"recordings", recordings_json(stored.recordings, inspection)},
      {"notes", stored.notes},
      {"plan", stored.plan ? registration_json(*stored.plan) : Json()},
      {"vocabulary_checksum", fmt::format("{:016x}", static_cast<unsigned long long>(stored.vocabulary_checksum))},
      {"counts", to_json(inspection.counts)},
      {"observations_per_point", to_json(inspection.observations_per_point)},
      {"reprojection_error", errors_json(inspection.errors)},
      {"bounding_box", box_json(inspection.points_in_world)},
      {"path_length", inspection.path_length},
      {"memory_bytes", sizes_json(inspection.memory)},
      {"faults", inspection.faults}};
  return dump_json(json, 2) + "\n";
}

}  // namespace byre
