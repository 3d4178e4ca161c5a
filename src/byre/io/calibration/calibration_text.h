#pragma once

#include <optional>
#include <string>

#include <yaml-cpp/yaml.h>

namespace byre {

// Calibration files that are not YAML, as its nodes. place: name of the file. Throws InputError if the text is invalid.
// XML of OpenCV, or of any other program: elements and attributes as fields.
YAML::Node parse_xml(const std::string& text, const std::string& place);

// ROS' .ini and ost.txt: "[image]" with width and height, and a section for each camera with "camera matrix",
// "distortion", "rectification" and "projection". Each camera has the fields of a ROS YAML file, as the whole file if
// there is one camera, else as "left" and "right".
bool is_ros_ini(const std::string& text);
YAML::Node parse_ros_ini(const std::string& text, const std::string& place);

// Sections "[NAME]" of lines "NAME=VALUE", as in the factory calibration of a ZED and in TOML: groups of fields.
bool is_sections(const std::string& text);
YAML::Node parse_sections(const std::string& text);

// Statements "NAME = NUMBER" and "NAME = [MATRIX]" of MATLAB, Octave, Python and Middlebury's calib.txt, and arguments
// "'NAME', [MATRIX]" of functions. Matrices are stored row by row. Empty for less than two of them.
std::optional<YAML::Node> parse_assignments(const std::string& text);

// Lines without names or colons: cameras.txt of COLMAP as list "colmap"; camera.txt of DSO, and fx fy cx cy with
// coefficients, as in DROID-SLAM, as fields of these names; rows of a matrix, then coefficients, as K and D; names,
// each with a number, as fields; results of OCamCalib as "ocam". Empty for any other text.
std::optional<YAML::Node> parse_camera_lines(const std::string& text);

}  // namespace byre
