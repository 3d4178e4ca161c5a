#pragma once

#include "byre/calibration.h"
#include "byre/dataset/restored_times.h"
#include "byre/image.h"
#include "byre/recording.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Where the images of one frame are. A monocular frame, or one whose partner is lost, has no right image; one of a
// camera with depth has no depth image when none was taken with it.
struct FrameFiles {
  Timestamp time{};
  std::filesystem::path left;
  std::optional<std::filesystem::path> right{};
  std::optional<std::filesystem::path> depth{};
};

// A calibration and the places where it says the size of the images, as InputError names them.
struct PlacedCalibration {
  Calibration cameras;
  std::string left_size;
  std::string right_size;
  std::string depth_size{};
};

// Place of the calibration in messages: the file that the options name, else the recording.
std::string place_of_calibration(const std::filesystem::path& recording, const OpenOptions& options);

// What a recording of image files consists of, before any image is wanted. The calibration may be of a pair though the
// frames are of one camera, or the other way round; choose_camera settles that.
struct RecordingIndex {
  PlacedCalibration calibration;
  std::vector<FrameFiles> frames;  // strictly increasing in time
  std::vector<std::string> warnings{};
  TimeCorrections corrections{};  // corrections of the left images
  SensorClock clock{};            // clock of the left images
};

// The folder that holds cam0 in an EuRoC recording, given it or the one above; empty when there is none.
std::optional<std::filesystem::path> find_mav_folder(const std::filesystem::path& folder);

// Whether the folder holds image files, or folders left and right that do.
bool holds_images(const std::filesystem::path& folder);

// All throw InputError as open_recording says. Images of two cameras belong together when their time stamps differ by
// the tolerance at most; KITTI's by their number. The right camera is left out where the left one alone is asked for. A
// depth image belongs to the frame nearest in time, within 20 ms.
RecordingIndex index_euroc(const std::filesystem::path& folder, const OpenOptions& options);
RecordingIndex index_kitti(const std::filesystem::path& folder, const OpenOptions& options);
RecordingIndex index_tum(const std::filesystem::path& folder, const OpenOptions& options);
RecordingIndex index_images(const std::filesystem::path& folder, const OpenOptions& options);

// All frames and cameras of a recording of image files. Throws InputError also for a video, which has none.
RecordingIndex index_recording(const std::filesystem::path& path, const OpenOptions& options);

// The calibration of the options, or else the one in the folder. Throws InputError when there is neither.
PlacedCalibration calibration_for(const std::filesystem::path& folder, const OpenOptions& options);

// A depth camera and the place where the size of its images is said, as InputError names it.
struct PlacedDepthCamera {
  DepthCamera camera;
  std::string size;
};

// What is known of the depth camera: by the calibration of the options or, where that says nothing of depth, by the
// folder's depth.yaml, or else by its calibration. Throws InputError as calibration_for and read_depth_camera do.
PlacedDepthCamera depth_camera_for(const std::filesystem::path& folder, const OpenOptions& options);

// The first image that can be decoded; throws InputError naming the folder when there is none.
Image first_readable(const std::vector<std::filesystem::path>& files);

inline constexpr double kAssumedFrameRate = 30.0;  // Hz, where nothing says which

}  // namespace byre
