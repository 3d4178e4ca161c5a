#include "byre/benchmark/demo/timeline.h"

#include "byre/benchmark/demo/table.h"
#include "byre/benchmark/plots.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

// Pixels. Panels are stacked vertically.
constexpr double kWidth = 1000.0, kLeft = 96.0, kRight = 16.0;
constexpr double kTitle = 30.0;  // above a panel
constexpr double kBand = 16.0, kBandGap = 6.0;
constexpr double kBandsTop = kTitle, kPointsTop = 116.0, kErrorsTop = 306.0;
constexpr double kPointsHeight = 150.0, kErrorsHeight = 190.0;
constexpr double kBottom = kErrorsTop + kErrorsHeight;
constexpr double kHeight = kBottom + 44.0;
constexpr double kMinError = 1e-3, kMaxError = 30.0;  // range of the error axis, metres
constexpr double kLongestGap_s = 0.5;                 // longest time between frames of a line without a gap

struct TimeAxis {
  double duration_s = 1.0;

  double x(double time_s) const { return kLeft + (kWidth - kLeft - kRight) * time_s / duration_s; }
};

TimeAxis time_axis(const DemoFindings& findings) {
  TimeAxis axis;
  for (const DemoArm& arm : findings.arms) {
    if (!arm.moments.empty()) axis.duration_s = std::max(axis.duration_s, arm.moments.back().time_s);
  }
  return axis;
}

std::string text_at(double x, double y, const std::string& text, const char* classes) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">", x, y, classes) + text + "</text>\n";
}

std::string rectangle(double x, double y, double width, double height, const char* classes) {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"{}\"/>\n", x, y, width,
                     height, classes);
}

std::string grid_line(double x1, double y1, double x2, double y2) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"grid\"/>\n", x1, y1, x2,
                     y2);
}

std::string class_of(const DemoMoment& moment) {
  return moment.has_pose ? std::string(to_string(moment.verdict)) : "none";
}

// One bar per run of equal verdicts, to limit the number of elements.
std::string verdict_band(const DemoArm& arm, double top, const TimeAxis& axis) {
  std::string svg = text_at(kLeft - 8.0, top + 12.5, shown_name(arm.arm), "end");
  for (std::size_t begin = 0; begin < arm.moments.size();) {
    const std::string shown = class_of(arm.moments[begin]);
    std::size_t end = begin;
    while (end < arm.moments.size() && class_of(arm.moments[end]) == shown) ++end;
    const double until = end < arm.moments.size() ? arm.moments[end].time_s : axis.duration_s;
    const double x = axis.x(arm.moments[begin].time_s);
    svg += rectangle(x, top, axis.x(until) - x, kBand, shown.c_str());
    begin = end;
  }
  return svg;
}

std::string verdicts_panel(const DemoFindings& findings, const TimeAxis& axis) {
  std::string svg = text_at(kLeft, kBandsTop - 12.0, "Verdict on each frame", "title");
  double top = kBandsTop;
  for (const DemoArm& arm : findings.arms) {
    if (arm.arm == Arm::no_map) continue;  // its verdicts do not concern the plan
    svg += verdict_band(arm, top, axis);
    top += kBand + kBandGap;
  }
  return svg;
}

// Vertical axis of a panel, from the lowest value at its bottom.
struct ValueAxis {
  double top = 0.0;
  double height = 0.0;
  double least = 0.0;  // log10 of the value on a logarithmic axis
  double most = 1.0;

  double y(double drawn) const { return top + height * (most - std::clamp(drawn, least, most)) / (most - least); }
};

// Line through the non-empty values of the moments, with gaps at empty ones.
std::string line_of(const std::vector<DemoMoment>& moments, const std::function<Figure(const DemoMoment&)>& value,
                    const ValueAxis& values, const TimeAxis& axis, std::string_view kind) {
  std::string path;
  double last_s = -1e9;
  for (const DemoMoment& moment : moments) {
    const Figure drawn = value(moment);
    if (!drawn) continue;
    const char command = moment.time_s - last_s > kLongestGap_s ? 'M' : 'L';
    path += fmt::format("{:c}{:.1f} {:.1f}", command, axis.x(moment.time_s), values.y(*drawn));
    last_s = moment.time_s;
  }
  if (path.empty()) return "";
  return "<path class=\"line " + std::string(kind) + "\" d=\"" + path + "\"/>\n";
}

std::string value_grid(const ValueAxis& values, double drawn, const std::string& label) {
  const double y = values.y(drawn);
  return grid_line(kLeft, y, kWidth - kRight, y) + text_at(kLeft - 8.0, y + 4.0, label, "end");
}

const DemoArm* find_arm(const DemoFindings& findings, Arm wanted) {
  const auto found = std::ranges::find(findings.arms, wanted, &DemoArm::arm);
  return found != findings.arms.end() ? &*found : nullptr;
}

std::string points_panel(const DemoFindings& findings, const TimeAxis& axis) {
  const DemoArm* const hybrid = find_arm(findings, Arm::hybrid);
  if (hybrid == nullptr) return "";
  ValueAxis values{kPointsTop, kPointsHeight, 0.0, 10.0};
  for (const DemoMoment& moment : hybrid->moments) {
    values.most = std::max({values.most, 1.05 * moment.offline_inliers, 1.05 * moment.online_inliers});
  }
  std::string svg = text_at(kLeft, kPointsTop - 12.0, "Inliers of the hybrid run", "title");
  for (const double tick : round_ticks(0.0, 2.0 * values.most)) {
    if (tick <= values.most) svg += value_grid(values, tick, fmt::format("{:.0f}", tick));
  }
  const auto offline = [](const DemoMoment& moment) { return Figure(moment.offline_inliers); };
  const auto online = [](const DemoMoment& moment) { return Figure(moment.online_inliers); };
  return svg + line_of(hybrid->moments, online, values, axis, "online") +
         line_of(hybrid->moments, offline, values, axis, "offline");
}

std::string errors_panel(const DemoFindings& findings, const TimeAxis& axis) {
  const ValueAxis values{kErrorsTop, kErrorsHeight, std::log10(kMinError), std::log10(kMaxError)};
  std::string svg = text_at(kLeft, kErrorsTop - 12.0, "Error of published positions", "title");
  for (const auto& [metres, label] :
       {std::pair(1e-3, "1 mm"), {1e-2, "1 cm"}, {1e-1, "10 cm"}, {1.0, "1 m"}, {10.0, "10 m"}}) {
    svg += value_grid(values, std::log10(metres), label);
  }
  const auto error = [](const DemoMoment& moment) {
    return moment.error ? Figure(std::log10(std::max(*moment.error, kMinError))) : Figure();
  };
  const auto sigma = [](const DemoMoment& moment) {
    const bool is_known = moment.has_pose && moment.position_sigma > 0.0;
    return is_known ? Figure(std::log10(std::max(moment.position_sigma, kMinError))) : Figure();
  };
  for (const DemoArm& arm : findings.arms) svg += line_of(arm.moments, error, values, axis, name_of(arm.arm));
  const DemoArm* const hybrid = find_arm(findings, Arm::hybrid);
  return hybrid == nullptr ? svg : svg + line_of(hybrid->moments, sigma, values, axis, "sigma");
}

// Background of the panels: time grid and spans off the map.
std::string background(const DemoFindings& findings, const TimeAxis& axis) {
  std::string svg;
  for (const TimeSpan& span : findings.off_the_map) {
    const double x = axis.x(span.begin_s);
    const double width = axis.x(span.end_s) - x;
    svg += rectangle(x, kBandsTop - 8.0, width, kBottom - kBandsTop + 8.0, "off");
    svg += text_at(x + 0.5 * width, kErrorsTop + 18.0, "off the map", "middle faint");
  }
  for (const double tick : round_ticks(0.0, axis.duration_s)) {
    const double x = axis.x(tick);
    for (const auto& [top, height] : {std::pair(kPointsTop, kPointsHeight), {kErrorsTop, kErrorsHeight}}) {
      svg += grid_line(x, top, x, top + height);
    }
    svg += text_at(x, kBottom + 18.0, fmt::format("{:g}", tick), "middle");
  }
  return svg + text_at(0.5 * (kLeft + kWidth - kRight), kBottom + 38.0, "seconds", "middle");
}

}  // namespace

std::string demo_timeline(const DemoFindings& findings) {
  const TimeAxis axis = time_axis(findings);
  return fmt::format("<svg class=\"timeline\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" ", kWidth, kHeight) +
         "aria-label=\"Verdicts, points and errors over time\">\n" + background(findings, axis) +
         verdicts_panel(findings, axis) + points_panel(findings, axis) + errors_panel(findings, axis) + "</svg>\n";
}

}  // namespace byre
