#pragma once

#include "byre/body_motion.h"
#include "byre/calibration.h"
#include "byre/image.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

//   euroc   mav0/cam0, and mav0/cam1 for stereo
//   kitti   a sequence of KITTI odometry: calib.txt, times.txt, image_0, and image_1 for stereo
//   tum     rgb.txt of a TUM RGB-D folder, and depth.txt for depth
//   images  image files in a folder, or for stereo in its folders left and right
//   video   a video file
//   bag     what ROS records: a folder of rosbag2, an .mcap, .db3 or .bag file
enum class RecordingFormat : std::uint8_t { euroc, kitti, tum, images, video, bag };

std::string_view to_string(RecordingFormat format);

// Which of a recording's cameras to use: both of a pair, one of them alone, or the left one with the depth camera.
enum class CameraChoice : std::uint8_t { stereo, left, right, rgbd };

std::string_view to_string(CameraChoice choice);

// Which frames of a recording to read. Both limits apply.
struct FrameRange {
  std::optional<double> start_s{};  // seconds from the first frame of the recording
  std::optional<double> end_s{};    // seconds from the first frame of the recording, exclusive
  int first = 0;                    // frame index, inclusive
  std::optional<int> last{};        // frame index, exclusive
  int stride = 1;                   // every n-th frame within the limits is read
};

// Source of the frame times of a recording.
enum class TimeSource : std::uint8_t {
  stamps,         // the recorded time stamps
  receive_times,  // receive times of a bag's messages, whose stamps are zero or as coarse as whole seconds
  even_spacing    // stamps as coarse as whole seconds, with the images of a stamp spread evenly
};

std::string_view to_string(TimeSource source);

// Step of the clock that stamped the images.
struct ClockStep {
  int frame = 0;   // first frame after the step, counted in the whole recording
  Timestamp by{};  // negative: set back. Frame times are stamps less the sum of the steps so far
};

// Differences between frame times and recorded time stamps. Counts are of the left images of the whole recording.
struct TimeCorrections {
  TimeSource source = TimeSource::stamps;
  std::vector<ClockStep> clock_steps{};
  int late = 0;       // images recorded after later ones; put in order
  int repeated = 0;   // images with the stamp of another image; left out
  int unstamped = 0;  // images with a zero or wrong stamp; timed by their neighbours

  bool any() const { return source != TimeSource::stamps || !clock_steps.empty() || late + repeated + unstamped > 0; }
};

// What a recording does not say of itself, or is to be taken otherwise.
struct OpenOptions {
  std::optional<CameraChoice> camera{};  // empty: both where there are two, with depth where there is depth
  std::optional<std::filesystem::path> calibration{};  // a file read_calibration knows, in place of the recording's own
  std::optional<double> frame_rate_hz{};               // frame rate of images and videos, in place of what they say
  // Topics of a bag's images; empty where it leaves no choice. The left one alone: that camera, or its only pair.
  std::optional<std::string> left_topic{};
  std::optional<std::string> right_topic{};
  std::optional<std::filesystem::path> wheels{};  // file of wheel odometry, in place of wheel.txt in the folder
  bool use_wheels = true;                         // whether wheel.txt is used where it is there
  bool use_gyroscope = false;  // whether imu0 of the folder, or the only sensor_msgs/Imu of a bag is used
  std::optional<std::string> wheels_topic{};  // topic of a bag's wheels, nav_msgs/Odometry or twists; empty: none
  std::optional<std::string> imu_topic{};     // topic of the gyroscope that is used, sensor_msgs/Imu
  std::optional<double> pair_tolerance_s{};   // largest difference between the stamps of a pair, seconds; empty: 0.002
  // Baseline of a stereo pair in metres, replaces that of the calibration. A calibration with a baseline outside 2 mm
  // to 1 m is refused unless it is confirmed here, as extrinsics in centimetres or millimetres are likelier.
  std::optional<double> baseline{};
};

// A recorded sequence of one camera, of one with a depth camera or of a stereo pair, read one frame at a time. Of the
// right camera alone, left image and left calibration are that camera's.
class Recording {
 public:
  virtual ~Recording() = default;

  virtual const Calibration& calibration() const = 0;
  // Time stamps of the frames in range, strictly increasing. A left image without a right partner is in it.
  virtual const std::vector<Timestamp>& times() const = 0;
  // The i-th frame, decoded. Empty, with a warning added, when the left image cannot be read or is of another size than
  // calibrated; without a right image, with a warning added, when that one is absent, unreadable or of another size;
  // likewise without a depth image, but no warning where none was taken.
  // May be called from any thread, but from one at a time.
  virtual std::optional<ImageFrame> read(int index) = 0;
  // What wheels and a gyroscope told meanwhile; none where nothing was recorded or asked for.
  virtual const MotionSamples& motion() const;
  // Differences between times() and the recorded stamps; none for recordings timed by a frame rate. Each correction is
  // among the warnings too.
  virtual const TimeCorrections& time_corrections() const;
  virtual const std::vector<std::string>& warnings() const = 0;  // warnings of opening it first, then of reading

  int size() const { return static_cast<int>(times().size()); }
};

// Tells the format by what the folder or file holds; throws InputError saying what was looked for when it is none.
RecordingFormat guess_format(const std::filesystem::path& path);

// A file that holds a video, by its extension.
bool is_video_file(const std::filesystem::path& path);

// A recording in any of the formats. Images and videos need a calibration: that of the options, or one that
// find_calibration finds in the folder (of a video: beside it). They have the times that their file names say, else
// those of a steady frame rate, 30 Hz with a warning if it is unknown. Bags have their calibration in camera info and
// /tf_static. If a recording has one camera and its calibration is of a pair, the choice of camera selects the one of
// the two. Throws InputError with file and reason for missing files, a calibration that does not parse, is invalid, has
// an absurd baseline (see OpenOptions) or is of another image size, an absent camera, images that all have one time
// stamp, and a range without frames.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path, const FrameRange& range,
                                          const OpenOptions& options = {});

// The cameras that a recording opened so gives.
CameraChoice camera_of(const Recording& recording, const OpenOptions& options);

// The ground truth that came with the recording, where there is one: inside an EuRoC folder, beside the sequences of
// KITTI (../../poses/00.txt for sequences/00), groundtruth.txt in a folder of images.
std::optional<std::filesystem::path> find_ground_truth(const std::filesystem::path& path);

}  // namespace byre
