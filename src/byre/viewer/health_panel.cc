#include "byre/viewer/health_panel.h"

#include "byre/viewer/palette.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::Vector2d;

constexpr double kMargin = 16.0;  // pixels, for all lengths in this file
constexpr double kRight = kHealthPanelWidth - kMargin;
constexpr double kTextSize = 13.0;
constexpr double kMeterRow = 36.0;

// Measure with its value as text and as a bar.
struct Meter {
  std::string name;
  std::string value;
  double filled = 0.0;            // filled share of the bar, 0 to 1
  std::optional<double> limit{};  // position of the tick on the bar, 0 to 1
  Colour colour = palette::kKeyframe;
};

PictureArea box(double left, double top, double width, double height, const Colour& colour) {
  return {{{left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}}, colour};
}

PictureText text(double x, double y, std::string content, const Colour& colour, Align align = Align::left) {
  return {{x, y}, std::move(content), kTextSize, colour, align};
}

std::vector<PictureMark> marks_of(const Meter& meter, double top) {
  constexpr double kBar = 6.0, kBarTop = 20.0, kWidth = kRight - kMargin;
  std::vector<PictureMark> marks;
  marks.emplace_back(text(kMargin, top + 13.0, meter.name, palette::kInk));
  marks.emplace_back(text(kRight, top + 13.0, meter.value, palette::kInk, Align::right));
  marks.emplace_back(box(kMargin, top + kBarTop, kWidth, kBar, palette::kRule));
  const double filled = std::clamp(meter.filled, 0.0, 1.0) * kWidth;
  if (filled > 0.0) marks.emplace_back(box(kMargin, top + kBarTop, filled, kBar, meter.colour));
  if (!meter.limit) return marks;
  const double at = kMargin + std::clamp(*meter.limit, 0.0, 1.0) * kWidth;
  marks.emplace_back(PictureLine{{{at, top + kBarTop - 2.0}, {at, top + kBarTop + kBar + 2.0}}, palette::kInk, 1.5});
  return marks;
}

// Side of the limit on which a measure is good.
enum class Good : std::uint8_t { high, low };

Meter limited(std::string name, std::string value, double measured, double limit, double whole, Good good) {
  const bool is_past = good == Good::high ? measured < limit : measured > limit;
  return {std::move(name), std::move(value), measured / whole, limit / whole,
          is_past ? palette::kDegraded : palette::kKeyframe};
}

std::string metres(double length) {
  constexpr double kCentimetres = 100.0;
  return length < 1.0 ? fmt::format("{:.1f} cm", kCentimetres * length) : fmt::format("{:.1f} m", length);
}

Meter agreement_meter(const Health& health, double limit) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  constexpr const char* kName = "maps agree to";
  if (!health.agreement) return {kName, "-", 0.0, 0.5};
  const Agreement& agreement = *health.agreement;
  const std::string value = fmt::format("{}, {:.2f} deg", metres(agreement.translation), kDegrees * agreement.rotation);
  return limited(kName, value, agreement.translation, limit, 2.0 * limit, Good::low);
}

std::vector<Meter> meters_of(const Health& health, const HealthOptions& limits) {
  constexpr double kManyPoints = 200.0, kWideSpread = 0.25;
  const double sigma_limit = limits.trusted_error / limits.sigmas;
  const double way_limit = limits.trusted_error / limits.drift_share;
  const std::string expected = health.offline_expected > 0 ? " of " + std::to_string(health.offline_expected) : "";
  return {
      {"offline inliers", std::to_string(health.offline_inliers) + expected, health.offline_inliers / kManyPoints,
       limits.min_offline_points / kManyPoints, palette::kOffline},
      {"online inliers",
       std::to_string(health.online_inliers),
       health.online_inliers / kManyPoints,
       {},
       palette::kOnline},
      {"inlier share", fmt::format("{:.0f} %", 100.0 * health.inlier_share), health.inlier_share},
      limited("spread in the image", fmt::format("{:.1f} %", 100.0 * health.spread), health.spread, limits.min_spread,
              kWideSpread, Good::high),
      limited("position sigma", metres(health.position_sigma), health.position_sigma, sigma_limit, 2.0 * sigma_limit,
              Good::low),
      agreement_meter(health, limits.max_disagreement),
      limited("path since offline points", metres(health.distance_since_offline), health.distance_since_offline,
              way_limit, 1.25 * way_limit, Good::low),
  };
}

Symbol symbol_of(Verdict verdict) {
  if (verdict == Verdict::trusted) return Symbol::disc;
  return verdict == Verdict::degraded ? Symbol::triangle : Symbol::cross;
}

// Verdict on its colour, with the doubt below.
std::vector<PictureMark> verdict_marks(const Health& health, double top) {
  constexpr double kHeight = 34.0;
  std::vector<PictureMark> marks;
  marks.emplace_back(box(kMargin, top, kRight - kMargin, kHeight, palette::of(health.verdict)));
  marks.emplace_back(PictureSymbols{
      "verdict", symbol_of(health.verdict), {{kMargin + 18.0, top + 0.5 * kHeight}}, 13.0, palette::kPaper});
  marks.emplace_back(PictureText{
      {kMargin + 36.0, top + 22.5}, std::string(to_string(health.verdict)), 16.0, palette::kPaper, Align::left, true});
  const std::string doubt(health.doubt == DistrustReason::none ? "no doubt" : to_string(health.doubt));
  const Colour colour = health.doubt == DistrustReason::none ? palette::kFaint : palette::kInk;
  marks.emplace_back(text(kMargin, top + kHeight + 19.0, doubt, colour));
  return marks;
}

}  // namespace

Pane health_panel(const std::string& title, State state, const Health& health, const HealthOptions& limits) {
  constexpr double kTitleLine = 27.0, kVerdictTop = 42.0, kMetersTop = 106.0;
  Pane pane;
  pane.width = kHealthPanelWidth;
  pane.background = palette::kWash;
  pane.marks.emplace_back(PictureText{{kMargin, kTitleLine}, title, kTextSize, palette::kInk, Align::left, true});
  pane.marks.emplace_back(text(kRight, kTitleLine, std::string(to_string(state)), palette::kInk, Align::right));
  std::ranges::move(verdict_marks(health, kVerdictTop), std::back_inserter(pane.marks));
  double top = kMetersTop;
  for (const Meter& meter : meters_of(health, limits)) {
    std::ranges::move(marks_of(meter, top), std::back_inserter(pane.marks));
    top += kMeterRow;
  }
  pane.height = static_cast<int>(std::lround(top));
  return pane;
}

}  // namespace byre
