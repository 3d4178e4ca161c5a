#include "byre/base/binary_file.h"
#include "byre/base/byte_stream.h"
#include "byre/base/output_file.h"
#include "byre/io/colmap/colmap_camera.h"
#include "byre/io/colmap/colmap_files.h"

#include <cmath>
#include <limits>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kNoPoint = std::numeric_limits<std::uint64_t>::max();

// Reads one entry and its id.
template <typename Id, typename Entry>
using EntryReader = std::pair<Id, Entry> (*)(ByteReader& reader);

std::uint64_t read_count(ByteReader& reader, std::size_t bytes_each) {
  const auto count = reader.read<std::uint64_t>();
  if (count > reader.remaining() / bytes_each) {
    reader.fail("declares " + std::to_string(count) + " entries, more than the " + std::to_string(reader.remaining()) +
                " remaining bytes can hold");
  }
  return count;
}

double read_finite(ByteReader& reader) {
  const auto value = reader.read<double>();
  if (!std::isfinite(value)) reader.fail("contains a value that is not finite");
  return value;
}

Eigen::Vector3d read_vector(ByteReader& reader) {
  const double x = read_finite(reader), y = read_finite(reader), z = read_finite(reader);
  return {x, y, z};
}

std::string read_name(ByteReader& reader) {
  std::string name;
  for (char c = reader.read<char>(); c != '\0'; c = reader.read<char>()) name.push_back(c);
  if (name.empty()) reader.fail("contains an image without a name");
  return name;
}

Pose read_pose(ByteReader& reader) {
  const double w = read_finite(reader), x = read_finite(reader), y = read_finite(reader), z = read_finite(reader);
  const std::optional<Eigen::Quaterniond> rotation = colmap_rotation(w, x, y, z);
  if (!rotation) reader.fail("contains a quaternion that is not of unit length");
  return {*rotation, read_vector(reader)};
}

std::pair<std::uint32_t, ColmapCamera> read_camera(ByteReader& reader) {
  const auto id = reader.read<std::uint32_t>();
  const ColmapCameraModel* const kind = find_colmap_camera_model(reader.read<std::int32_t>());
  if (kind == nullptr) reader.fail("contains a camera of an unknown model");
  ColmapCamera camera;
  camera.model = kind->name;
  camera.width = reader.read<std::uint64_t>();
  camera.height = reader.read<std::uint64_t>();
  for (std::size_t i = 0; i < kind->parameters; ++i) camera.parameters.push_back(read_finite(reader));
  return {id, camera};
}

std::pair<std::uint32_t, ColmapImage> read_binary_image(ByteReader& reader) {
  constexpr std::size_t kKeypointBytes = 24;
  const auto id = reader.read<std::uint32_t>();
  ColmapImage image;
  image.camera_from_world = read_pose(reader);
  image.camera_id = reader.read<std::uint32_t>();
  image.name = read_name(reader);
  image.keypoints.resize(read_count(reader, kKeypointBytes));
  for (ColmapKeypoint& keypoint : image.keypoints) {
    const double u = read_finite(reader), v = read_finite(reader);
    const auto point_id = reader.read<std::uint64_t>();
    keypoint.pixel = {u, v};
    if (point_id != kNoPoint) keypoint.point_id = point_id;
  }
  return {id, std::move(image)};
}

std::pair<std::uint64_t, ColmapPoint> read_point(ByteReader& reader) {
  constexpr std::size_t kTrackEntryBytes = 8;
  const auto id = reader.read<std::uint64_t>();
  ColmapPoint point;
  point.position_in_world = read_vector(reader);
  reader.read_all(std::span<std::uint8_t>(point.colour));
  point.error = read_finite(reader);
  point.track.resize(read_count(reader, kTrackEntryBytes));
  for (ColmapTrackEntry& entry : point.track) {
    entry.image_id = reader.read<std::uint32_t>();
    entry.keypoint = reader.read<std::uint32_t>();
  }
  return {id, std::move(point)};
}

// min_bytes: smallest size of an entry, to reject counts that exceed the file.
template <typename Id, typename Entry>
std::map<Id, Entry> read_entries(const fs::path& path, std::size_t min_bytes, EntryReader<Id, Entry> read_entry) {
  const std::vector<std::byte> bytes = read_file(path);
  ByteReader reader(bytes, path.string(), 0);
  std::map<Id, Entry> entries;
  const std::uint64_t count = read_count(reader, min_bytes);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!entries.insert(read_entry(reader)).second) reader.fail("contains a duplicate id");
  }
  reader.require_end();
  return entries;
}

void write_vector(ByteWriter& writer, const Eigen::Vector3d& vector) {
  for (const double value : vector) writer.write(value);
}

ByteWriter camera_bytes(const ColmapModel& model) {
  ByteWriter writer;
  writer.write(static_cast<std::uint64_t>(model.cameras.size()));
  for (const auto& [id, camera] : model.cameras) {
    writer.write(id);
    writer.write(find_colmap_camera_model(camera.model)->id);
    writer.write(camera.width);
    writer.write(camera.height);
    writer.write_all(std::span<const double>(camera.parameters));
  }
  return writer;
}

ByteWriter image_bytes(const ColmapModel& model) {
  ByteWriter writer;
  writer.write(static_cast<std::uint64_t>(model.images.size()));
  for (const auto& [id, image] : model.images) {
    const Eigen::Quaterniond& rotation = image.camera_from_world.rotation;
    writer.write(id);
    for (const double value : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) writer.write(value);
    write_vector(writer, image.camera_from_world.translation);
    writer.write(image.camera_id);
    writer.write_all(std::span<const char>(image.name.c_str(), image.name.size() + 1));
    writer.write(static_cast<std::uint64_t>(image.keypoints.size()));
    for (const ColmapKeypoint& keypoint : image.keypoints) {
      writer.write(keypoint.pixel.x());
      writer.write(keypoint.pixel.y());
      writer.write(keypoint.point_id.value_or(kNoPoint));
    }
  }
  return writer;
}

ByteWriter point_bytes(const ColmapModel& model) {
  ByteWriter writer;
  writer.write(static_cast<std::uint64_t>(model.points.size()));
  for (const auto& [id, point] : model.points) {
    writer.write(id);
    write_vector(writer, point.position_in_world);
    writer.write_all(std::span<const std::uint8_t>(point.colour));
    writer.write(point.error);
    writer.write(static_cast<std::uint64_t>(point.track.size()));
    for (const ColmapTrackEntry& entry : point.track) {
      writer.write(entry.image_id);
      writer.write(entry.keypoint);
    }
  }
  return writer;
}

}  // namespace

std::map<std::uint32_t, ColmapCamera> read_colmap_cameras_binary(const fs::path& path) {
  return read_entries<std::uint32_t, ColmapCamera>(path, 48, read_camera);
}

std::map<std::uint32_t, ColmapImage> read_colmap_images_binary(const fs::path& path) {
  return read_entries<std::uint32_t, ColmapImage>(path, 74, read_binary_image);
}

std::map<std::uint64_t, ColmapPoint> read_colmap_points_binary(const fs::path& path) {
  return read_entries<std::uint64_t, ColmapPoint>(path, 51, read_point);
}

void write_colmap_binary(const ColmapModel& model, const fs::path& folder) {
  write_atomically(folder / "cameras.bin", camera_bytes(model).bytes());
  write_atomically(folder / "images.bin", image_bytes(model).bytes());
  write_atomically(folder / "points3D.bin", point_bytes(model).bytes());
}

}  // namespace byre
