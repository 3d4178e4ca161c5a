#pragma once

#include "byre/pose.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace byre {

// Named fields of a YAML file that describes cameras; OpenCV's directive in the first line is allowed. Errors in a
// field throw InputError with the place "FILE: FIELD".
class CalibrationFields {
 public:
  // Throws InputError if the file cannot be read, is not YAML, or has no named fields.
  static CalibrationFields load(const std::filesystem::path& path);

  std::string place(const std::string& field) const;  // place of the field for an InputError
  bool has(const std::string& field) const;

  // Each throws InputError if the field is missing or has another type.
  CalibrationFields group(const std::string& field) const;  // fields inside this field
  std::string text(const std::string& field) const;
  // Numbers of a list, of a list of rows, or of a matrix stored row by row under "data".
  std::vector<double> numbers(const std::string& field) const;
  std::vector<double> numbers(const std::string& field, std::size_t count) const;  // requires this count
  Pose pose(const std::string& field) const;                                       // rigid motion, from its 4x4 matrix
  double positive(const std::string& field) const;                                 // one number above zero
  int pixels(const std::string& field) const;                                      // one side of an image

 private:
  CalibrationFields(std::string place, YAML::Node node) : place_(std::move(place)), node_(std::move(node)) {}

  YAML::Node find(const std::string& field) const;

  std::string place_;  // prefix of the place of each field, with the separator
  YAML::Node node_;
};

// A width or height in pixels. Throws InputError with this place if it is not a valid image size.
int to_image_side(double pixels, const std::string& place);

}  // namespace byre
