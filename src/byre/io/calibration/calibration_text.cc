#include "byre/io/calibration/calibration_text.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <opencv2/core.hpp>
#include <tinyxml2.h>

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

// Fields of an element: its attributes and children, or its text. Of a first and an adjusted calibration (Metashape),
// the adjusted one.
YAML::Node yaml_of(const tinyxml2::XMLElement& element) {
  const tinyxml2::XMLElement* child = element.FirstChildElement();
  const char* const text = element.GetText();
  if (child == nullptr && element.FirstAttribute() == nullptr) return YAML::Node(std::string(text ? text : ""));
  YAML::Node fields(YAML::NodeType::Map);
  for (const auto* each = element.FirstAttribute(); each != nullptr; each = each->Next()) {
    fields[each->Name()] = std::string(each->Value());
  }
  if (child == nullptr && text != nullptr) fields["data"] = std::string(text);
  for (int count = 1; child != nullptr; child = child->NextSiblingElement(), ++count) {
    const std::string name = child->Name();
    const bool is_first = element.FirstChildElement(child->Name()) == child;
    const bool is_replaced = child->Attribute("class", "initial") && child->NextSiblingElement(child->Name());
    if (!is_replaced) fields[is_first || !fields[name] ? name : fmt::format("{}_{}", name, count)] = yaml_of(*child);
  }
  return fields;
}

YAML::Node parse_other_xml(const std::string& text, const std::string& place) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) {
    throw InputError(fmt::format("{}:{}", place, document.ErrorLineNum()), "is not valid XML", "correct the file");
  }
  YAML::Node fields(YAML::NodeType::Map);
  fields[document.RootElement()->Name()] = yaml_of(*document.RootElement());
  return fields;
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

YAML::Node parse_xml(const std::string& text, const std::string& place) {
  if (text.find("<opencv_storage") == std::string::npos) return parse_other_xml(text, place);
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
    if (content.front() == '[' && equals == std::string_view::npos) {
      section = content.substr(1, content.find(']') - 1);
    } else if (equals != std::string_view::npos && !section.empty()) {
      const std::string name(trimmed(content.substr(0, equals)));
      std::string value(content.substr(equals + 1));
      while (std::ranges::count(value, '[') > std::ranges::count(value, ']') && std::getline(lines, line)) {
        value += ' ' + line;
      }
      file[section][name] = YAML::Load(value);
    }
  }
  return file;
}

namespace {

bool is_of_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

// Text without comments of MATLAB, Python and C, and without continued lines.
std::string without_comments(const std::string& text) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line.resize(std::min({line.size(), line.find('%'), line.find('#'), line.find("//")}));
    const std::size_t dots = line.find("...");
    result += dots == std::string::npos ? line + '\n' : line.substr(0, dots) + ' ';
  }
  return result;
}

// Numbers of the matrix whose bracket opens at begin, row by row; also transposed by an apostrophe. Empty unless all
// are numbers.
std::vector<std::string> matrix_at(const std::string& text, std::size_t begin) {
  int depth = 0;
  std::size_t end = begin, rows = 0;
  std::string numbers;
  bool is_row = false;
  do {
    const char c = text[end];
    depth += c == '[' || c == '(' ? 1 : c == ']' || c == ')' ? -1 : 0;
    const bool is_end = c == ';' || c == '\n' || c == ']' || c == ')';
    if (is_end && is_row) ++rows;
    if (is_end || c == '[' || c == '(') is_row = false;
    is_row = is_row || std::isdigit(static_cast<unsigned char>(c)) != 0;
    numbers += is_end || c == '[' || c == '(' || c == ',' ? ' ' : c;
    ++end;
  } while (depth > 0 && end < text.size());
  std::vector<std::string> matrix = numbers_of(numbers);
  if (depth != 0 || matrix.empty() || end >= text.size() || text[end] != '\'' || matrix.size() % rows != 0) {
    return depth == 0 ? matrix : std::vector<std::string>{};
  }
  const std::size_t columns = matrix.size() / rows;
  std::vector<std::string> transposed;
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row) transposed.push_back(matrix[row * columns + column]);
  }
  return transposed;
}

// Value of a statement or argument that begins at begin: numbers, one number, or a quoted word. Null for any other.
YAML::Node value_at(const std::string& text, std::size_t begin) {
  begin = std::min(text.find_first_not_of(" \t", begin), text.size());
  std::size_t bracket = begin;
  while (bracket < text.size() && is_of_name(text[bracket])) ++bracket;
  const bool is_function = bracket > begin && bracket < text.size() && text[bracket] == '(' &&
                           std::isdigit(static_cast<unsigned char>(text[begin])) == 0;
  if (is_function) bracket = std::min(text.find_first_not_of(" \t\n", bracket + 1), text.size());
  if (bracket < text.size() && text[bracket] == '[' && (is_function || bracket == begin)) {
    const std::vector<std::string> numbers = matrix_at(text, bracket);
    if (numbers.size() == 1) return YAML::Node(numbers.front());
    YAML::Node node;
    for (const std::string& number : numbers) node.push_back(number);
    return node;
  }
  const std::string value(trimmed(std::string_view(text).substr(begin, text.find_first_of(";,\n)", begin) - begin)));
  const bool is_quoted = value.size() > 2 && (value.front() == '\'' || value.front() == '"');
  if (is_quoted && value.back() == value.front()) return YAML::Node(value.substr(1, value.size() - 2));
  return parse_number(value) ? YAML::Node(value) : YAML::Node();
}

// Sets a field; a dot in its name separates groups.
void set_field(YAML::Node fields, std::string_view name, const YAML::Node& value) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) {
    fields[std::string(name)] = value;
  } else {
    const std::string group(name.substr(0, dot));
    if (!fields[group].IsMap()) fields[group] = YAML::Node(YAML::NodeType::Map);
    set_field(fields[group], name.substr(dot + 1), value);
  }
}

}  // namespace

std::optional<YAML::Node> parse_assignments(const std::string& source) {
  const std::string text = without_comments(source);
  YAML::Node file(YAML::NodeType::Map);
  int found = 0;
  const auto add = [&](std::size_t name_begin, std::size_t name_end, std::size_t value) {
    const std::string_view name = std::string_view(text).substr(name_begin, name_end - name_begin);
    if (name.empty() || name.front() == '.' || name.back() == '.' || name.find("..") != std::string_view::npos ||
        std::isdigit(static_cast<unsigned char>(name.front())) != 0) {
      return;
    }
    const YAML::Node node = value_at(text, value);
    if (node.IsNull()) return;
    set_field(file, name, node);
    ++found;
  };
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool is_quote = text[at] == '\'' || text[at] == '"';
    if (text[at] != '=' && !is_quote) continue;
    if (is_quote) {
      const std::size_t comma = text.find_first_not_of(" \t", at + 1);
      std::size_t begin = at;
      while (begin > 0 && is_of_name(text[begin - 1])) --begin;
      const bool is_argument = begin > 0 && text[begin - 1] == text[at] && comma < text.size() && text[comma] == ',';
      if (is_argument) add(begin, at, comma + 1);
      continue;
    }
    std::size_t end = at;
    while (end > 0 && (text[end - 1] == ' ' || text[end - 1] == '\t')) --end;
    std::size_t begin = end;
    while (begin > 0 && is_of_name(text[begin - 1])) --begin;
    if (at + 1 < text.size() && text[at + 1] != '=') add(begin, end, at + 1);
  }
  if (found < 2) return std::nullopt;
  return file;
}

namespace {

// "ID MODEL WIDTH HEIGHT PARAMETERS" of COLMAP; null if the line is none.
YAML::Node colmap_camera_of(const std::vector<std::string_view>& words) {
  const auto is_capital = [](char c) { return (c >= 'A' && c <= 'Z') || c == '_'; };
  if (words.size() < 5 || !parse_number(words[0]) || !std::ranges::all_of(words[1], is_capital)) return {};
  YAML::Node camera(YAML::NodeType::Map);
  camera["id"] = std::string(words[0]);
  camera["model"] = std::string(words[1]);
  camera["width"] = std::string(words[2]);
  camera["height"] = std::string(words[3]);
  for (std::size_t i = 4; i < words.size(); ++i) camera["parameters"].push_back(std::string(words[i]));
  return camera;
}

}  // namespace

namespace {

// All numbers of a text, separated by commas, brackets or white space; empty if there is anything else.
std::vector<std::string> numbers_of_lines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + ' ';
  std::ranges::replace_if(
      text, [](char c) { return c == ',' || c == ';' || c == '[' || c == ']'; }, ' ');
  return numbers_of(text);
}

// Rows of a camera matrix, 3x3, 3x4 or 4x4, which coefficients may follow.
std::optional<YAML::Node> parse_matrix_lines(const std::vector<std::string>& lines) {
  const std::vector<std::string> numbers = numbers_of_lines(lines);
  const auto value = [&](std::size_t i) { return *parse_number(numbers[i]); };
  if (numbers.size() < 9 || numbers.size() > 30) return std::nullopt;
  for (const std::size_t columns : {std::size_t{3}, std::size_t{4}}) {
    const bool is_square = columns == 4 && numbers.size() >= 16 && value(15) == 1.0;
    const std::size_t end = is_square ? 16 : 3 * columns;
    if (numbers.size() < end) continue;
    const auto at = [&](std::size_t row, std::size_t column) { return value(row * columns + column); };
    const bool is_matrix = at(0, 0) > 0.0 && at(1, 1) > 0.0 && at(1, 0) == 0.0 && at(2, 0) == 0.0 && at(2, 1) == 0.0 &&
                           at(2, 2) == 1.0 && at(0, 2) != 0.0 && at(1, 2) != 0.0;
    const bool has_shift = columns == 4 && (at(0, 3) != 0.0 || at(1, 3) != 0.0 || at(2, 3) != 0.0);
    const std::size_t rest = numbers.size() - end;
    if (!is_matrix || has_shift || (rest != 0 && rest != 4 && rest != 5 && rest != 8 && rest != 14)) continue;
    YAML::Node camera(YAML::NodeType::Map);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) camera["K"].push_back(numbers[row * columns + column]);
    }
    for (std::size_t i = end; i < numbers.size(); ++i) camera["D"].push_back(numbers[i]);
    return camera;
  }
  return std::nullopt;
}

// Lines of a name and a number, with nothing in between.
std::optional<YAML::Node> parse_named_lines(const std::vector<std::string>& lines) {
  YAML::Node fields(YAML::NodeType::Map);
  for (const std::string& line : lines) {
    const std::vector<std::string_view> words = split_fields(line);
    const bool is_named = words.size() == 2 && !words[0].empty() && parse_number(words[1]) &&
                          std::ranges::all_of(words[0], is_of_name) && !parse_number(words[0]);
    if (!is_named) return std::nullopt;
    fields[std::string(words[0])] = std::string(words[1]);
  }
  if (lines.size() < 4) return std::nullopt;
  return fields;
}

// calib_results.txt of OCamCalib: both polynomials with their lengths, centre, affine parameters, image size.
bool is_ocam(const std::vector<std::string>& lines) {
  constexpr std::array<std::size_t, 3> kCounts = {2, 3, 2};
  if (lines.size() != kCounts.size() + 2) return false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::vector<std::string> numbers = numbers_of(lines[i]);
    if (numbers.empty()) return false;
    const double expected = i < 2 ? *parse_number(numbers.front()) + 1.0 : static_cast<double>(kCounts[i - 2]);
    if (static_cast<double>(numbers.size()) != expected) return false;
  }
  return true;
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
  if (auto matrix = parse_matrix_lines(lines)) return matrix;
  if (auto fields = parse_named_lines(lines)) return fields;
  if (is_ocam(lines)) {
    file["ocam"] = true;
    return file;
  }
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
