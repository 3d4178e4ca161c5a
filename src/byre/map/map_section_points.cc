// Points in formats 1 to 4.

#include "byre/map/map_numbers.h"
#include "byre/map/map_sections.h"
#include "byre/map/map_values.h"

#include <limits>

namespace byre {
namespace {

constexpr std::size_t kPointBytes = 3 * sizeof(double) + kSymmetricBytes<3> + 3 * sizeof(float) + sizeof(Descriptor) +
                                    2 * sizeof(float) + 2 * sizeof(std::uint32_t);

MapPoint read_point(ByteReader& reader) {
  MapPoint point;
  point.position_in_world = read_vector<Eigen::Vector3d>(reader);
  point.covariance = read_symmetric<3>(reader);
  point.mean_viewing_direction = read_vector<Eigen::Vector3f>(reader);
  reader.read_all<std::uint64_t>(point.descriptor);
  point.min_distance = reader.read<float>();
  point.max_distance = reader.read<float>();
  point.reference.keyframe = {Origin::offline, reader.read<std::uint32_t>()};
  point.reference.feature = static_cast<int>(read_index(reader, std::numeric_limits<int>::max(), "feature"));
  return point;
}

}  // namespace

std::vector<MapPoint> read_points(ByteReader reader) {
  const std::uint32_t count = reader.read_count(kPointBytes);
  std::vector<MapPoint> points;
  points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    points.push_back(read_point(reader));
    require_no_fault(reader, fault_in(points.back()), "point", i);
  }
  reader.require_end();
  return points;
}

}  // namespace byre
