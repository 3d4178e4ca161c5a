#include "byre/playback/report/report.h"

#include "byre/base/printable.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

// Keys may contain dots. Null if missing.
Json find_figure(std::string_view key, const Json& figures) {
  if (figures.is_array() && key.find_first_not_of("0123456789") == std::string_view::npos) {
    const auto index = static_cast<std::size_t>(std::atoi(std::string(key).c_str()));
    return index < figures.size() ? figures[index] : Json();
  }
  if (const auto found = figures.find(std::string(key)); found != figures.end()) return *found;
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) return nullptr;
  const auto part = figures.find(std::string(key.substr(0, dot)));
  return part == figures.end() ? Json() : find_figure(key.substr(dot + 1), *part);
}

bool holds(const Json& figure) {
  if (figure.is_number()) return figure.get<double>() != 0.0;
  if (figure.is_boolean()) return figure.get<bool>();
  return figure.is_string() ? !figure.get_ref<const std::string&>().empty() : !figure.empty();
}

std::string format_figure(const Json& figure, double factor, const std::string& format) {
  if (figure.is_structured()) {
    std::string text;
    for (const auto& [key, element] : figure.items()) {
      text +=
          (text.empty() ? "" : ", ") + (figure.is_object() ? key + " " : "") + format_figure(element, factor, format);
    }
    return text;
  }
  const auto shown = fmt::runtime("{:" + format + "}");
  if (figure.is_string()) return fmt::format(shown, figure.get_ref<const std::string&>());
  if (figure.is_boolean()) return fmt::format(shown, figure.get<bool>());
  const bool is_integer =
      figure.is_number_integer() && factor == 1.0 && format.find_first_of("fg") == std::string::npos;
  return is_integer ? fmt::format(shown, figure.get<std::int64_t>())
                    : fmt::format(shown, factor * figure.get<double>());
}

class Expansion {
 public:
  Expansion(std::string_view text, const Json& figures, const Json& more)
      : rest_(text), figures_(figures), more_(more) {}

  std::optional<std::string> alternatives() {
    std::optional<std::string> chosen;
    do {
      std::optional<std::string> text = alternative();
      if (!chosen) chosen = std::move(text);
    } while (takes('|'));
    return chosen;
  }

  bool is_complete() const { return rest_.empty(); }  // false after an unmatched bracket

 private:
  bool takes(char character) {
    if (!rest_.starts_with(character)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::string_view take_until(std::string_view ends) {
    const std::string_view taken = rest_.substr(0, rest_.find_first_of(ends));
    rest_.remove_prefix(taken.size());
    return taken;
  }

  std::optional<std::string> alternative() {
    std::optional<std::string> text = "";
    const auto add = [&text](const std::optional<std::string>& more) {
      text = text && more ? std::optional(*text + *more) : std::nullopt;
    };
    while (!rest_.empty() && rest_.front() != '|' && rest_.front() != ']') {
      if (takes('[')) {
        add(alternatives().value_or(""));
        takes(']');
      } else if (takes('{')) {
        add(figure(take_until("}")));
        takes('}');
      } else {
        add(std::string(take_until("{[|]")));
      }
    }
    return text;
  }

  Json value_of(std::string_view key) const {
    Json value = find_figure(key, more_);
    return value.is_null() ? find_figure(key, figures_) : value;
  }

  std::optional<std::string> figure(std::string_view field) const {
    const std::size_t colon = std::min(field.find(':'), field.size());
    const std::string format(field.substr(std::min(colon + 1, field.size())));
    field = field.substr(0, colon);
    const std::size_t star = std::min(field.find('*'), field.size());
    const double factor = star < field.size() ? std::atof(std::string(field.substr(star + 1)).c_str()) : 1.0;
    field = field.substr(0, star);
    assert(!field.empty());
    const char mark = field.front();
    const Json value = value_of(mark == '?' || mark == '!' || mark == '#' ? field.substr(1) : field);
    if (mark == '?' || mark == '!')
      return holds(value) == (mark == '?') ? std::optional<std::string>("") : std::nullopt;
    if (value.is_null()) return std::nullopt;
    return mark == '#' ? std::to_string(value.size()) : format_figure(value, factor, format);
  }

  std::string_view rest_;
  const Json& figures_;
  const Json& more_;
};

Json agreement_json(const std::optional<Agreement>& agreement) {
  if (!agreement) return nullptr;
  return {{"translation_m", agreement->translation}, {"rotation_rad", agreement->rotation}};
}

Json condition_json(const std::optional<ImageCondition>& image) {
  if (!image) return nullptr;
  return {{"brightness", image->brightness},
          {"contrast", image->contrast},
          {"clipped", image->clipped},
          {"sharpness", image->sharpness},
          {"noise", image->noise}};
}

}  // namespace

std::optional<std::string> expand(std::string_view text, const Json& figures, const Json& more) {
  Expansion expansion(text, figures, more);
  std::optional<std::string> expanded = expansion.alternatives();
  assert(expansion.is_complete());
  return expanded;
}

std::string Report::labelled(std::string_view label, std::string_view content, const Json& more) const {
  const std::optional<std::string> expanded = expand(content, figures, more);
  return expanded ? fmt::format("{:{}} {}\n", printable(label), label_width, printable(*expanded)) : "";
}

void Report::row(std::string_view label, std::string_view content, const Json& more) {
  text += labelled(label, content, more);
}

void Report::detail(std::string_view label, std::string_view content, const Json& more) {
  details += labelled(label, content, more);
}

void Report::conclude(std::string_view content, const Json& more) {
  const std::optional<std::string> expanded = expand(content, figures, more);
  if (!expanded) return;
  conclusion = printable(*expanded);
  figures["conclusion"] = *expanded;
}

void Report::append(const Report& part) {
  text += part.text;
  details += part.details;
}

void Report::line(std::string_view content, const Json& more) {
  if (const std::optional<std::string> expanded = expand(content, figures, more)) text += printable(*expanded) + "\n";
}

std::string to_text(const Report& report, bool with_details) {
  std::string text = report.text;
  if (with_details) text += report.details;
  return report.conclusion.empty() ? text : text + "\n" + report.conclusion + "\n";
}

std::string to_json(const Report& report, int indent) {
  return dump_json(report.figures, indent) + "\n";
}

Json list_json(const Eigen::VectorXd& values) {
  return std::vector<double>(values.begin(), values.end());
}

Json health_json(const Health& health) {
  return {{"verdict", to_string(health.verdict)},
          {"doubt", to_string(health.doubt)},
          {"offline_expected", health.offline_expected},
          {"offline_matches", health.offline_matches},
          {"offline_inliers", health.offline_inliers},
          {"online_inliers", health.online_inliers},
          {"suspended", health.suspended},
          {"inlier_share", health.inlier_share},
          {"spread", health.spread},
          {"agreement", agreement_json(health.agreement)},
          {"position_sigma_m", health.position_sigma},
          {"rotation_sigma_rad", health.rotation_sigma},
          {"distance_since_offline_m", health.distance_since_offline},
          {"seconds_since_offline", health.seconds_since_offline},
          {"focal_error_percent", 100.0 * health.focal_error},
          {"hidden_share", health.hidden_share},
          {"hidden_share_right", health.hidden_share_right},
          {"image", condition_json(health.image)}};
}

Json pose_json(const Pose& frame_from_body, const Matrix6& covariance) {
  return {{"position_m", list_json(frame_from_body.translation)},
          {"quaternion_xyzw", list_json(frame_from_body.rotation.coeffs())},
          {"body_covariance", list_json(covariance.reshaped<Eigen::RowMajor>())}};
}

Json position_json(const std::optional<Pose>& frame_from_body) {
  return frame_from_body ? list_json(frame_from_body->translation) : Json();
}

Json registration_json(const PlanRegistration& registration) {
  const auto& [scale, pose] = registration.plan_from_map;
  return {{"plan", registration.plan},
          {"scale", scale},
          {"translation_m", list_json(pose.translation)},
          {"quaternion_xyzw", list_json(pose.rotation.coeffs())},
          {"covariance", list_json(registration.covariance.reshaped<Eigen::RowMajor>())}};
}

double rounded_ms(double milliseconds) {
  return std::round(1e3 * milliseconds) / 1e3;
}

std::string dump_json(const Json& json, int indent) {
  return printable_json(json.dump(indent, ' ', false, Json::error_handler_t::replace));
}

}  // namespace byre
