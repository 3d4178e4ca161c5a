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
//   kitti   sequence of KITTI odometry: calib.txt, times.txt, image_0, and image_1 for stereo
//   tum     TUM RGB-D folder: rgb.txt, and depth.txt for depth
//   images  image files in a folder, or for stereo in its folders left and right
//   video   video file
//   bag     rosbag2 folder, or an .mcap, .db3 or .bag file
enum class RecordingFormat : std::uint8_t { euroc, kitti, tum, images, video, bag };

std::string_view to_string(RecordingFormat format);

// Cameras used of a recording: both of a stereo pair, one of them, or the left one with the depth camera.
enum class CameraChoice : std::uint8_t { stereo, left, right, rgbd };

std::string_view to_string(CameraChoice choice);

// Frames read of a recording. Both limits apply.
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

// Choices that override a recording or complete it.
struct OpenOptions {
  std::optional<CameraChoice> camera{};                // empty: stereo pair if available, with depth if available
  std::optional<std::filesystem::path> calibration{};  // replaces the recording's calibration; see read_calibration
  std::optional<double> frame_rate_hz{};               // replaces the frame rate of images and videos
  // Image topics of a bag; empty: detected, an error if ambiguous. left_topic alone selects that camera, or its pair if
  // there is exactly one.
  std::optional<std::string> left_topic{};
  std::optional<std::string> right_topic{};
  std::optional<std::filesystem::path> wheels{};  // file of wheel odometry, replaces wheel.txt of the folder
  bool use_wheels = true;                         // whether to use wheel.txt of the folder if present
  bool use_gyroscope = false;  // whether to use imu0 of the folder, or the only sensor_msgs/Imu topic of a bag
  std::optional<std::string> wheels_topic{};  // wheel odometry in a bag, nav_msgs/Odometry or twists; empty: not used
  std::optional<std::string> imu_topic{};     // sensor_msgs/Imu topic to use
  std::optional<double> pair_tolerance_s{};   // largest time difference within a stereo pair, seconds; empty: 0.002
  // Baseline of a stereo pair in metres; replaces that of the calibration. A calibrated baseline outside 2 mm to 1 m is
  // rejected unless confirmed here, as extrinsics in centimetres or millimetres are likelier.
  std::optional<double> baseline{};
  std::optional<std::filesystem::path> right_calibration{};  // file of the right camera, if each has its own
  std::optional<std::string> depth_topic{};  // topic of depth images in a bag; empty: detected, see open_recording
};

// Recorded sequence of a camera, a stereo pair, or a camera with a depth camera, read frame by frame. For
// CameraChoice::right, left image and left calibration are those of the right camera.
class Recording {
 public:
  virtual ~Recording() = default;

  virtual const Calibration& calibration() const = 0;
  // Times of the frames in range, strictly increasing, including frames without a right image.
  virtual const std::vector<Timestamp>& times() const = 0;
  // Decodes a frame. Empty if the left image is unreadable or has another size than calibrated; without right or depth
  // image if that is missing, unreadable or of another size. Each fault adds a warning, except a missing depth image.
  // May be called from any thread, but not concurrently.
  virtual std::optional<ImageFrame> read(int index) = 0;
  // Samples of wheels and gyroscope; empty if not recorded or not selected.
  virtual const MotionSamples& motion() const;
  // Differences between times() and the recorded stamps; none for recordings timed by a frame rate. Each also adds a
  // warning.
  virtual const TimeCorrections& time_corrections() const;
  // Warnings of opening, then of reading.
  virtual const std::vector<std::string>& warnings() const = 0;

  int size() const { return static_cast<int>(times().size()); }
};

// Detects the format from the contents of a folder or file. Throws InputError with the patterns searched if there is
// none.
RecordingFormat guess_format(const std::filesystem::path& path);

// Whether the extension is that of a video file.
bool is_video_file(const std::filesystem::path& path);

// Opens a recording of any format.
//   calibration  images and videos: OpenOptions::calibration, else find_calibration() in the folder; bags: camera info
//                and /tf_static. If a pair is calibrated but one camera recorded, OpenOptions::camera selects which
//   depth        TUM folders: depth.txt; bags: the only topic of depth images near the left images in name, registered
//                to them or with camera info of its own
//   times        images and videos: from file names, else a constant frame rate, by default 30 Hz with a warning
// Throws InputError with file and reason for missing files, an unreadable or invalid calibration, an implausible
// baseline (see OpenOptions), a calibration for another image size, an absent camera, images that share one time stamp,
// and a range without frames.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path, const FrameRange& range,
                                          const OpenOptions& options = {});

// Cameras that open_recording selects with these options.
CameraChoice camera_of(const Recording& recording, const OpenOptions& options);

// Ground truth of a recording: inside an EuRoC folder, next to the sequences of KITTI (../../poses/00.txt for
// sequences/00), or groundtruth.txt in a folder of images. Empty if there is none.
std::optional<std::filesystem::path> find_ground_truth(const std::filesystem::path& path);

}  // namespace byre
