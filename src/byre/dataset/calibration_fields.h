#pragma once

#include "byre/pose.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace byre {

// Named fields of a YAML file that describes cameras; OpenCV's directive in the first line is allowed. Whatever is
// wrong with a field is an InputError with the place "FILE: FIELD".
class CalibrationFields {
 public:
  // Throws InputError when the file cannot be read, is no YAML, or has no named fields.
  static CalibrationFields load(const std::filesystem::path& path);

  std::string place(const std::string& field) const;  // name of the field's place in an InputError
  bool has(const std::string& field) const;

  // Each throws InputError when the field is missing or of another kind.
  CalibrationFields group(const std::string& field) const;  // the fields within this one
  std::string word(const std::string& field) const;
  // The numbers of a list, of a list of rows, or of a matrix that keeps them row by row under "data".
  std::vector<double> numbers(const std::string& field) const;
  std::vector<double> numbers(const std::string& field, std::size_t count) const;  // exactly so many
  Pose pose(const std::string& field) const;                                       // rigid motion, from its 4x4 matrix
  double positive(const std::string& field) const;                                 // one number above zero
  int pixels(const std::string& field) const;                                      // one side of an image

 private:
  CalibrationFields(std::string place, YAML::Node node) : place_(std::move(place)), node_(std::move(node)) {}

  YAML::Node find(const std::string& field) const;

  std::string place_;  // beginning of every field's place, with what separates it from the field
  YAML::Node node_;
};

// A width or height in pixels. Throws InputError, blaming place, when it is none of an image.
int to_image_side(double pixels, const std::string& place);

}  // namespace byre
