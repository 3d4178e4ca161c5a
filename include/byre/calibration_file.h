#pragma once

#include "byre/calibration.h"
#include "byre/input_error.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// A calibration, and how its files were understood.
struct CalibrationReading {
  Calibration calibration;         // width and height are zero if the files do not have the image size
  std::string format{};            // "Kalibr camchain"
  std::vector<std::string> notes;  // assumptions, and parts of the files that are not used
};

// Several cameras in one file without their relative poses. None is chosen: "FILE#NAME" reads one of them.
class UnplacedCameras : public InputError {
 public:
  UnplacedCameras(const InputError& fault, std::filesystem::path file, std::vector<std::string> names);

  const std::vector<std::string>& names() const { return names_; }
  std::filesystem::path camera(const std::string& name) const;  // FILE#NAME
  // FILE#NAME of the left or right camera: the only one with this word in its name, else the first or second of two.
  // Throws InputError for any other names.
  std::filesystem::path side(bool is_right) const;

 private:
  std::filesystem::path file_;
  std::vector<std::string> names_;
};

// FILE of the path "FILE#NAME", which names a camera in an existing file; any other path unchanged.
std::filesystem::path file_of_camera(const std::filesystem::path& path);

// Reads the calibration of one camera or a stereo pair. The content of the file determines the format:
//   Kalibr camchain, OpenVINS    cam0 and optionally cam1
//   EuRoC sensor.yaml            intrinsics, T_BS
//   ROS camera_info              camera_matrix and the like; also as .ini or ost.txt
//   OpenCV                       camera_matrix; pairs as M1, D1, R, T or K1, D1; also as XML
//   ORB-SLAM2, ORB-SLAM3         Camera.fx, Camera1.fx, LEFT.K
//   stella_vslam                 Camera: fx
//   VINS-Fusion                  model_type, or cam0_calib and body_T_cam0, which name and place such files
//   okvis2, basalt, maplab       cameras, value0, ncameras
//   DepthAI, ZED, KITTI, COLMAP  cameraData, [LEFT_CAM_HD], P0 and P1, a line of cameras.txt
//   other programs               OpenSfM, OpenMVG, Metashape, MATLAB, Middlebury, and any with fx, fy, cx, cy
// Fields of one camera or pair are also found inside other fields.
// right: file of the right camera if each camera has its own; its pose comes from the files' P and R (ROS), T_BS or
// body_T_cam. size: width and height of the images, for files with several sizes (ZED). A folder stands for left.yaml
// and right.yaml, or intrinsics.yml and extrinsics.yml in it. The path "FILE#NAME" reads one of several cameras: NAME
// is its field, "left" or "right" of a pair, or the number in cameras.txt. Optional per camera, read from the first:
// readout_time or Kalibr's line_delay, seconds for all rows or one row. Throws UnplacedCameras for several cameras
// without relative poses, and InputError with the field for an unsupported model and for a missing or invalid value.
CalibrationReading read_calibration_file(const std::filesystem::path& path,
                                         const std::optional<std::filesystem::path>& right = std::nullopt,
                                         std::optional<std::pair<int, int>> size = std::nullopt);

// The calibration of read_calibration_file. Throws InputError also if the files do not have the image size.
Calibration read_calibration(const std::filesystem::path& path,
                             const std::optional<std::filesystem::path>& right = std::nullopt);

// Text of a Kalibr camchain. Reading it back yields the same calibration bit by bit, except for the rounding of
// rotation matrices.
std::string write_calibration(const Calibration& calibration);

// Reads a depth camera from fields of a calibration file, which may also stand alone:
//   depth_scale   units of the depth images per metre; default 5000, as in TUM; also DepthMapFactor (ORB-SLAM)
//   depth_sigma   standard deviation of a depth of one metre, metres; grows with the square of depth
//   depth_camera  only if depth images are not registered to the colour camera: intrinsics in any format for one
//                 camera, and colour_from_depth, the 4x4 matrix of its pose in the colour camera
// Throws InputError with the field for an invalid value.
DepthCamera read_depth_camera(const std::filesystem::path& path);

// Whether the file has any field of a depth camera. Throws InputError if it cannot be read.
bool has_depth_camera_fields(const std::filesystem::path& path);

// Throws InputError with this place if the baseline of the pair is zero, as depth is then unobservable.
void require_baseline(const StereoPartner& partner, const std::string& place);

// Calibration file in a folder: calibration.yaml, camera.yaml or sensor.yaml; the folder itself if it has the files of
// both cameras. Empty if there is none.
std::optional<std::filesystem::path> find_calibration(const std::filesystem::path& folder);

}  // namespace byre
