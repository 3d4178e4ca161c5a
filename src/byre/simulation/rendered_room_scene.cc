#include "byre/simulation/rendered_room_scene.h"

#include "byre/input_error.h"
#include "byre/simulation/euroc_writer.h"
#include "byre/simulation/pixel_rays.h"
#include "byre/simulation/surface_texture.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <random>

namespace byre {
namespace {

constexpr int kSamplesPerSide = 2;  // samples per pixel side, for antialiasing

void check(const RenderedRoomOptions& options) {
  const bool has_size = options.room_size.allFinite() && options.room_size.minCoeff() > 0.0;
  if (!has_size) throw InputError("rendered room", "the size must be positive in all three directions");
  if (options.boxes < 0) throw InputError("rendered room", "the number of boxes must not be negative");
  if (!(options.noise_sigma >= 0.0)) throw InputError("rendered room", "the noise must not be negative");
}

// Hit of a ray that starts inside a box, on its exit side.
SurfaceHit leave_box(const Eigen::Array3f& near, const Eigen::Array3f& far, const Eigen::Vector3f& direction) {
  SurfaceHit hit;
  hit.distance = near.max(far).minCoeff(&hit.axis);
  hit.is_upper = direction[hit.axis] > 0.0f;
  return hit;
}

// Hit of a ray that starts outside a box; empty when it misses.
std::optional<SurfaceHit> enter_box(const Eigen::Array3f& near, const Eigen::Array3f& far,
                                    const Eigen::Vector3f& direction) {
  SurfaceHit hit;
  hit.distance = near.min(far).maxCoeff(&hit.axis);
  if (hit.distance <= 0.0f || hit.distance > near.max(far).minCoeff()) return std::nullopt;
  hit.is_upper = direction[hit.axis] < 0.0f;
  return hit;
}

// Approximately normal: the sum of four uniform numbers (Irwin-Hall), without tables or branches.
float noise_from(std::uint64_t bits, float sigma) {
  // Standard deviation of the sum of four uniform 16-bit numbers.
  constexpr float kUniformSigma = 65536.0f * 0.5773503f;
  const std::uint64_t sum = (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
  return sigma / kUniformSigma * (static_cast<float>(sum) - 2.0f * 65535.0f);
}

std::uint8_t to_byte(float grey) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0l, 255l));
}

Pose to_pose(const Eigen::Matrix<double, 3, 4>& matrix) {
  return {Eigen::Quaterniond(matrix.leftCols<3>()).normalized(), matrix.col(3)};
}

}  // namespace

RenderedCameras::RenderedCameras(const Calibration& camera_calibration)
    : calibration(camera_calibration), left(camera_calibration.left) {
  if (calibration.right) right.emplace(calibration.right->camera);
}

RenderedRoom::RenderedRoom(const RenderedRoomOptions& options) : options_(options) {
  check(options);
  const Eigen::Vector3f room = 0.5f * options.room_size.cast<float>();
  boxes_.push_back({Eigen::Vector3f::Zero(), room});
  std::mt19937_64 random(options.seed);
  const auto draw = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  for (int i = 0; i < options.boxes; ++i) {
    // Braced initialisation fixes the order of the draws for every compiler.
    const Eigen::Vector3f half_size{draw(0.06f, 0.18f) * room.x(), draw(0.06f, 0.18f) * room.y(),
                                    draw(0.10f, 0.30f) * room.z()};
    const Eigen::Vector3f reach = room - half_size;
    boxes_.push_back({{draw(-reach.x(), reach.x()), draw(-reach.y(), reach.y()), -reach.z()}, half_size});
  }
}

SurfaceHit RenderedRoom::hit(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const {
  const Eigen::Array3f inverse_direction = direction.array().inverse();
  const auto distances_to = [&](const Eigen::Vector3f& corner) -> Eigen::Array3f {
    return (corner - origin).array() * inverse_direction;
  };
  const Box& room = boxes_.front();
  SurfaceHit nearest =
      leave_box(distances_to(room.centre - room.half_size), distances_to(room.centre + room.half_size), direction);
  for (std::size_t i = 1; i < boxes_.size(); ++i) {
    const Box& box = boxes_[i];
    const std::optional<SurfaceHit> entered =
        enter_box(distances_to(box.centre - box.half_size), distances_to(box.centre + box.half_size), direction);
    if (!entered || entered->distance >= nearest.distance) continue;
    nearest = *entered;
    nearest.box = static_cast<int>(i);
  }
  return nearest;
}

float RenderedRoom::pixel_grey(const PixelRays::Corners& corners_in_world, const Eigen::Vector3f& origin) const {
  const float pixel_width = (corners_in_world.top_right - corners_in_world.top_left).norm();
  float sum = 0.0f;
  for (int i = 0; i < kSamplesPerSide * kSamplesPerSide; ++i) {
    const float x = (static_cast<float>(i % kSamplesPerSide) + 0.5f) / kSamplesPerSide;
    const float y = (static_cast<float>(i / kSamplesPerSide) + 0.5f) / kSamplesPerSide;
    const Eigen::Vector3f direction = corners_in_world.at(x, y);
    const SurfaceHit surface = hit(origin, direction);
    const Eigen::Vector3f point = origin + surface.distance * direction;
    // Geometric mean of the footprint in both directions: a slanted surface is foreshortened in one.
    const float slant = std::sqrt(direction.norm() / std::max(std::abs(direction[surface.axis]), 1e-3f));
    const SurfaceSpot spot{point[(surface.axis + 1) % 3], point[(surface.axis + 2) % 3],
                           pixel_width * surface.distance * slant};
    const auto side = static_cast<std::uint64_t>(2 * surface.axis + (surface.is_upper ? 1 : 0));
    sum += surface_grey(hash(options_.seed, static_cast<std::uint64_t>(surface.box), side), spot);
  }
  return sum / (kSamplesPerSide * kSamplesPerSide);
}

Image RenderedRoom::render_camera(const PixelRays& rays, const Pose& world_from_camera,
                                  std::uint64_t noise_seed) const {
  const Eigen::Matrix3f rotation = world_from_camera.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_from_camera.translation.cast<float>();
  const auto noise_sigma = static_cast<float>(options_.noise_sigma);
  Image image{rays.width(), rays.height(), {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width * image.height));
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const auto corners = rays.corners(column, row);
      float grey = 0.0f;
      if (corners) {
        grey = pixel_grey({rotation * corners->top_left, rotation * corners->top_right, rotation * corners->bottom_left,
                           rotation * corners->bottom_right},
                          origin);
      }
      const std::uint64_t bits = hash(noise_seed, static_cast<std::uint64_t>(row), static_cast<std::uint64_t>(column));
      image.pixels.push_back(to_byte(grey + noise_from(bits, noise_sigma)));
    }
  }
  return image;
}

ImageFrame RenderedRoom::render(const RenderedCameras& cameras, const Pose& world_from_body, Timestamp time) const {
  const auto noise_seed = [&](std::uint64_t camera) {
    return hash(options_.seed, static_cast<std::uint64_t>(time.count()), camera);
  };
  const Pose world_from_left = world_from_body * cameras.calibration.body_from_left;
  ImageFrame frame{time, {}, std::nullopt};
  std::future<Image> right;
  if (cameras.right) {
    const Pose world_from_right = world_from_left * inverse(cameras.calibration.right->right_from_left);
    right = std::async(std::launch::async, [&, world_from_right] {
      return render_camera(*cameras.right, world_from_right, noise_seed(1));
    });
  }
  frame.left = render_camera(cameras.left, world_from_left, noise_seed(0));
  if (right.valid()) frame.right = right.get();
  return frame;
}

ImageFrame RenderedRoom::render(const Calibration& calibration, const Pose& world_from_body, Timestamp time) const {
  return render(RenderedCameras(calibration), world_from_body, time);
}

void write_euroc_recording(const RenderedRoom& room, const Calibration& calibration, const Trajectory& truth,
                           const std::filesystem::path& folder,
                           const std::function<void(int done, int total)>& progress) {
  std::vector<Timestamp> times;
  for (const StampedPose& sample : truth) times.push_back(sample.time);
  const EurocWriter writer(calibration, times, truth, folder);
  const RenderedCameras cameras(calibration);
  const int total = static_cast<int>(truth.size());
  for (int i = 0; i < total; ++i) {
    const auto& [time, world_from_body] = truth[static_cast<std::size_t>(i)];
    writer.write(room.render(cameras, world_from_body, time));
    if (progress) progress(i + 1, total);
  }
}

Calibration euroc_like_calibration(int divisor) {
  // sensor.yaml of cam0 and cam1 of the Machine Hall and Vicon Room recordings.
  const Camera left{.model = CameraModel::radial_tangential,
                    .width = 752,
                    .height = 480,
                    .fx = 458.654,
                    .fy = 457.296,
                    .cx = 367.215,
                    .cy = 248.375,
                    .distortion = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0}};
  const Camera right{.model = CameraModel::radial_tangential,
                     .width = 752,
                     .height = 480,
                     .fx = 457.587,
                     .fy = 456.134,
                     .cx = 379.999,
                     .cy = 255.238,
                     .distortion = {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05, 0.0}};
  Eigen::Matrix<double, 3, 4> body_from_left;
  body_from_left << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,                    //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949;
  Eigen::Matrix<double, 3, 4> body_from_right;
  body_from_right << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
      0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,                   //
      -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038;
  return {.left = downscaled_camera(left, divisor),
          .right = StereoPartner{downscaled_camera(right, divisor),
                                 inverse(to_pose(body_from_right)) * to_pose(body_from_left)},
          .body_from_left = to_pose(body_from_left)};
}

}  // namespace byre
