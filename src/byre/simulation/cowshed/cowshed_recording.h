#pragma once

#include "byre/simulation/camera_imperfection.h"
#include "byre/simulation/cowshed/cowshed.h"
#include "byre/simulation/cowshed/cowshed_plan.h"
#include "byre/simulation/cowshed/feeding_robot.h"
#include "byre/simulation/image_sensor.h"
#include "byre/simulation/motion_sensors.h"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace byre {

struct NightOptions {
  double light = 1.0;       // share of the barn's light at day or dusk
  double headlight = 0.0;   // robot's lamp; 1: a wall 3 m ahead as bright as the lit alley at dusk
  double lights_out = 0.0;  // seconds from the start when the barn's light goes out
  double lights_on = 0.0;   // seconds from the start when it comes back on; not after lights_out: it stays on
};

struct CowshedRecordingOptions {
  CowshedOptions barn;
  double duration_s = 40.0;
  TurnKind turn = TurnKind::arc;
  std::optional<double> start{};  // start position on the lap, 0 to 1; empty: near 0, drawn for each later mission
  double frame_rate_hz = 20.0;
  int image_divisor = 1;                           // 1: 752 x 480 pixels
  std::optional<std::array<int, 2>> image_size{};  // width, height in pixels; empty: by the divisor
  double dirt = 0.0;                               // dirt on the lenses: 0 none, 1 a dozen soft spots each
  NightOptions night;
  CameraImperfection camera;
  std::optional<MotionSensorOptions> motion{};  // sensors to record; their seed follows from the barn
  int threads = 0;                              // 0: one per core; does not change the output
};

// Course of the robot. Missions share it but for a shift by a hand's breadth and another start; with an open gate it
// reaches into the feed store.
FeedingCourseOptions course_of(const CowshedRecordingOptions& options);

// A feeding robot's visit to a cowshed, rendered frame by frame. Even missions are at dusk; each course differs
// slightly.
class CowshedRecording {
 public:
  // Builds and lights the barn, which takes a second or two. Throws InputError for options out of range.
  explicit CowshedRecording(const CowshedRecordingOptions& options);
  ~CowshedRecording();

  const Calibration& calibration() const;
  const Calibration& nominal_calibration()
      const;  // calibration written to the recording, with the error of the options
  const Cowshed& barn() const;
  const std::vector<Timestamp>& times() const;

  // Whether the written calibration equals the true one.
  bool is_calibration_exact() const { return options_.camera.calibration_level == 0.0; }

  // world_from_body at 200 Hz and at each frame.
  Trajectory truth() const;
  Pose world_from_body(Timestamp time) const;

  // Samples of wheels, gyroscope and accelerometer; empty when not recorded.
  std::optional<MotionSamples> motion() const;

  // Renders the next frame. Frames are sequential because automatic exposure depends on the previous one. Precondition:
  // a frame remains.
  ImageFrame render_next();

  // Depth along the optical axis at each pixel centre of the left camera, at the exposure time of its row; row-major,
  // metres.
  std::vector<float> left_depths(Timestamp time) const;

  // The best observation of each landmark that the left camera sees: large, unoccluded and away from the image border.
  std::vector<MarkSighting> sightings() const;

 private:
  struct Scene;

  struct RobotCamera;

  double seconds_since_start(Timestamp time) const { return to_seconds(time - times_.front()); }
  double row_offset(double row) const;
  Illumination illumination_at(double time_s) const;
  SceneView view_at(const RobotCamera& camera, double time_s) const;
  LitMesh moving_at(double time_s) const;
  double motion_during_exposure(double time_s) const;
  std::array<std::vector<float>, 2> exposed_radiance(double middle_s) const;
  std::optional<MarkSighting> sighting_at(const NamedPoint& mark, Timestamp time) const;
  std::optional<MarkSighting> best_sighting(const NamedPoint& mark) const;

  CowshedRecordingOptions options_;
  std::uint64_t noise_seed_;
  FeedingCourse course_;
  std::vector<Timestamp> times_;
  std::unique_ptr<const Scene> scene_;
  Exposure exposure_;
  std::size_t next_ = 0;
};

// Renders a whole visit into a folder: an EuRoC recording, and plan/ with the floor plan and points for registration.
// Calls should_continue after each frame and stops when it returns false; the remaining images are then missing. Throws
// InputError when a file cannot be written. Precondition: no frame has been rendered yet.
void write_cowshed_recording(CowshedRecording& recording, const std::filesystem::path& folder,
                             const std::function<bool(int frames_done)>& should_continue);

}  // namespace byre
