#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/frame_tree.h"

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

namespace byre {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kExpandXacro = "expand it first: xacro robot.urdf.xacro > robot.urdf";

// Name of the file with the line of an element.
std::string place_at(const std::string& place, const XMLElement& element) {
  return fmt::format("{}:{}", place, element.GetLineNum());
}

// Throws InputError for elements of xacro, at any depth.
class XacroCheck final : public tinyxml2::XMLVisitor {
 public:
  explicit XacroCheck(const std::string& place) : place_(place) {}

  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute* /*first*/) override {
    if (std::string_view(element.Name()).starts_with("xacro:")) {
      throw InputError(place_at(place_, element), fmt::format("is xacro, not URDF: <{}>", element.Name()),
                       kExpandXacro);
    }
    return true;
  }

 private:
  const std::string& place_;
};

std::string required(const XMLElement& element, const char* attribute, const std::string& place) {
  const char* const value = element.Attribute(attribute);
  if (value == nullptr || *value == '\0') {
    throw InputError(place_at(place, element), fmt::format("<{}> has no {}", element.Name(), attribute));
  }
  if (std::string_view(value).find("${") != std::string_view::npos) {
    throw InputError(place_at(place, element), fmt::format("is xacro, not URDF: {}", value), kExpandXacro);
  }
  return value;
}

std::string linked(const XMLElement& joint, const char* end, const std::string& place) {
  const XMLElement* const element = joint.FirstChildElement(end);
  if (element != nullptr) return required(*element, "link", place);
  throw InputError(place_at(place, joint), fmt::format("<joint> has no <{}>", end));
}

// Three numbers of an attribute; zeros if it is missing, empty if it is invalid.
std::optional<Eigen::Vector3d> numbers_of(const XMLElement& origin, const char* attribute) {
  const char* const text = origin.Attribute(attribute);
  Eigen::Vector3d numbers = Eigen::Vector3d::Zero();
  if (text == nullptr) return numbers;
  const std::vector<std::string_view> fields = split_fields(text);
  if (fields.size() != 3) return std::nullopt;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> number = parse_number(fields[static_cast<std::size_t>(i)]);
    if (!number) return std::nullopt;
    numbers(i) = *number;
  }
  return numbers;
}

RobotFrame frame_of(const XMLElement& joint, const std::string& place) {
  const std::string name = required(joint, "name", place);
  const std::string type = required(joint, "type", place);
  RobotFrame frame{.parent = linked(joint, "parent", place),
                   .place = fmt::format("{}: joint \"{}\"", place_at(place, joint), name)};
  if (type != "fixed") frame.fault = fmt::format("is {}, not fixed", type);
  const XMLElement* const origin = joint.FirstChildElement("origin");
  if (origin == nullptr) return frame;
  const auto xyz = numbers_of(*origin, "xyz");
  const auto rpy = numbers_of(*origin, "rpy");
  if (!xyz || !rpy) {
    if (frame.fault.empty()) frame.fault = fmt::format("has no three finite numbers as {}", xyz ? "rpy" : "xyz");
    return frame;
  }
  frame.parent_from_frame = {rotation_from_rpy(*rpy), *xyz};
  return frame;
}

// The element <robot>.
const XMLElement& robot_of(const tinyxml2::XMLDocument& document, const std::string& place) {
  const XMLElement* const root = document.RootElement();
  const std::string_view name = root == nullptr ? "" : root->Name();
  if (name == "robot") return *root;
  throw InputError(place, fmt::format("is XML with the root <{}>, not a URDF", name.substr(0, 40)),
                   name == "sdf" ? "convert it to URDF, or write the extrinsics as YAML" : "give a URDF or YAML");
}

}  // namespace

FrameTree parse_urdf(const std::string& text, const std::string& place) {
  if (text.find("<!ENTITY") != std::string::npos) throw InputError(place, "defines entities, which are not read");
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool is_too_deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    throw InputError(fmt::format("{}:{}", place, document.ErrorLineNum()),
                     is_too_deep ? "is XML with elements nested too deep" : "is not valid XML", "correct the file");
  }
  const XMLElement& robot = robot_of(document, place);
  XacroCheck check(place);
  robot.Accept(&check);
  FrameTree tree{.place = place};
  for (const XMLElement* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    const std::string name = required(*link, "name", place);
    if (tree.frames.emplace(name, RobotFrame{}).second) continue;
    throw InputError(place_at(place, *link), fmt::format("defines the link \"{}\" again", name));
  }
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    RobotFrame frame = frame_of(*joint, place);
    const std::string child = linked(*joint, "child", place);
    for (const std::string& each : {frame.parent, child}) {
      if (!tree.frames.contains(each)) throw InputError(frame.place, fmt::format("names an unknown link \"{}\"", each));
    }
    RobotFrame& placed = tree.frames[child];
    if (!placed.parent.empty()) {
      throw InputError(frame.place, fmt::format("gives the link \"{}\" a second parent", child));
    }
    placed = std::move(frame);
  }
  if (tree.frames.empty()) throw InputError(place, "has no links", "give a URDF or YAML");
  return tree;
}

}  // namespace byre
