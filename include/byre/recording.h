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

// What the times of a recording's frames are made of.
enum class TimeSource : std::uint8_t {
  stamps,         // the recorded time stamps
  receive_times,  // when a bag's messages were received: their stamps are zero, or as coarse as whole seconds
  even_spacing    // coarse stamps, with the images of one stamp spread evenly
};

std::string_view to_string(TimeSource source);

// The clock that stamped the images was set while they were recorded.
struct ClockStep {
  int frame = 0;   // first frame after it, counted in the whole recording
  Timestamp by{};  // negative: set back. Frame times are continuous: the sum of the steps so far is subtracted
};

// How frame times differ from the recorded time stamps. Counts are of the whole recording, left images.
struct TimeCorrections {
  TimeSource source = TimeSource::stamps;
  std::vector<ClockStep> clock_steps{};
  int late = 0;       // images recorded after later ones: put in order
  int repeated = 0;   // images with the stamp of another: left out
  int unstamped = 0;  // images whose stamp is zero or nonsense: timed by their neighbours

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
  std::optional<double> pair_tolerance_s{};   // most seconds between the stamps of a pair; empty: 0.002
  // Baseline of a stereo pair in metres, in place of the calibration's length. One beyond 1 m is refused unless it is
  // confirmed here: extrinsics in centimetres or millimetres are likelier.
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
  // How times() differs from the recorded stamps; nothing for steady frame rates. Each correction has a warning, too.
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
// those of a steady frame rate, 30 Hz with a warning where nothing says which. Bags tell their calibration in camera
// info and /tf_static. Of a recording of one camera with the
// calibration of a pair, the choice of camera says which of the two that was. Throws InputError, naming the file and
// what is wrong with it: missing files, a calibration that does not parse, makes no sense, has an absurd
// baseline (see OpenOptions) or is of another image size, a camera that is not there, images that all have one
// time stamp, no frame in range.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path, const FrameRange& range,
                                          const OpenOptions& options = {});

// The cameras that a recording opened so gives.
CameraChoice camera_of(const Recording& recording, const OpenOptions& options);

// The ground truth that came with the recording, where there is one: inside an EuRoC folder, beside the sequences of
// KITTI (../../poses/00.txt for sequences/00), groundtruth.txt in a folder of images.
std::optional<std::filesystem::path> find_ground_truth(const std::filesystem::path& path);

}  // namespace byre
