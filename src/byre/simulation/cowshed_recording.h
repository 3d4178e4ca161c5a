#pragma once

#include "byre/simulation/camera_imperfection.h"
#include "byre/simulation/cowshed.h"
#include "byre/simulation/cowshed_plan.h"
#include "byre/simulation/feeding_robot.h"
#include "byre/simulation/image_sensor.h"
#include "byre/simulation/motion_sensors.h"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace byre {

// Less light than the barn has.
struct NightOptions {
  double light = 1.0;       // share of the light of the barn's day or dusk
  double headlight = 0.0;   // lamp on the robot: 1 lights a wall 3 m ahead as lamps light the alley at dusk
  double lights_out = 0.0;  // seconds from the start when the barn's light goes out
  double lights_on = 0.0;   // seconds from the start when it is on again; not after the former: it stays on
};

struct CowshedRecordingOptions {
  CowshedOptions barn;
  double duration_s = 40.0;
  TurnKind turn = TurnKind::arc;
  double frame_rate_hz = 20.0;
  int image_divisor = 1;                           // 1: 752 x 480 pixels
  std::optional<std::array<int, 2>> image_size{};  // width and height in pixels; empty: by the divisor
  double dirt = 0.0;                               // dirt on the lenses: 0 none, 1 a dozen of soft spots each
  NightOptions night;
  CameraImperfection camera;
  std::optional<MotionSensorOptions> motion{};  // wheels and gyroscope that are recorded too; their seed is the barn's
  int threads = 0;                              // 0: as many as the machine has; changes no byte
};

// Where the robot drives. Missions keep to the same course, a hand's breadth aside and begun elsewhere; where the gate
// is open, it reaches into the feed store.
FeedingCourseOptions course_of(const CowshedRecordingOptions& options);

// A visit of a feeding robot to a cowshed, rendered frame by frame. Even missions find it at dusk, and each drives a
// little differently.
class CowshedRecording {
 public:
  // Builds and lights the barn: takes a second or two. Throws InputError when an option makes no sense.
  explicit CowshedRecording(const CowshedRecordingOptions& options);
  ~CowshedRecording();

  const Calibration& calibration() const;       // calibration of the cameras that see
  const Calibration& told_calibration() const;  // calibration that is told: it errs where the options ask for that
  const Cowshed& barn() const;
  const std::vector<Timestamp>& times() const;

  // Whether what is told of the cameras is true.
  bool is_calibration_exact() const { return options_.camera.calibration_level == 0.0; }

  // world_from_body at 200 Hz, frames included.
  Trajectory truth() const;
  Pose world_from_body(Timestamp time) const;

  // What wheels and a gyroscope tell; empty where none are recorded.
  std::optional<MotionSamples> motion() const;

  // The frame after the last one rendered: frames follow one another, as automatic exposure learns from each.
  // Precondition: there is one.
  ImageFrame render_next();

  // Depth along the left camera's axis at each pixel centre, at the instant of its row, row-major, metres.
  std::vector<float> left_depths(Timestamp time) const;

  // For each mark that the left camera sees unhidden, the frame that sees it best: large, and not at the rim.
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
  Exposure exposure_;     // exposure of the next frame
  std::size_t next_ = 0;  // index of the next frame
};

// Renders a whole visit into a folder: an EuRoC recording, and plan/ with the floor plan and points to register a map
// on it. Asks go_on after each frame, and stops where that gives false: the rest of the images is missing then. Throws
// InputError when a file cannot be written. Precondition: no frame has been rendered yet.
void write_cowshed_recording(CowshedRecording& recording, const std::filesystem::path& folder,
                             const std::function<bool(int frames_done)>& go_on);

}  // namespace byre
