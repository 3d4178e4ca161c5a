#pragma once

#include "byre/plan_registration.h"
#include "byre/pose.h"
#include "byre/slam/frame/health.h"

#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

namespace byre {

// Null without a value.
template <typename Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

// Text of a template, empty if it is left out. Figures are named in braces:
//   {key}       figure; {part.key} within a part, {list.0} an element. Elements of a list are separated by commas.
//   {key:.2f}   figure in a format of libfmt
//   {key*100:g} figure multiplied by a number
//   {#list}     number of elements
//   {?key}      no text, but a condition: the figure is true, not zero or not empty; {!key} is the opposite
//   [...]       left out if a figure in it is null or missing, or a condition does not hold
//   [...|...]   first of several alternatives that is not left out
// A whole template is left out likewise. Figures of "more" precede others of the same key.
std::optional<std::string> expand(std::string_view text, const nlohmann::ordered_json& figures,
                                  const nlohmann::ordered_json& more = {});

// A report as JSON and as text, whose rows name the figures.
struct Report {
  nlohmann::ordered_json figures;
  std::string text{};
  int label_width = 12;
  std::string details{};     // further rows, for developers
  std::string conclusion{};  // the last line: the result in a sentence, and the next command

  // Adds a line, with a label in the first column or without. more: figures for the text only. Templates: see expand().
  void row(std::string_view label, std::string_view content, const nlohmann::ordered_json& more = {});
  void line(std::string_view content, const nlohmann::ordered_json& more = {});
  void detail(std::string_view label, std::string_view content, const nlohmann::ordered_json& more = {});
  // Sets the conclusion, unless a figure is missing; also among the figures.
  void conclude(std::string_view content, const nlohmann::ordered_json& more = {});
  // Adds the rows of a part, without its figures and its conclusion.
  void append(const Report& part);

 private:
  // Empty if the template is left out.
  std::string labelled(std::string_view label, std::string_view content, const nlohmann::ordered_json& more) const;
};

std::string to_text(const Report& report, bool with_details);

// Indented by indent spaces.
std::string to_json(const Report& report, int indent = 2);

nlohmann::ordered_json list_json(const Eigen::VectorXd& values);

// Keys carry units (docs/reference/health_and_events.md).
nlohmann::ordered_json health_json(const Health& health);

// Keys position_m, quaternion_xyzw and body_covariance (of a small motion in the body frame, row-major).
nlohmann::ordered_json pose_json(const Pose& frame_from_body, const Matrix6& covariance);

nlohmann::ordered_json position_json(const std::optional<Pose>& frame_from_body);

// Pose of a map on a plan. Keys carry units; covariance row-major, see PlanRegistration.
nlohmann::ordered_json registration_json(const PlanRegistration& registration);

// Rounded to microseconds; further digits are noise.
double rounded_ms(double milliseconds);

// One line, or indented by indent spaces. Replaces invalid UTF-8 and escapes control characters.
std::string dump_json(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace byre
