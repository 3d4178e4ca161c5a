#include "byre/io/calibration/calibration_fields.h"

#include "byre/base/regular_file.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/calibration_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <optional>

#include <fmt/core.h>

namespace byre {
namespace {

std::string text_of_file(const std::filesystem::path& path) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  constexpr std::streamsize kLargest = 1 << 20;  // bytes
  refuse_pipe(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), "cannot be opened", "check that it exists and is readable");
  std::string text(kLargest + 1, '\0');
  file.read(text.data(), kLargest + 1);
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargest) throw InputError(path.string(), "is larger than 1 MB, so it is no calibration file");
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

// Separates the numbers and rows of arrays that numpy printed.
std::string with_commas(const std::string& text) {
  const auto is_number = [](char c, std::string_view signs) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0 || signs.find(c) != std::string_view::npos;
  };
  std::string result;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    result += text[i];
    depth += text[i] == '[' ? 1 : text[i] == ']' ? -1 : 0;
    const std::size_t next = text.find_first_not_of(" \t\r\n", i + 1);
    const bool is_gap = depth > 0 && next != std::string::npos && next > i + 1;
    if (is_gap && is_number(text[i], ".]") && is_number(text[next], "+-.[")) result += ',';
  }
  return result;
}

// Documents with different names become one mapping, others a list.
YAML::Node joined(const std::vector<YAML::Node>& documents, std::string& note) {
  YAML::Node all(YAML::NodeType::Map), list;
  bool is_repeated = false;
  for (const YAML::Node& document : documents) {
    list.push_back(document);
    for (const auto& field : document) {
      const YAML::Node& found = all;
      is_repeated = is_repeated || found[field.first.Scalar()];
      if (!is_repeated) all[field.first.Scalar()] = field.second;  // an assignment would change the first document
    }
  }
  note = fmt::format("{} YAML documents of the file are read together", documents.size());
  if (!is_repeated) return all;
  YAML::Node repeated(YAML::NodeType::Map);
  repeated[kDocuments] = list;
  return repeated;
}

YAML::Node load_yaml(const std::string& text, std::string& note) {
  try {
    std::vector<YAML::Node> documents = YAML::LoadAll(text);
    const YAML::Node first = documents.empty() ? YAML::Node() : documents.front();
    std::erase_if(documents, [](const YAML::Node& each) { return !each.IsMap(); });
    return documents.size() > 1 ? joined(documents, note) : documents.empty() ? first : documents.front();
  } catch (const YAML::Exception&) {
    const std::string separated = with_commas(text);
    const YAML::Node node = YAML::Load(separated);
    if (separated == text) note = "a YAML document after the first one is not valid and is not used";
    return node;
  }
}

// OpenCV writes "%YAML:1.0" in the first line, which is an invalid directive; a comment keeps the line numbers. Its
// parser needs no space after the colon of a name.
YAML::Node parse_yaml(std::string text, std::string& note) {
  if (!text.starts_with("%YAML:")) return load_yaml(text, note);
  text.front() = '#';
  const auto is_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; };
  for (std::size_t line = 0; line < text.size(); line = text.find('\n', line + 1)) {
    std::size_t end = text.find_first_not_of(" \t\r\n", line);
    while (end < text.size() && is_name(text[end])) ++end;
    if (end < text.size() - 1 && text[end] == ':' && text[end + 1] > ' ') text.insert(end + 1, 1, ' ');
  }
  return load_yaml(text, note);
}

// note: see CalibrationFields::note.
YAML::Node parse_any(const std::filesystem::path& path, std::string& note) {
  std::string text = text_of_file(path);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin != std::string::npos && text[begin] == '<') return parse_xml(text, path.string());
  if (is_ros_ini(text)) return parse_ros_ini(text, path.string());
  if (is_sections(text)) return parse_sections(text);
  if (auto fields = parse_camera_lines(text)) return *std::move(fields);
  const bool is_yaml =
      text.starts_with("%YAML") || (begin != std::string::npos && (text[begin] == '{' || text[begin] == '['));
  if (!is_yaml) {
    if (auto fields = parse_assignments(text)) return *std::move(fields);
  }
  YAML::Node node = parse_yaml(std::move(text), note);
  if (!node.IsSequence()) return node;
  YAML::Node fields(YAML::NodeType::Map);  // a list without a name
  fields[node.size() > 0 && node[0].IsMap() ? "entries" : "K"] = node;
  return fields;
}

void append_numbers(const YAML::Node& list, const std::string& place, std::vector<double>& numbers) {
  for (const YAML::Node& entry : list) {
    if (entry.IsSequence()) {
      append_numbers(entry, place, numbers);
      continue;
    }
    const std::optional<double> number = entry.IsScalar() ? parse_number(entry.Scalar()) : std::nullopt;
    if (!number) throw InputError(place, "contains a value that is not a number");
    numbers.push_back(*number);
  }
}

}  // namespace

CalibrationFields CalibrationFields::load(const std::filesystem::path& path) {
  try {
    std::string note;
    CalibrationFields fields(path.string() + ": ", parse_any(path, note));
    fields.note_ = note;
    if (!fields.node_.IsMap()) throw InputError(path.string(), "is not a YAML mapping of named fields");
    return fields;
  } catch (const YAML::Exception& error) {
    throw InputError(path.string() + ":" + std::to_string(error.mark.line + 1), error.msg, "correct the YAML");
  }
}

std::string CalibrationFields::place(const std::string& field) const {
  return place_ + field;
}

YAML::Node CalibrationFields::find(const std::string& field) const {
  const YAML::Node& fields = node_;  // constant, because looking up a missing name would add it
  return fields[field];
}

bool CalibrationFields::has(const std::string& field) const {
  const YAML::Node node = find(field);
  return node && !node.IsNull();
}

bool CalibrationFields::is_group(const std::string& field) const {
  return has(field) && find(field).IsMap();
}

bool CalibrationFields::has_scalar(const std::string& field) const {
  return has(field) && find(field).IsScalar();
}

bool CalibrationFields::has_list(const std::string& field) const {
  return has(field) && find(field).IsSequence() && find(field).size() > 0;
}

std::vector<std::string> CalibrationFields::names() const {
  std::vector<std::string> names;
  for (const auto& field : node_) names.push_back(field.first.IsScalar() ? field.first.Scalar() : "");
  return names;
}

void CalibrationFields::set_size_of_images(int width, int height) {
  node_[kSizeOfImages] = std::vector<int>{width, height};
}

std::vector<std::pair<std::string, CalibrationFields>> CalibrationFields::inner() const {
  std::vector<std::pair<std::string, CalibrationFields>> result;
  for (const auto& field : node_) {
    if (!field.first.IsScalar()) continue;
    const std::string name = field.first.Scalar();
    if (field.second.IsMap()) result.push_back({name, {place(name) + ".", field.second}});
    if (!field.second.IsSequence()) continue;
    for (std::size_t i = 0; i < field.second.size(); ++i) {
      const std::string entry = name + "[" + std::to_string(i) + "]";
      if (field.second[i].IsMap()) result.push_back({entry, {place(entry) + ".", field.second[i]}});
    }
  }
  return result;
}

CalibrationFields CalibrationFields::grouped_by(const std::vector<std::string>& affixes) const {
  YAML::Node node(YAML::NodeType::Map);
  for (const auto& field : node_) {
    const std::string name = field.first.IsScalar() ? field.first.Scalar() : "";
    bool is_moved = false;
    for (const std::string& affix : affixes) {
      const bool is_first = name.starts_with(affix + "_"), is_last = name.ends_with("_" + affix);
      const std::size_t rest = name.size() - std::min(name.size(), affix.size() + 1);
      if (rest == 0 || (!is_first && !is_last)) continue;
      node[affix][is_first ? name.substr(affix.size() + 1) : name.substr(0, rest)] = field.second;
      is_moved = true;
    }
    if (!is_moved) node[field.first] = field.second;
  }
  return {place_, node};
}

CalibrationFields CalibrationFields::completed(const CalibrationFields& outer,
                                               bool (*is_wanted)(std::string_view name)) const {
  YAML::Node node(YAML::NodeType::Map);
  for (const auto& field : node_) node[field.first] = field.second;
  for (const auto& field : outer.node_) {
    if (!field.first.IsScalar() || !is_wanted(field.first.Scalar()) || has(field.first.Scalar())) continue;
    node[field.first] = field.second;
  }
  return {place_, node};
}

CalibrationFields CalibrationFields::group(const std::string& field) const {
  if (!has(field)) throw InputError(place(field), "is missing");
  if (!find(field).IsMap()) throw InputError(place(field), "has no named fields");
  return {place(field) + ".", find(field)};
}

std::string CalibrationFields::text(const std::string& field) const {
  if (!has(field)) throw InputError(place(field), "is missing");
  if (!find(field).IsScalar()) throw InputError(place(field), "is not a scalar");
  return find(field).Scalar();
}

std::vector<double> CalibrationFields::numbers(const std::string& field) const {
  if (!has(field)) throw InputError(place(field), "is missing");
  const YAML::Node node = find(field);
  const YAML::Node list = node.IsMap() ? node["data"] : node;
  if (!list) throw InputError(place(field), "has no data");
  if (list.IsScalar()) {
    std::vector<double> numbers;
    std::string text = list.Scalar();
    const auto is_separator = [](char c) { return c == '[' || c == ']' || c == ','; };
    if (text.starts_with('[')) std::ranges::replace_if(text, is_separator, ' ');
    for (const std::string_view part : split_fields(text)) {
      const std::optional<double> number = parse_number(part);
      if (!number) throw InputError(place(field), "is not a list of numbers");
      numbers.push_back(*number);
    }
    if (numbers.size() < 2) throw InputError(place(field), "is not a list of numbers");
    return numbers;
  }
  if (!list.IsSequence()) throw InputError(place(field), "is not a list of numbers");
  std::vector<double> numbers;
  append_numbers(list, place(field), numbers);
  return numbers;
}

bool CalibrationFields::has_numbers(const std::string& field, std::size_t count) const try {
  return has(field) && numbers(field).size() == count;
} catch (const InputError&) {
  return false;
}

std::vector<double> CalibrationFields::numbers(const std::string& field, std::size_t count) const {
  std::vector<double> result = numbers(field);
  if (result.size() == count) return result;
  throw InputError(place(field),
                   "has " + std::to_string(result.size()) + " numbers instead of " + std::to_string(count));
}

Eigen::Matrix3d CalibrationFields::matrix(const std::string& field) const {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers(field, 9).data());
}

std::vector<CalibrationFields> CalibrationFields::list(const std::string& field) const {
  if (!has(field)) throw InputError(place(field), "is missing");
  if (!find(field).IsSequence()) throw InputError(place(field), "is not a list");
  std::vector<CalibrationFields> entries;
  for (const YAML::Node& entry : find(field)) {
    const std::string name = place(field) + "[" + std::to_string(entries.size()) + "]";
    if (!entry.IsMap()) throw InputError(name, "has no named fields");
    entries.push_back({name + ".", entry});
  }
  return entries;
}

std::vector<std::pair<std::string, CalibrationFields>> CalibrationFields::groups(const std::string& field) const {
  if (!has(field)) throw InputError(place(field), "is missing");
  std::vector<std::pair<std::string, CalibrationFields>> result;
  const auto add = [&](const YAML::Node& name, const YAML::Node& group) {
    if (!name.IsScalar() || !group.IsMap()) throw InputError(place(field), "has no named groups");
    const std::string prefix = place(field) + "." + name.Scalar() + ".";
    result.emplace_back(name.Scalar(), CalibrationFields(prefix, group));
  };
  const YAML::Node node = find(field);
  for (const auto& entry : node) {
    if (node.IsMap()) {
      add(entry.first, entry.second);
    } else if (entry.IsSequence() && entry.size() == 2) {
      add(entry[0], entry[1]);
    } else {
      throw InputError(place(field), "has no named groups");
    }
  }
  return result;
}

double CalibrationFields::number(const std::string& field) const {
  const std::optional<double> number = parse_number(text(field));
  if (!number) throw InputError(place(field), "is not a number");
  return *number;
}

double CalibrationFields::number_or(const std::string& field, double missing) const {
  return has(field) ? number(field) : missing;
}

Pose CalibrationFields::pose(const std::string& field) const {
  std::vector<double> values = numbers(field);
  if (values.size() == 12) values.insert(values.end(), {0.0, 0.0, 0.0, 1.0});
  if (values.size() != 16) numbers(field, 16);
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(values.data());
  const std::optional<Eigen::Quaterniond> rotation = rotation_from_matrix(matrix.topLeftCorner<3, 3>());
  if (!rotation) throw InputError(place(field), "the 3x3 part is not a rotation", "give the matrix row by row");
  if (matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    throw InputError(place(field), "the last row is not 0 0 0 1", "give the matrix row by row");
  }
  return {*rotation, matrix.topRightCorner<3, 1>()};
}

double CalibrationFields::positive(const std::string& field) const {
  const std::optional<double> number = parse_number(text(field));
  if (number && *number > 0.0) return *number;
  throw InputError(place(field), "is not a positive number");
}

int CalibrationFields::pixels(const std::string& field) const {
  const std::optional<double> number = parse_number(text(field));
  if (!number) throw InputError(place(field), "is not a number");
  return to_image_side(*number, place(field));
}

int to_image_side(double pixels, const std::string& place) {
  constexpr int kMaxSide = 20000;
  if (pixels >= 1.0 && pixels <= kMaxSide && pixels == std::floor(pixels)) return static_cast<int>(pixels);
  throw InputError(place, "is not a width and height in pixels");
}

}  // namespace byre
