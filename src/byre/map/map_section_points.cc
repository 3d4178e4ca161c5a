// Points, rounded to quanta.

#include "byre/map/map_numbers.h"
#include "byre/map/map_quanta.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <limits>

namespace byre {
namespace {

constexpr std::size_t kCoordinateBytes = 6;
constexpr std::size_t kLeastPointBytes = 3 * kCoordinateBytes + sizeof(CovarianceCode::factor) + 1 +
                                         sizeof(DirectionCode) + sizeof(Descriptor) + 2 * sizeof(std::uint16_t) + 1;

void write_point(const MapPoint& point, std::uint32_t reference, ByteWriter& writer) {
  for (int axis = 0; axis < 3; ++axis) {
    writer.write_low_bytes(double48_code(point.position_in_world[axis]), kCoordinateBytes);
  }
  const CovarianceCode covariance = covariance_code(point.covariance);
  writer.write_all<std::int16_t>(covariance.factor);
  writer.write(covariance.exponent);
  writer.write_all<std::int16_t>(direction_code(point.mean_viewing_direction));
  writer.write_all<std::uint64_t>(point.descriptor);
  const bool is_range = point.min_distance <= point.max_distance;  // rounding might make an invalid range valid
  writer.write(float16_code(is_range ? point.min_distance : std::numeric_limits<float>::quiet_NaN()));
  writer.write(float16_code(point.max_distance));
  writer.write_varint(reference);
}

}  // namespace

void write_points(const MapGraph& map, ByteWriter& writer, PartSizes& sizes) {
  writer.write(static_cast<std::uint32_t>(map.point_count()));
  for (const PointId id : map.point_ids()) {
    const std::size_t begin = writer.size();
    const MapPoint& point = *map.find_point(id);
    const std::vector<Observation>& observations = map.observations(id);
    const auto reference = std::ranges::find(observations, point.reference);
    write_point(point, static_cast<std::uint32_t>(reference - observations.begin()), writer);
    if (id.number % kPointsOfBlock == 0) sizes.points.push_back(0);
    sizes.points.back() += static_cast<std::uint32_t>(writer.size() - begin);
  }
}

RoundedPoints read_points(ByteReader reader, PartSizes& sizes) {
  const std::uint32_t count = reader.read_count(kLeastPointBytes);
  RoundedPoints read;
  read.points.reserve(count);
  read.references.reserve(count);
  for (std::uint32_t first = 0; first < count; first += kPointsOfBlock) {
    const std::size_t before = reader.remaining();
    for (std::uint32_t i = first; i < std::min(first + kPointsOfBlock, count); ++i) {
      read.references.push_back(read_point(reader, i, read.points.emplace_back()));
    }
    sizes.points.push_back(static_cast<std::uint32_t>(before - reader.remaining()));
  }
  reader.require_end();
  return read;
}

std::uint32_t read_point(ByteReader& reader, std::uint32_t number, MapPoint& point) {
  point = {};
  for (int axis = 0; axis < 3; ++axis) {
    point.position_in_world[axis] = double_of_48(reader.read_low_bytes(kCoordinateBytes));
  }
  CovarianceCode covariance;
  reader.read_all<std::int16_t>(covariance.factor);
  covariance.exponent = reader.read<std::int8_t>();
  const std::optional<Eigen::Matrix3d> read = covariance_of(covariance);
  if (!read) require_no_fault(reader, "has an invalid covariance", "point", number);
  point.covariance = *read;
  DirectionCode direction;
  reader.read_all<std::int16_t>(direction);
  point.mean_viewing_direction = direction_of(direction);
  if (direction_code(point.mean_viewing_direction) != direction) {
    require_no_fault(reader, "has a viewing direction that is not of unit length", "point", number);
  }
  reader.read_all<std::uint64_t>(point.descriptor);
  point.min_distance = float_of_16(reader.read<std::uint16_t>());
  point.max_distance = float_of_16(reader.read<std::uint16_t>());
  require_no_fault(reader, fault_in(point), "point", number);
  return reader.read_varint();
}

}  // namespace byre
