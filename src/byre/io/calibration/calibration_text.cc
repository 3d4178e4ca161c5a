#include "byre/io/calibration/calibration_text.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <opencv2/core.hpp>

namespace byre {
namespace {

YAML::Node yaml_of(const cv::FileNode& node) {
  if (node.isInt()) return YAML::Node(static_cast<int>(node));
  if (node.isReal()) return YAML::Node(fmt::format("{}", static_cast<double>(node)));
  if (node.isString()) return YAML::Node(static_cast<std::string>(node));
  YAML::Node children(node.isMap()   ? YAML::NodeType::Map
                      : node.isSeq() ? YAML::NodeType::Sequence
                                     : YAML::NodeType::Null);
  for (const cv::FileNode& child : node) {
    if (node.isMap()) {
      children[child.name()] = yaml_of(child);
    } else {
      children.push_back(yaml_of(child));
    }
  }
  return children;
}

std::string_view trimmed(std::string_view line) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t begin = line.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return line.substr(begin, line.find_last_not_of(kBlank) - begin + 1);
}

// All fields of a line if they are numbers; else empty.
std::vector<std::string> numbers_of(std::string_view line) {
  std::vector<std::string> numbers;
  for (const std::string_view field : split_fields(line)) {
    if (!parse_number(field)) return {};
    numbers.emplace_back(field);
  }
  return numbers;
}

// Name of a quantity in ROS' YAML; empty if it has another name.
std::string_view yaml_name(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> kNames[] = {{"camera matrix", "camera_matrix"},
                                                                      {"distortion", "distortion_coefficients"},
                                                                      {"rectification", "rectification_matrix"},
                                                                      {"projection", "projection_matrix"},
                                                                      {"width", "image_width"},
                                                                      {"height", "image_height"}};
  for (const auto& [from, to] : kNames) {
    if (name == from) return to;
  }
  return {};
}

}  // namespace

YAML::Node parse_opencv_xml(const std::string& text, const std::string& place) {
  try {
    const cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_XML);
    YAML::Node fields(YAML::NodeType::Map);
    for (const cv::FileNode& field : storage.root()) fields[field.name()] = yaml_of(field);
    return fields;
  } catch (const cv::Exception& error) {
    throw InputError(place, "is not XML that OpenCV wrote: " + error.err, "give a calibration file of OpenCV");
  }
}

bool is_ros_ini(const std::string& text) {
  std::istringstream lines(text);
  bool has_image = false;
  for (std::string line; std::getline(lines, line);) {
    has_image = has_image || trimmed(line) == "[image]";
    if (has_image && trimmed(line) == "camera matrix") return true;
  }
  return false;
}

YAML::Node parse_ros_ini(const std::string& text, const std::string& place) {
  std::vector<YAML::Node> cameras;
  std::string quantity;
  std::pair<YAML::Node, YAML::Node> size;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    if (content.front() == '[') {
      quantity.clear();
      if (content != "[image]") cameras.emplace_back(YAML::NodeType::Map);
      continue;
    }
    const std::vector<std::string> numbers = numbers_of(content);
    if (numbers.empty()) {
      quantity = yaml_name(content);
      continue;
    }
    if (quantity == "image_width") size.first = YAML::Node(numbers.front());
    if (quantity == "image_height") size.second = YAML::Node(numbers.front());
    if (quantity.empty() || quantity.starts_with("image_") || cameras.empty()) continue;
    for (const std::string& number : numbers) cameras.back()[quantity]["data"].push_back(number);
  }
  if (cameras.empty() || cameras.size() > 2) {
    throw InputError(place, fmt::format("has {} cameras instead of one or two", cameras.size()));
  }
  for (YAML::Node& camera : cameras) {
    camera["image_width"] = size.first;
    camera["image_height"] = size.second;
  }
  if (cameras.size() == 1) return cameras.front();
  YAML::Node pair(YAML::NodeType::Map);
  pair["left"] = cameras.front();
  pair["right"] = cameras.back();
  return pair;
}

bool is_sections(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == ';') continue;
    return content.front() == '[' && content.back() == ']' && content.find_first_of(",:{\"") == std::string_view::npos;
  }
  return false;
}

YAML::Node parse_sections(const std::string& text) {
  YAML::Node file(YAML::NodeType::Map);
  std::string section;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == ';') continue;
    const std::size_t equals = content.find('=');
    if (content.front() == '[') {
      section = content.substr(1, content.size() - 2);
    } else if (equals != std::string_view::npos && !section.empty()) {
      const std::string name(trimmed(content.substr(0, equals)));
      file[section][name] = YAML::Load(std::string(content.substr(equals + 1)));
    }
  }
  return file;
}

namespace {

// "ID MODEL WIDTH HEIGHT PARAMETERS" of COLMAP; null if the line is none.
YAML::Node colmap_camera_of(const std::vector<std::string_view>& words) {
  const auto is_capital = [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; };
  if (words.size() < 5 || !parse_number(words[0]) || !std::ranges::all_of(words[1], is_capital)) return {};
  YAML::Node camera(YAML::NodeType::Map);
  camera["model"] = std::string(words[1]);
  camera["width"] = std::string(words[2]);
  camera["height"] = std::string(words[3]);
  for (std::size_t i = 4; i < words.size(); ++i) camera["parameters"].push_back(std::string(words[i]));
  return camera;
}

}  // namespace

std::optional<YAML::Node> parse_camera_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    const std::string_view content = trimmed(line);
    if (!content.empty() && content.front() != '#') lines.emplace_back(content);
  }
  if (lines.empty()) return std::nullopt;
  YAML::Node file(YAML::NodeType::Map);
  for (const std::string& line : lines) {
    const YAML::Node camera = colmap_camera_of(split_fields(line));
    if (!camera.IsDefined() || camera.IsNull()) break;
    file["colmap"].push_back(camera);
  }
  if (file["colmap"].size() == lines.size()) return file;
  // DSO: an optional model, intrinsics and coefficients; the image size; what is cut off; the new size.
  const std::vector<std::string_view> words = split_fields(lines.front());
  const bool has_model = !words.empty() && !parse_number(words.front());
  const std::size_t begin = has_model ? 1 : 0;
  const bool is_numeric = std::all_of(words.begin() + static_cast<std::ptrdiff_t>(begin), words.end(),
                                      [](auto word) { return parse_number(word); });
  const std::vector<std::string_view> size =
      lines.size() > 1 ? split_fields(lines[1]) : std::vector<std::string_view>{};
  const bool is_dso = lines.size() > 2 && size.size() == 2 && parse_number(size[0]) && parse_number(size[1]);
  if (!is_numeric || words.size() < begin + 4 || (lines.size() > 1 && !is_dso) || (has_model && !is_dso)) {
    return std::nullopt;
  }
  YAML::Node camera(YAML::NodeType::Map);
  constexpr std::array kNames = {"fx", "fy", "cx", "cy"};
  for (std::size_t i = 0; i < kNames.size(); ++i) camera[kNames[i]] = std::string(words[begin + i]);
  for (std::size_t i = begin + 4; i < words.size(); ++i) camera["distortion"].push_back(std::string(words[i]));
  const std::size_t coefficients = words.size() - begin - 4;
  const bool is_view_angle = coefficients == 1 && *parse_number(words.back()) != 0.0;
  camera["model"] = has_model ? std::string(words.front()) : is_view_angle ? "FOV" : "Pinhole";
  if (coefficients == 1 && !is_view_angle) camera.remove("distortion");
  if (is_dso) {
    camera["width"] = std::string(size[0]);
    camera["height"] = std::string(size[1]);
  }
  return camera;
}

}  // namespace byre
