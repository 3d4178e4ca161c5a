#pragma once

#include "byre/pose.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace byre {

// Name of a field with the width and height of the images, which are not those of the file.
inline constexpr const char* kSizeOfImages = "size of the images";

// List of the documents of a YAML file that have fields of the same names.
inline constexpr const char* kDocuments = "documents";

// Named fields of a file that describes cameras: YAML, with OpenCV's directive in the first line allowed, JSON,
// XML, ROS' .ini, statements of MATLAB, or sections of NAME=VALUE, which are groups of fields. Errors in a field throw
// InputError with the place "FILE: FIELD".
class CalibrationFields {
 public:
  // Throws InputError if the file cannot be read, is in none of these formats, or has no named fields.
  static CalibrationFields load(const std::filesystem::path& path);

  std::string place(const std::string& field) const;  // place of the field for an InputError
  bool has(const std::string& field) const;
  bool is_group(const std::string& field) const;  // whether it has named fields
  bool has_scalar(const std::string& field) const;
  bool has_list(const std::string& field) const;  // whether it has numbers, or other values without names
  std::vector<std::string> names() const;         // names of all fields, in their order

  std::vector<std::pair<std::string, CalibrationFields>> inner() const;  // groups of fields, and those of lists
  // These fields, and the missing ones that the group around them has, of wanted names.
  CalibrationFields completed(const CalibrationFields& outer, bool (*is_wanted)(std::string_view name)) const;

  // These fields, with those named AFFIX_NAME or NAME_AFFIX as fields NAME of a group AFFIX.
  CalibrationFields grouped_by(const std::vector<std::string>& affixes) const;

  // How several documents of a YAML file were read; empty for one.
  const std::string& note() const { return note_; }

  void set_size_of_images(int width, int height);  // as the field kSizeOfImages

  // Each throws InputError if the field is missing or has another type.
  CalibrationFields group(const std::string& field) const;              // fields inside this field
  std::vector<CalibrationFields> list(const std::string& field) const;  // groups of a list
  // Groups with their names, of named fields or of a list of pairs of name and group.
  std::vector<std::pair<std::string, CalibrationFields>> groups(const std::string& field) const;
  std::string text(const std::string& field) const;
  // Numbers of a list, of a list of rows, of a matrix stored row by row under "data", or of one line of text.
  std::vector<double> numbers(const std::string& field) const;
  bool has_numbers(const std::string& field, std::size_t count) const;             // whether there are this many
  std::vector<double> numbers(const std::string& field, std::size_t count) const;  // requires this count
  Eigen::Matrix3d matrix(const std::string& field) const;                          // 3x3, row by row
  Pose pose(const std::string& field) const;                                       // rigid motion, from 4x4 or 3x4
  double number(const std::string& field) const;
  double number_or(const std::string& field, double missing) const;  // the second number if the field is missing
  double positive(const std::string& field) const;                   // one number above zero
  int pixels(const std::string& field) const;                        // one side of an image

 private:
  CalibrationFields(std::string place, YAML::Node node) : place_(std::move(place)), node_(std::move(node)) {}

  YAML::Node find(const std::string& field) const;

  std::string place_;  // prefix of the place of each field, with the separator
  YAML::Node node_;
  std::string note_{};
};

// A width or height in pixels. Throws InputError with this place if it is not a valid image size.
int to_image_side(double pixels, const std::string& place);

}  // namespace byre
