#include "byre/viewer/camera_picture.h"

#include "byre/viewer/legend.h"
#include "byre/viewer/palette.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

constexpr int kHealthPanelWidth = 300;  // pixels
constexpr double kMargin = 16.0;        // pixels, for all lengths in this file
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

struct SeenKind {
  const char* name;
  const char* meaning;
  Origin origin;
  bool is_inlier;
  Symbol symbol;
};

// In drawing order.
constexpr std::array kKinds = {
    SeenKind{"online-outliers", "online outlier", Origin::online, false, Symbol::plus},
    SeenKind{"offline-outliers", "offline outlier", Origin::offline, false, Symbol::cross},
    SeenKind{"online-inliers", "online inlier", Origin::online, true, Symbol::diamond},
    SeenKind{"offline-inliers", "offline inlier", Origin::offline, true, Symbol::disc},
};

// Integer factor for small images; large images are reduced.
double scale_of(const Image& image) {
  constexpr double kNarrowest = 640.0, kWidest = 1280.0;  // pixels
  if (image.width < kNarrowest) return std::ceil(kNarrowest / image.width);
  return std::min(1.0, kWidest / image.width);
}

// The centre of an image pixel is half a pixel from its corner.
Eigen::Vector2d on_pane(const Eigen::Vector2f& pixel, double scale) {
  return scale * (pixel.cast<double>() + Eigen::Vector2d::Constant(0.5));
}

PictureSymbols symbols_of(const std::vector<SeenPoint>& seen, const SeenKind& kind, double scale) {
  PictureSymbols symbols;
  symbols.name = kind.name;
  symbols.symbol = kind.symbol;
  symbols.size = kind.is_inlier ? 6.0 : 9.0;
  symbols.colour = palette::of(kind.origin);
  symbols.rim = palette::kPaper;
  for (const SeenPoint& point : seen) {
    if (point.point.origin == kind.origin && point.is_inlier == kind.is_inlier) {
      symbols.centres.push_back(on_pane(point.pixel, scale));
    }
  }
  return symbols;
}

Pane image_pane(const FrameScene& scene, int width) {
  const double scale = width > 0 ? static_cast<double>(width) / scene.left.width : scale_of(scene.left);
  Pane pane;
  pane.width = static_cast<int>(std::lround(scale * scene.left.width));
  pane.height = static_cast<int>(std::lround(scale * scene.left.height));
  PictureImage image;
  image.image = std::make_shared<const Image>(scene.left);
  image.pane_from_image << scale, 0.0, 0.5 * scale, 0.0, scale, 0.5 * scale;
  pane.background = palette::kWash;
  pane.marks.emplace_back(std::move(image));
  for (const SeenKind& kind : kKinds) pane.marks.emplace_back(symbols_of(scene.seen, kind, scale));
  return pane;
}

Pane seen_legend(int width) {
  std::vector<LegendEntry> entries;
  for (const SeenKind& kind : kKinds) entries.push_back({kind.meaning, palette::of(kind.origin), kind.symbol});
  std::ranges::reverse(entries);
  Pane pane = legend(entries, "", width);
  pane.background = palette::kWash;
  return pane;
}

Picture picture_of(Pane pane) {
  Picture picture;
  picture.width = pane.width;
  picture.height = pane.height;
  picture.panes.push_back(std::move(pane));
  return picture;
}

// Extends the panes to the bottom of the picture.
Picture filled_up(Picture picture) {
  for (Pane& pane : picture.panes) {
    const bool is_last = std::ranges::none_of(
        picture.panes, [&pane](const Pane& other) { return other.left == pane.left && other.top > pane.top; });
    if (is_last) pane.height = picture.height - pane.top;
  }
  return picture;
}

// State, verdict and doubt of a frame, and a meter per health measure with a tick at its limit.
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

}  // namespace

Picture camera_picture(const FrameScene& scene, const CameraPictureOptions& options) {
  assert(scene.left.width > 0 && scene.left.height > 0);
  Picture picture = picture_of(image_pane(scene, options.width));
  if (!options.panel) return picture;
  const FrameReport& report = scene.report;
  Picture panel = vconcat(picture_of(health_panel(options.title, report.state, report.health, options.health)),
                          picture_of(seen_legend(kHealthPanelWidth)));
  return filled_up(hconcat(std::move(picture), panel));
}

}  // namespace byre
