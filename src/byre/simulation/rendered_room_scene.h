#pragma once

#include "byre/calibration.h"
#include "byre/image.h"
#include "byre/simulation/pixel_rays.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

namespace byre {

// A room with a few boxes on its floor, covered with a procedural, band-limited texture. Renders small stereo
// recordings with exact truth for tests and benchmarks. World frame: origin at the room's centre, z up. The boxes leave
// the space above the lower third of the room free.
struct RenderedRoomOptions {
  Eigen::Vector3d room_size{8.0, 6.0, 3.0};  // metres
  int boxes = 6;
  double noise_sigma = 2.0;  // grey values
  std::uint64_t seed = 1;
};

// Precomputed rays of a stereo pair or one camera; construct once for many frames.
struct RenderedCameras {
  explicit RenderedCameras(const Calibration& calibration);

  Calibration calibration;
  PixelRays left;
  std::optional<PixelRays> right;
};

// First intersection of a ray with the room.
struct SurfaceHit {
  float distance = 0.0f;  // in lengths of the ray's direction
  int box = 0;            // 0: the room
  int axis = 0;           // world axis perpendicular to the surface
  bool is_upper = false;  // on the positive side of its box
};

class RenderedRoom {
 public:
  // Throws InputError for a room without size or negative options.
  explicit RenderedRoom(const RenderedRoomOptions& options);

  // Deterministic: the same room, calibration, pose and time give the same bytes.
  ImageFrame render(const RenderedCameras& cameras, const Pose& world_from_body, Timestamp time) const;
  ImageFrame render(const Calibration& calibration, const Pose& world_from_body, Timestamp time) const;

  // First hit of a ray in the world frame. Precondition: the origin lies inside the room and outside its boxes.
  SurfaceHit hit(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

 private:
  struct Box {
    Eigen::Vector3f centre;
    Eigen::Vector3f half_size;
  };

  Image render_camera(const PixelRays& rays, const Pose& world_from_camera, std::uint64_t noise_seed) const;
  float pixel_grey(const PixelRays::Corners& corners_in_world, const Eigen::Vector3f& origin) const;

  RenderedRoomOptions options_;
  std::vector<Box> boxes_;  // first the room, seen from inside
};

// Renders a trajectory into an EuRoC ASL folder (mav0/cam0, cam1, state_groundtruth_estimate0). progress may be empty.
// Throws InputError when a file cannot be written.
void write_euroc_recording(const RenderedRoom& room, const Calibration& calibration, const Trajectory& truth,
                           const std::filesystem::path& folder,
                           const std::function<void(int done, int total)>& progress);

// EuRoC's stereo calibration, resolution divided by divisor >= 1.
Calibration euroc_like_calibration(int divisor);

}  // namespace byre
