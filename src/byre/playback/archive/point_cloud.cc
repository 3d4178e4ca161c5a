#include "byre/playback/archive/point_cloud.h"

#include "byre/base/byte_stream.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace byre {
namespace {

std::string header(int points) {
  return "ply\nformat binary_little_endian 1.0\ncomment points of a byre map\nelement vertex " +
         std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         "property int observations\nend_header\n";
}

void write_colour(std::size_t observations, ByteWriter& writer) {
  constexpr double kRed = 10.0;  // observations
  const double share = std::clamp((static_cast<double>(observations) - 1.0) / (kRed - 1.0), 0.0, 1.0);
  const auto channel = [](double value) { return static_cast<std::uint8_t>(255.0 * value); };
  writer.write(channel(share));
  writer.write(channel(1.0 - std::abs(2.0 * share - 1.0)));
  writer.write(channel(1.0 - share));
}

}  // namespace

std::vector<std::byte> point_cloud(const MapGraph& map) {
  ByteWriter writer;
  writer.write_all<char>(header(map.point_count()));
  for (const PointId id : map.point_ids()) {
    const Eigen::Vector3f position = map.find_point(id)->position_in_world.cast<float>();
    const std::size_t observations = map.observations(id).size();
    writer.write_all<float>({position.data(), 3});
    write_colour(observations, writer);
    writer.write(static_cast<std::int32_t>(observations));
  }
  return writer.bytes();
}

}  // namespace byre
