#include "byre/simulation/cowshed/cowshed_recording.h"

#include "byre/input_error.h"
#include "byre/simulation/euroc_writer.h"
#include "byre/simulation/pixel_rays.h"
#include "byre/simulation/seeded_draws.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <future>
#include <numbers>

namespace byre {
namespace {

constexpr double kIntoStore = 9.0;  // metres added to the course where the gate is open

const CowshedRecordingOptions& checked(const CowshedRecordingOptions& options) {
  const auto require = [](bool holds, const char* reason) {
    if (!holds) throw InputError("simulated cowshed", reason);
  };
  require(options.duration_s > 0.0 && options.duration_s <= 36000.0, "the duration must be from 0 to 36000 seconds");
  require(!options.start || (*options.start >= 0.0 && *options.start <= 1.0), "the start must be from 0 to 1");
  require(options.frame_rate_hz >= 1.0 && options.frame_rate_hz <= 200.0, "the frame rate must be from 1 to 200 Hz");
  require(options.image_divisor >= 1 && options.image_divisor <= 16, "the image divisor must be from 1 to 16");
  require(!options.image_size || std::ranges::all_of(*options.image_size, [](int n) { return n >= 32 && n <= 4096; }),
          "images must be from 32 to 4096 pixels wide and high");
  require(options.dirt >= 0.0 && options.dirt <= 4.0, "dirt must be from 0 to 4");
  require(options.night.light > 0.0 && options.night.light <= 10.0, "the share of light must be from 0 to 10");
  require(options.night.headlight >= 0.0 && options.night.headlight <= 100.0, "the headlight must be from 0 to 100");
  require_valid(options.camera);
  return options;
}

Calibration calibration_of(const CowshedRecordingOptions& options) {
  if (!options.image_size) return feeding_robot_calibration(options.image_divisor);
  Calibration calibration = feeding_robot_calibration(1);
  const auto [width, height] = *options.image_size;
  calibration.left = resized_camera(calibration.left, width, height);
  calibration.right->camera = resized_camera(calibration.right->camera, width, height);
  return calibration;
}

// Frame times. Those of different missions do not overlap.
std::vector<Timestamp> frame_times(const CowshedRecordingOptions& options) {
  const Timestamp start = std::chrono::seconds(100'000) * options.barn.mission;
  std::vector<Timestamp> times;
  for (int i = 0; i / options.frame_rate_hz < options.duration_s; ++i) {
    times.push_back(start + from_seconds(i / options.frame_rate_hz));
  }
  return times;
}

// Instant i of count within an exposure, each with its own sub-pixel offset.
ExposureInstant instant_of(int i, int count) {
  if (count == 1) return {};
  constexpr float kRadius = 0.3f;  // pixels
  const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(count) + 0.4f;
  return {{kRadius * std::cos(angle), kRadius * std::sin(angle)}, false};
}

// Ids of ray geometries.
constexpr unsigned kStill = 0;
constexpr unsigned kMoving = 1;

LitMesh lit(const Cowshed& barn, int threads) {
  const RayScene rays(barn.still, kStill);
  return {barn.still, light_at_vertices(barn.still, rays, barn.light, threads), kStill};
}

}  // namespace

FeedingCourseOptions course_of(const CowshedRecordingOptions& options) {
  FeedingCourseOptions course;
  course.duration_s = options.duration_s;
  course.turn = options.turn;
  if (gate_of(options.barn) == BarnGate::open) {
    course.far_x += kIntoStore;
    course.max_straight += kIntoStore;
  }
  const auto mission = static_cast<std::uint64_t>(options.barn.mission);
  course.seed = hash(options.barn.seed, mission, 3);
  course.start = options.start.value_or(0.0);
  if (options.barn.mission == 1) return course;
  SeededDraws draws(course.seed, 51);
  course.shift_y = draws.between(-0.15f, 0.15f);
  course.lane_distance += draws.between(-0.12f, 0.12f);
  const double drawn_start = draws.between(0.02f, 0.08f);
  course.start = options.start.value_or(drawn_start);
  course.cruise_speed *= draws.between(0.93f, 1.07f);
  return course;
}

struct CowshedRecording::RobotCamera {
  PixelRays pixels;
  ImageSensor sensor;
  Pose body_from_camera;
  double delay_s;  // exposure delay relative to the left camera, seconds
};

// Scene data shared by all frames.
struct CowshedRecording::Scene {
  explicit Scene(const CowshedRecordingOptions& options)
      : barn(build_cowshed(options.barn)),
        textures(draw_barn_textures(options.barn.seed, options.threads)),
        still(lit(barn, options.threads)),
        renderer(still, textures, barn.air, options.threads),
        calibration(calibration_of(options)),
        nominal_calibration(perturbed(calibration, options.camera.calibration_level, options.camera.calibration_seed)) {
    const Pose body_from_right = calibration.body_from_left * inverse(calibration.right->right_from_left);
    add_camera(options, calibration.left, calibration.body_from_left, StereoSide::left);
    add_camera(options, calibration.right->camera, body_from_right, StereoSide::right);
  }

  void add_camera(const CowshedRecordingOptions& options, const Camera& camera, const Pose& body_from_camera,
                  StereoSide side) {
    const bool is_right = side == StereoSide::right;
    ImageSensorOptions sensor{.vignetting = static_cast<float>(options.camera.vignetting),
                              .dirt = static_cast<float>(options.dirt),
                              .blur = lens_blur_of(options.camera, side)};
    sensor.seed = hash(options.barn.seed, static_cast<std::uint64_t>(options.barn.mission), is_right ? 101 : 100);
    if (is_right) {
      sensor.gain = static_cast<float>(options.camera.gain);
      sensor.offset = static_cast<float>(options.camera.offset);
    }
    const double delay_s = is_right ? options.camera.time_offset_s : 0.0;
    cameras.push_back({PixelRays(camera), ImageSensor(camera, sensor), body_from_camera, delay_s});
  }

  const Cowshed barn;
  const BarnTextures textures;
  const LitMesh still;
  const SceneRenderer renderer;
  const Calibration calibration;
  const Calibration nominal_calibration;
  std::vector<RobotCamera> cameras;  // left, right
};

CowshedRecording::CowshedRecording(const CowshedRecordingOptions& options)
    : options_(checked(options)),
      noise_seed_(hash(options.barn.seed, static_cast<std::uint64_t>(options.barn.mission), 4)),
      course_(course_of(options)),
      times_(frame_times(options)),
      scene_(std::make_unique<const Scene>(options)) {}

CowshedRecording::~CowshedRecording() = default;

const Calibration& CowshedRecording::calibration() const {
  return scene_->calibration;
}

const Calibration& CowshedRecording::nominal_calibration() const {
  return scene_->nominal_calibration;
}

const Cowshed& CowshedRecording::barn() const {
  return scene_->barn;
}

const std::vector<Timestamp>& CowshedRecording::times() const {
  return times_;
}

Pose CowshedRecording::world_from_body(Timestamp time) const {
  return course_.world_from_body(seconds_since_start(time));
}

Trajectory CowshedRecording::truth() const {
  constexpr Timestamp kStep = std::chrono::milliseconds(5);
  std::vector<Timestamp> all = times_;
  for (Timestamp time = times_.front(); time < times_.back(); time += kStep) all.push_back(time);
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  Trajectory truth;
  for (const Timestamp time : all) truth.push_back({time, world_from_body(time)});
  return truth;
}

std::optional<MotionSamples> CowshedRecording::motion() const {
  if (!options_.motion) return std::nullopt;
  MotionSensorOptions sensors = *options_.motion;
  sensors.seed = hash(options_.barn.seed, static_cast<std::uint64_t>(options_.barn.mission), 5);
  return simulate_motion(truth(), sensors);
}

// Exposure time of a row relative to the middle row, seconds.
double CowshedRecording::row_offset(double row) const {
  return options_.camera.rolling_shutter_s * ((row + 0.5) / scene_->calibration.left.height - 0.5);
}

Illumination CowshedRecording::illumination_at(double time_s) const {
  constexpr double kMoonlight = 1e-4;     // share of the light that remains without lamps
  constexpr double kFullHeadlight = 1.3;  // radiance times square metres
  const NightOptions& night = options_.night;
  const bool is_out = night.lights_out <= time_s && time_s < night.lights_on;
  return {static_cast<float>(is_out ? kMoonlight : night.light), static_cast<float>(kFullHeadlight * night.headlight)};
}

// View of a camera whose middle row is exposed at time_s, seconds from the start.
SceneView CowshedRecording::view_at(const RobotCamera& camera, double time_s) const {
  SceneView view{camera.pixels, course_.world_from_body(time_s) * camera.body_from_camera, illumination_at(time_s)};
  if (options_.camera.rolling_shutter_s == 0.0) return view;
  for (int row = 0; row < camera.pixels.height(); ++row) {
    view.world_from_camera_by_row.push_back(course_.world_from_body(time_s + row_offset(row)) *
                                            camera.body_from_camera);
  }
  return view;
}

// Moving meshes over the readout, from the first row's exposure to the last row's.
LitMesh CowshedRecording::moving_at(double time_s) const {
  const double until_last = row_offset(scene_->calibration.left.height - 1);
  const QuadMesh begin = cows_at(scene_->barn.cows, time_s - until_last);
  const std::vector<float> light = plain_light_at_vertices(begin, scene_->still.mean_light());
  if (until_last == 0.0) return {begin, light, kMoving, RayScene::Build::quick};
  return {begin, cows_at(scene_->barn.cows, time_s + until_last), light, kMoving, RayScene::Build::quick};
}

// Image motion of an object 1.5 m away during the exposure, pixels.
double CowshedRecording::motion_during_exposure(double time_s) const {
  const double half = 0.5 * static_cast<double>(exposure_.time_s);
  const Pose begin = course_.world_from_body(time_s - half);
  const Pose end = course_.world_from_body(time_s + half);
  const double travelled = (end.translation - begin.translation).norm();
  return scene_->calibration.left.fx * (angle_between(begin.rotation, end.rotation) + travelled / 1.5);
}

// Mean radiance of the left and right image over the exposure.
std::array<std::vector<float>, 2> CowshedRecording::exposed_radiance(double middle_s) const {
  constexpr double kPixelsPerInstant = 1.6;
  constexpr int kMaxInstants = 4;
  const int count = std::min(1 + static_cast<int>(motion_during_exposure(middle_s) / kPixelsPerInstant), kMaxInstants);
  std::array<std::vector<float>, 2> mean;
  for (int i = 0; i < count; ++i) {
    const double instant_s = middle_s + ((i + 0.5) / count - 0.5) * static_cast<double>(exposure_.time_s);
    std::optional<LitMesh> moving;
    for (std::size_t camera = 0; camera < 2; ++camera) {
      const double delay_s = scene_->cameras[camera].delay_s;
      if (!moving || delay_s != 0.0) moving = moving_at(instant_s + delay_s);
      const SceneView view = view_at(scene_->cameras[camera], instant_s + delay_s);
      const std::vector<float> radiance = scene_->renderer.radiance(view, *moving, instant_of(i, count));
      mean[camera].resize(radiance.size(), 0.0f);
      const float share = 1.0f / static_cast<float>(count);
      for (std::size_t k = 0; k < radiance.size(); ++k) mean[camera][k] += share * radiance[k];
    }
  }
  return mean;
}

ImageFrame CowshedRecording::render_next() {
  assert(next_ < times_.size());
  const Timestamp time = times_[next_];
  const std::array<std::vector<float>, 2> radiance = exposed_radiance(seconds_since_start(time));
  const auto image_of = [&](std::size_t camera) {
    const std::uint64_t noise_seed = hash(noise_seed_, static_cast<std::uint64_t>(time.count()), camera);
    Image image = scene_->cameras[camera].sensor.expose(radiance[camera], exposure_, noise_seed, options_.threads);
    return options_.camera.jpeg_quality > 0 ? jpeg_compressed(image, options_.camera.jpeg_quality) : image;
  };
  if (next_ == 0) {  // lets automatic exposure settle, as if the camera had been on before the recording
    constexpr int kFramesToSettle = 12;
    for (int i = 0; i < kFramesToSettle; ++i) exposure_ = next_exposure(exposure_, mean_grey(image_of(0)), {});
  }
  ImageFrame frame{time, image_of(0), image_of(1)};
  exposure_ = next_exposure(exposure_, mean_grey(frame.left), {});
  ++next_;
  return frame;
}

std::vector<float> CowshedRecording::left_depths(Timestamp time) const {
  const double time_s = seconds_since_start(time);
  return scene_->renderer.depths(view_at(scene_->cameras.front(), time_s), moving_at(time_s));
}

// Pixel of a landmark in the left image; empty when occluded, too near, outside or close to the image border.
std::optional<MarkSighting> CowshedRecording::sighting_at(const NamedPoint& mark, Timestamp time) const {
  constexpr double kNearest = 1.0;  // metres
  constexpr double kRim = 0.06;     // share of the image's width
  constexpr int kRounds = 3;        // fixed-point iterations between pixel row and exposure time
  const Camera& camera = scene_->calibration.left;
  Pose world_from_camera;
  std::optional<Eigen::Vector2d> pixel(Eigen::Vector2d(0.0, 0.5 * (camera.height - 1)));
  for (int round = 0; round < kRounds && pixel; ++round) {
    const double time_s = seconds_since_start(time) + row_offset(pixel->y());
    world_from_camera = course_.world_from_body(time_s) * scene_->calibration.body_from_left;
    pixel = camera.project(inverse(world_from_camera) * mark.point_in_world);
  }
  const double depth = (inverse(world_from_camera) * mark.point_in_world).z();
  if (!pixel || depth < kNearest) return std::nullopt;
  const Eigen::Vector2d rim = Eigen::Vector2d::Constant(kRim * camera.width);
  if (!camera.contains(*pixel - rim) || !camera.contains(*pixel + rim)) return std::nullopt;
  const Eigen::Vector3f origin = world_from_camera.translation.cast<float>();
  if (!scene_->still.rays().is_free(origin, mark.point_in_world.cast<float>())) return std::nullopt;
  return MarkSighting{mark.name, time, *pixel};
}

std::optional<MarkSighting> CowshedRecording::best_sighting(const NamedPoint& mark) const {
  constexpr std::size_t kStride = 5;  // frames
  double nearest = 9.0;               // metres; farther landmarks are too small to pick
  std::optional<MarkSighting> best;
  for (std::size_t i = 0; i < times_.size(); i += kStride) {
    const Pose camera_from_world = inverse(world_from_body(times_[i]) * scene_->calibration.body_from_left);
    const double depth = (camera_from_world * mark.point_in_world).z();
    if (depth <= 0.0 || depth >= nearest) continue;
    std::optional<MarkSighting> sighting = sighting_at(mark, times_[i]);
    if (!sighting) continue;
    nearest = depth;
    best = std::move(sighting);
  }
  return best;
}

std::vector<MarkSighting> CowshedRecording::sightings() const {
  std::vector<MarkSighting> sightings;
  for (const NamedPoint& mark : scene_->barn.marks) {
    if (const auto sighting = best_sighting(mark)) sightings.push_back(*sighting);
  }
  return sightings;
}

void write_cowshed_recording(CowshedRecording& recording, const std::filesystem::path& folder,
                             const std::function<bool(int frames_done)>& should_continue) {
  const EurocWriter writer(recording.nominal_calibration(), recording.times(), recording.truth(), folder);
  if (!recording.is_calibration_exact()) write_true_calibration(recording.calibration(), recording.times(), folder);
  if (const auto motion = recording.motion()) write_motion(*motion, folder);
  const Pose world_from_first_body = recording.world_from_body(recording.times().front());
  write_floor_plan(draw_floor_plan(recording.barn().outlines), picks_of(recording.barn().marks, world_from_first_body),
                   recording.sightings(), folder / "plan");
  if (!recording.barn().tags.empty()) write_tags(recording.barn().tags, folder / "plan" / "tags.yaml");
  const int total = static_cast<int>(recording.times().size());
  std::future<void> writing;  // writes the previous frame during rendering
  for (int i = 0; i < total; ++i) {
    ImageFrame frame = recording.render_next();
    if (writing.valid()) writing.get();
    writing = std::async(std::launch::async, [&writer, rendered = std::move(frame)] { writer.write(rendered); });
    if (!should_continue(i + 1)) break;
  }
  if (writing.valid()) writing.get();
}

}  // namespace byre
