#include "byre/io/colmap/colmap_model.h"

#include "byre/input_error.h"
#include "byre/io/colmap/colmap_files.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool has_model(const fs::path& folder, const std::string& suffix) {
  return std::ranges::all_of(std::array{"cameras", "images", "points3D"},
                             [&](const std::string& name) { return fs::is_regular_file(folder / (name + suffix)); });
}

std::string image_place(const fs::path& folder, std::uint32_t id) {
  return (folder / "images").string() + ": image " + std::to_string(id);
}

std::string point_place(const fs::path& folder, std::uint64_t id) {
  return (folder / "points3D").string() + ": point " + std::to_string(id);
}

// Rejects names outside the image folder, so that a foreign model cannot access other files.
void require_names_inside(const ColmapModel& model, const fs::path& folder) {
  for (const auto& [id, image] : model.images) {
    const fs::path name = image.name;
    const bool is_inside = !name.empty() && !name.is_absolute() && std::ranges::count(name, fs::path("..")) == 0;
    if (is_inside) continue;
    throw InputError(image_place(folder, id), "has the name \"" + image.name + "\", which is outside the image folder",
                     "use a name relative to that folder");
  }
}

void require_known_camera_and_points(const ColmapModel& model, const fs::path& folder) {
  for (const auto& [id, image] : model.images) {
    if (!model.cameras.contains(image.camera_id)) {
      throw InputError(image_place(folder, id),
                       "refers to camera " + std::to_string(image.camera_id) + ", which is not in the model");
    }
    for (const ColmapKeypoint& keypoint : image.keypoints) {
      if (!keypoint.point_id || model.points.contains(*keypoint.point_id)) continue;
      throw InputError(image_place(folder, id),
                       "refers to point " + std::to_string(*keypoint.point_id) + ", which is not in the model");
    }
  }
}

void require_mutual_tracks(const ColmapModel& model, const fs::path& folder) {
  for (const auto& [id, point] : model.points) {
    for (const ColmapTrackEntry& entry : point.track) {
      const auto image = model.images.find(entry.image_id);
      if (image == model.images.end()) {
        throw InputError(point_place(folder, id),
                         "refers to image " + std::to_string(entry.image_id) + ", which is not in the model");
      }
      const std::vector<ColmapKeypoint>& keypoints = image->second.keypoints;
      if (entry.keypoint >= keypoints.size() || keypoints[entry.keypoint].point_id != id) {
        throw InputError(point_place(folder, id), "refers to keypoint " + std::to_string(entry.keypoint) +
                                                      " of image " + std::to_string(entry.image_id) +
                                                      ", which does not refer back to it");
      }
    }
  }
}

}  // namespace

std::optional<Eigen::Quaterniond> colmap_rotation(double w, double x, double y, double z) {
  const Eigen::Quaterniond rotation(w, x, y, z);
  if (!(std::abs(rotation.norm() - 1.0) < 0.01)) return std::nullopt;
  return rotation.normalized();
}

ColmapModel read_colmap_model(const fs::path& folder) {
  ColmapModel model;
  if (has_model(folder, ".bin")) {
    model = {read_colmap_cameras_binary(folder / "cameras.bin"), read_colmap_images_binary(folder / "images.bin"),
             read_colmap_points_binary(folder / "points3D.bin")};
  } else if (has_model(folder, ".txt")) {
    model = {read_colmap_cameras_text(folder / "cameras.txt"), read_colmap_images_text(folder / "images.txt"),
             read_colmap_points_text(folder / "points3D.txt")};
  } else {
    throw InputError(folder.string(), "contains no COLMAP model",
                     "give the folder with cameras, images and points3D, all .bin or all .txt, such as sparse/0");
  }
  require_names_inside(model, folder);
  require_known_camera_and_points(model, folder);
  require_mutual_tracks(model, folder);
  return model;
}

void write_colmap_model(const ColmapModel& model, const fs::path& folder, ColmapFormat format) {
  format == ColmapFormat::text ? write_colmap_text(model, folder) : write_colmap_binary(model, folder);
}

}  // namespace byre
