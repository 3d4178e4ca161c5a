// Data for keeping a map up to date.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_upkeep.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

constexpr float kDueSteps = 16.0f;              // steps of PointRecord::due per sighting
constexpr std::uint32_t kEndOfDue = 1U << 24U;  // limit of steps; smaller numbers are exact in a float
constexpr int kVerdicts = 3;
constexpr std::size_t kPoseRecordBytes = 8 + kPoseBytes + 21 * sizeof(float) + 1 + 5 * sizeof(float);

void write_point(const PointRecord& point, ByteWriter& writer) {
  writer.write_varint(point.expected);
  if (point.expected > 0) {
    writer.write_varint(point.seen);
    writer.write_varint(std::min(static_cast<std::uint32_t>(std::lround(point.due * kDueSteps)), kEndOfDue - 1));
  }
  writer.write_varint(point.elsewhere);
}

PointRecord read_point_record(ByteReader& reader) {
  PointRecord point;
  point.expected = reader.read_varint();
  if (point.expected > 0) {
    point.seen = reader.read_varint();
    const std::uint32_t due = reader.read_varint();
    if (due >= kEndOfDue) reader.fail("has too many expected sightings of a point");
    point.due = static_cast<float>(due) / kDueSteps;
    if (point.seen > point.expected) reader.fail("has more sightings of a point than frames");
  }
  point.elsewhere = reader.read_varint();
  return point;
}

std::array<float, 5> numbers_of(const ImageCondition& image) {
  return {image.brightness, image.contrast, image.clipped, image.sharpness, image.noise};
}

void write_pose_record(const PoseRecord& record, ByteWriter& writer) {
  writer.write(std::int64_t{record.time.count()});
  write_pose(record.map_from_body, writer);
  writer.write_all<float>(record.covariance);
  writer.write(record.verdict);
  writer.write_all<float>(numbers_of(record.image));
}

PoseRecord read_pose_record(ByteReader& reader, std::size_t number) {
  PoseRecord record;
  record.time = Timestamp(reader.read<std::int64_t>());
  record.map_from_body = read_pose(reader);
  require_no_fault(reader, fault_in(record.map_from_body), "pose", number);
  reader.read_all<float>(record.covariance);
  record.verdict = read_enum<std::uint8_t>(reader, kVerdicts);
  std::array<float, 5> image{};
  reader.read_all<float>(image);
  for (const float value : record.covariance) {
    if (!std::isfinite(value)) reader.fail("has a covariance that is not finite");
  }
  for (const float value : image) {
    if (!std::isfinite(value)) reader.fail("has an image condition that is not finite");
  }
  record.image = {image[0], image[1], image[2], image[3], image[4]};
  return record;
}

SessionRecord read_session(ByteReader& reader, std::size_t own_points) {
  SessionRecord session;
  session.map_id = reader.read<std::uint64_t>();
  session.frames = reader.read<std::uint32_t>();
  session.trusted = reader.read<std::uint32_t>();
  if (session.trusted > session.frames) reader.fail("has more trusted frames than frames");
  const std::uint32_t points = reader.read_count(2);
  for (std::uint32_t i = 0; i < points; ++i) session.points.push_back(read_point_record(reader));
  session.copied_points = reader.read<std::uint32_t>();
  if (session.copied_points > own_points) reader.fail("has more copied points than the map has points");
  const std::uint32_t poses = reader.read_count(kPoseRecordBytes);
  for (std::uint32_t i = 0; i < poses; ++i) session.poses.push_back(read_pose_record(reader, i));
  return session;
}

void write_session(const SessionRecord& session, ByteWriter& writer) {
  writer.write(session.map_id);
  writer.write(session.frames);
  writer.write(session.trusted);
  writer.write(static_cast<std::uint32_t>(session.points.size()));
  for (const PointRecord& point : session.points) write_point(point, writer);
  writer.write(session.copied_points);
  writer.write(static_cast<std::uint32_t>(session.poses.size()));
  for (const PoseRecord& record : session.poses) write_pose_record(record, writer);
}

}  // namespace

void write_upkeep(const MapUpkeep& upkeep, ByteWriter& writer) {
  writer.write(static_cast<std::uint32_t>(upkeep.survival.size()));
  writer.write_all<Survival>(upkeep.survival);
  writer.write(static_cast<std::uint8_t>(upkeep.session.has_value()));
  if (upkeep.session) write_session(*upkeep.session, writer);
}

MapUpkeep read_upkeep(ByteReader reader, std::size_t points) {
  MapUpkeep upkeep;
  const std::uint32_t count = reader.read_count(1);
  if (count != 0 && count != points) reader.fail("has a number of points other than in the summary");
  upkeep.survival.resize(count);
  reader.read_all<Survival>(upkeep.survival);
  if (read_bool(reader)) upkeep.session = read_session(reader, points);
  reader.require_end();
  return upkeep;
}

}  // namespace byre
