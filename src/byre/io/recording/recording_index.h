#pragma once

#include "byre/calibration.h"
#include "byre/image.h"
#include "byre/io/recording/restored_times.h"
#include "byre/recording.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Image files of one frame. A monocular frame, or one without a partner, has no right image; a frame of a depth camera
// may lack its depth image.
struct FrameFiles {
  Timestamp time{};
  std::filesystem::path left;
  std::optional<std::filesystem::path> right{};
  std::optional<std::filesystem::path> depth{};
};

// A calibration, and the places of the image sizes in it for InputError.
struct CalibrationWithSource {
  Calibration cameras;
  std::string left_size;
  std::string right_size;
  std::string depth_size{};
  std::vector<std::string> warnings{};
};

// Place of the calibration in messages: the file that the options name, else the recording.
std::string place_of_calibration(const std::filesystem::path& recording, const OpenOptions& options);

// Contents of a recording of image files. The calibration may be of a pair although frames have one camera, or vice
// versa; choose_camera resolves this.
struct RecordingIndex {
  CalibrationWithSource calibration;
  std::vector<FrameFiles> frames;  // strictly increasing in time
  std::vector<std::string> warnings{};
  TimeCorrections corrections{};  // corrections of the left images
  SensorClock clock{};            // clock of the left images
};

// The folder that contains cam0 of an EuRoC recording: the given one or its subfolder mav0; empty if there is none.
std::optional<std::filesystem::path> find_mav_folder(const std::filesystem::path& folder);

// Whether the folder contains image files, or folders left and right with image files.
bool has_images(const std::filesystem::path& folder);

// All throw InputError like open_recording. Images of two cameras are a pair if their time stamps differ by at most the
// tolerance; KITTI's by their number. The right camera is omitted if only the left one is requested. A depth image
// belongs to the frame nearest in time, within 20 ms.
RecordingIndex index_euroc(const std::filesystem::path& folder, const OpenOptions& options);
RecordingIndex index_kitti(const std::filesystem::path& folder, const OpenOptions& options);
RecordingIndex index_tum(const std::filesystem::path& folder, const OpenOptions& options);
RecordingIndex index_images(const std::filesystem::path& folder, const OpenOptions& options);

// All frames and cameras of a recording of image files. Throws InputError also for a video, which has none.
RecordingIndex index_recording(const std::filesystem::path& path, const OpenOptions& options);

// The calibration of the options, else the one in the folder. Of cameras without relative poses, the left or right one
// that the options choose, with a warning. Throws InputError if there is neither.
CalibrationWithSource calibration_for(const std::filesystem::path& folder, const OpenOptions& options);

// Sets the size of the images where the calibration file does not have it. Throws InputError with the file if the
// principal point is outside.
void complete_size(Camera& camera, int width, int height, const std::string& place);

// A depth camera, and the place of its image size for InputError.
struct DepthCameraWithSource {
  DepthCamera camera;
  std::string size;
};

// The depth camera from the calibration file of calibration_for, or from the folder's depth.yaml if that has none.
// Throws InputError like calibration_for and read_depth_camera.
DepthCameraWithSource depth_camera_for(const std::filesystem::path& folder, const OpenOptions& options);

// The first image that can be decoded. Throws InputError with the folder if there is none.
Image first_readable(const std::vector<std::filesystem::path>& files);

inline constexpr double kAssumedFrameRate = 30.0;  // Hz, if no source specifies one

}  // namespace byre
