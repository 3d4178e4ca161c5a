#pragma once

#include "byre/io/calibration/calibration_formats.h"

#include <array>
#include <initializer_list>
#include <string_view>

namespace byre {

// Readers of one format each, for calibration_formats.cc. path: the file, for those it names.
using FormatReader = CameraList (*)(const CalibrationFields& fields, const std::filesystem::path& path);

CameraList read_orb_slam(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_stella(const CalibrationFields& file, const std::filesystem::path& path);
CameraList read_vins_camera(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_vins_rig(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_camera_list(const CalibrationFields& file, const std::filesystem::path& path);  // okvis, maplab
CameraList read_maplab_camera(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_basalt(const CalibrationFields& file, const std::filesystem::path& path);

// Cameras by 3x3 matrix and list of coefficients, under the names of ROS, OpenCV, MATLAB, Open3D, PhotonVision and the
// programs that copy them; a pair has two of each, whose names begin or end with 1 and 2, left and right, or l and r.
bool has_matrix_camera(const CalibrationFields& fields);
CameraList read_matrix_camera(const CalibrationFields& fields, const std::filesystem::path& path);
bool has_matrix_pair(const CalibrationFields& fields);  // matrices, or lists of fx, fy, cx, cy
CameraList read_matrix_pair(const CalibrationFields& fields, const std::filesystem::path& path);

// A camera with one list of fx, fy, cx, cy instead of the matrix, which read_matrix_camera reads.
bool has_vector_camera(const CalibrationFields& fields);

// A camera with one field for each focal length and coefficient, as of RealSense, SVO, FAST-LIVO, NeRF and simulators.
bool has_flat_camera(const CalibrationFields& fields);
CameraList read_flat_camera(const CalibrationFields& fields, const std::filesystem::path& path);

// MATLAB's cameraParameters and stereoParameters as a structure; Bouguet's Calib_Results.m and its printed stereo
// results.
bool has_matlab_camera(const CalibrationFields& fields);
CameraList read_matlab(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_matlab_pair(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_bouguet(const CalibrationFields& fields, const std::filesystem::path& path);

bool has_metashape_camera(const CalibrationFields& fields);
CameraList read_metashape(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_opensfm(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_openmvg(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_middlebury(const CalibrationFields& fields, const std::filesystem::path& path);

CameraList read_kitti(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_depthai(const CalibrationFields& fields, const std::filesystem::path& path);
CameraList read_colmap(const CalibrationFields& fields, const std::filesystem::path& path);

// Factory calibration of a ZED: cameras of the image size, else the first.
CameraList read_zed(const CalibrationFields& fields, std::optional<std::pair<int, int>> size);

// Rotation R, a matrix or a rotation vector, and translation T from the first to the second camera; empty without.
std::optional<Pose> pair_pose(const CalibrationFields& fields);
// Pose of a camera in the body by T_BS, T_imu_cam, T_cam_imu and the like, with a side; empty without.
std::optional<Pose> body_pose(const CalibrationFields& fields, std::string_view side = {});
// Poses of two cameras by fields around them: rotation and translation, or the pose of each in the body.
void place_pair(const CalibrationFields& fields, PlacedCamera& left, PlacedCamera& right);

// Helpers of the readers.
// Whether cameras inside a group share a field of this name, as the image size.
bool is_shared_field(std::string_view name);
// Fields with a common prefix or suffix of their names, as zed_K and zed_D, or K_left and D_left, as groups of this
// name, if one of them is a camera matrix or a camera.
CalibrationFields with_affix_groups(const CalibrationFields& fields);
Pose baseline_pose(double x, double y = 0.0);
std::string text_or(const CalibrationFields& fields, const std::string& field, const std::string& otherwise);
bool has_all(const CalibrationFields& fields, std::initializer_list<const char*> names);
// Image size from two fields; unknown if the file has neither.
void read_size(const CalibrationFields& fields, const std::string& width, const std::string& height, Camera& camera);
// Numbers of fields k1, k2 and the like; missing ones are zero.
std::vector<double> coefficients_of(const CalibrationFields& fields, const std::string& prefix,
                                    std::initializer_list<const char*> names);
void set_intrinsics(const CalibrationFields& fields, const std::array<std::string, 4>& names, Camera& camera);
std::optional<RectifiedView> rectified_view(const CalibrationFields& fields, const std::string& rotation,
                                            const std::string& projection);

}  // namespace byre
