// Provenance of the map: notes, recordings, rigs. Also the summary of its contents.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <bit>
#include <span>

namespace byre {
namespace {

constexpr std::size_t kCameraBytes = 1 + 2 * sizeof(std::int32_t) + 9 * sizeof(double);
constexpr std::size_t kRecordingBytes =
    sizeof(std::uint32_t) + kCameraBytes + 1 + kPoseBytes + 2 * sizeof(std::int64_t);
constexpr std::size_t kRigBytes = 2 * sizeof(std::int32_t) + 4 * sizeof(double) + kPoseBytes;
constexpr std::size_t kShortDistortion = 5;  // coefficients that every model has
constexpr int kMapScales = 2;
constexpr int kPoseSources = 3;

// Coefficients that are stored for a model.
std::size_t stored_distortion(CameraModel model) {
  return model <= CameraModel::equidistant ? kShortDistortion : Camera{}.distortion.size();
}

void write_camera(const Camera& camera, ByteWriter& writer) {
  writer.write(camera.model);
  writer.write(std::int32_t{camera.width});
  writer.write(std::int32_t{camera.height});
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) writer.write(value);
  writer.write_all<double>(std::span(camera.distortion).first(stored_distortion(camera.model)));
}

Camera read_camera(ByteReader& reader) {
  Camera camera;
  camera.model = read_enum<CameraModel>(reader, kCameraModels);
  camera.width = reader.read<std::int32_t>();
  camera.height = reader.read<std::int32_t>();
  for (double* const value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value = reader.read<double>();
  reader.read_all<double>(std::span(camera.distortion).first(stored_distortion(camera.model)));
  return camera;
}

void write_calibration(const Calibration& calibration, ByteWriter& writer) {
  write_camera(calibration.left, writer);
  writer.write(calibration.right.has_value());
  if (calibration.right) {
    write_camera(calibration.right->camera, writer);
    write_pose(calibration.right->right_from_left, writer);
  }
  write_pose(calibration.body_from_left, writer);
}

Calibration read_calibration(ByteReader& reader) {
  Calibration calibration;
  calibration.left = read_camera(reader);
  if (read_bool(reader)) {
    calibration.right.emplace();
    calibration.right->camera = read_camera(reader);
    calibration.right->right_from_left = read_pose(reader);
  }
  calibration.body_from_left = read_pose(reader);
  return calibration;
}

SourceRecording read_recording(ByteReader& reader) {
  SourceRecording recording;
  recording.name = reader.read_text();
  recording.calibration = read_calibration(reader);
  recording.first_time = Timestamp(reader.read<std::int64_t>());
  recording.last_time = Timestamp(reader.read<std::int64_t>());
  return recording;
}

Rig read_rig(ByteReader& reader) {
  Rig rig;
  rig.width = reader.read<std::int32_t>();
  rig.height = reader.read<std::int32_t>();
  for (double* const value : {&rig.focal, &rig.cx, &rig.cy, &rig.baseline}) *value = reader.read<double>();
  rig.body_from_camera = read_pose(reader);
  return rig;
}

}  // namespace

Keyframes keyframes_of(const MapGraph& map) {
  Keyframes keyframes;
  for (const KeyframeId id : map.keyframe_ids()) keyframes.push_back(map.find_keyframe(id));
  return keyframes;
}

MapSummary summarise(const MapGraph& map) {
  MapSummary summary;
  summary.keyframes = static_cast<std::uint64_t>(map.keyframe_count());
  summary.points = static_cast<std::uint64_t>(map.point_count());
  for (const Keyframe* const keyframe : keyframes_of(map)) {
    summary.features += keyframe->sightings.size();
    for (std::size_t i = 0; i < keyframe->sightings.size(); ++i) {
      if (keyframe->sightings[i].point) ++summary.observations;
      if (features_of(*keyframe).find_patch(static_cast<int>(i))) ++summary.patches;
    }
  }
  return summary;
}

void write_summary(const MapSummary& summary, ByteWriter& writer) {
  for (const std::uint64_t count :
       {summary.keyframes, summary.points, summary.features, summary.observations, summary.patches}) {
    writer.write(count);
  }
}

MapSummary read_summary(ByteReader reader) {
  MapSummary summary;
  for (std::uint64_t* const count :
       {&summary.keyframes, &summary.points, &summary.features, &summary.observations, &summary.patches}) {
    *count = reader.read<std::uint64_t>();
  }
  reader.require_end();
  return summary;
}

void write_notes(const std::map<std::string, std::string>& notes, ByteWriter& writer) {
  writer.write(static_cast<std::uint32_t>(notes.size()));
  for (const auto& [key, text] : notes) {
    writer.write_text(key);
    writer.write_text(text);
  }
}

std::map<std::string, std::string> read_notes(ByteReader reader) {
  std::map<std::string, std::string> notes;
  const std::uint32_t count = reader.read_count(2 * sizeof(std::uint32_t));
  for (std::uint32_t i = 0; i < count; ++i) {
    std::string key = reader.read_text();
    if (!notes.empty() && key <= notes.rbegin()->first) reader.fail("has unsorted notes");
    notes.emplace_hint(notes.end(), std::move(key), reader.read_text());
  }
  reader.require_end();
  return notes;
}

void write_provenance(const StoredMap& stored, ByteWriter& writer) {
  writer.write(stored.scale);
  writer.write(stored.pose_source);
  writer.write(static_cast<std::uint32_t>(stored.recordings.size()));
  for (const SourceRecording& recording : stored.recordings) {
    writer.write_text(recording.name);
    write_calibration(recording.calibration, writer);
    writer.write(std::int64_t{recording.first_time.count()});
    writer.write(std::int64_t{recording.last_time.count()});
  }
}

Provenance read_provenance(ByteReader reader) {
  Provenance provenance;
  provenance.scale = read_enum<MapScale>(reader, kMapScales);
  provenance.pose_source = read_enum<PoseSource>(reader, kPoseSources);
  const std::uint32_t count = reader.read_count(kRecordingBytes);
  provenance.recordings.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    provenance.recordings.push_back(read_recording(reader));
    require_no_fault(reader, fault_in(provenance.recordings.back()), "recording", i);
  }
  reader.require_end();
  return provenance;
}

void write_refined_calibrations(const std::vector<SourceRecording>& recordings, ByteWriter& writer) {
  for (const SourceRecording& recording : recordings) {
    writer.write(recording.refined.has_value());
    if (!recording.refined) continue;
    write_calibration(recording.refined->calibration, writer);
    for (const CalibrationVector* const values :
         {&recording.refined->change, &recording.refined->sigma_before, &recording.refined->sigma_after}) {
      for (const double value : *values) writer.write(value);
    }
    writer.write(std::int32_t{recording.refined->keyframes});
    writer.write(std::int32_t{recording.refined->observations});
    writer.write(recording.refined->shift);
  }
}

void read_refined_calibrations(ByteReader reader, std::vector<SourceRecording>& recordings) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (!read_bool(reader)) continue;
    RefinedCalibration refined;
    refined.calibration = read_calibration(reader);
    for (CalibrationVector* const values : {&refined.change, &refined.sigma_before, &refined.sigma_after}) {
      for (double& value : *values) value = reader.read<double>();
    }
    refined.keyframes = reader.read<std::int32_t>();
    refined.observations = reader.read<std::int32_t>();
    refined.shift = reader.read<double>();
    recordings[i].refined = refined;
    require_no_fault(reader, fault_in(recordings[i]), "recording", i);
  }
  if (std::ranges::none_of(recordings,
                           [](const SourceRecording& recording) { return recording.refined.has_value(); })) {
    reader.fail("contains no calibration");
  }
  reader.require_end();
}

void write_readout_times(const std::vector<SourceRecording>& recordings, ByteWriter& writer) {
  for (const SourceRecording& recording : recordings) {
    writer.write(recording.calibration.readout_time);
    writer.write(recording.present_calibration().readout_time);
  }
}

void read_readout_times(ByteReader reader, std::vector<SourceRecording>& recordings) {
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    recordings[i].calibration.readout_time = reader.read<double>();
    const auto refined = reader.read<double>();
    if (recordings[i].refined) {
      recordings[i].refined->calibration.readout_time = refined;
    } else if (std::bit_cast<std::uint64_t>(refined) !=
               std::bit_cast<std::uint64_t>(recordings[i].calibration.readout_time)) {
      reader.fail("has a readout time other than the given calibration");
    }
    require_no_fault(reader, fault_in(recordings[i]), "recording", i);
  }
  reader.require_end();
}

void write_rigs(const std::vector<Rig>& rigs, ByteWriter& writer) {
  writer.write(static_cast<std::uint32_t>(rigs.size()));
  for (const Rig& rig : rigs) {
    writer.write(std::int32_t{rig.width});
    writer.write(std::int32_t{rig.height});
    for (const double value : {rig.focal, rig.cx, rig.cy, rig.baseline}) writer.write(value);
    write_pose(rig.body_from_camera, writer);
  }
}

std::vector<Rig> read_rigs(ByteReader reader) {
  const std::uint32_t count = reader.read_count(kRigBytes);
  std::vector<Rig> rigs;
  rigs.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    rigs.push_back(read_rig(reader));
    require_no_fault(reader, fault_in(rigs.back()), "rig", i);
  }
  reader.require_end();
  return rigs;
}

}  // namespace byre
