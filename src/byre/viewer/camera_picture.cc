#include "byre/viewer/camera_picture.h"

#include "byre/viewer/health_panel.h"
#include "byre/viewer/legend.h"
#include "byre/viewer/palette.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>

namespace byre {
namespace {

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

Pane image_pane(const FrameScene& scene) {
  const double scale = scale_of(scene.left);
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

}  // namespace

Picture camera_picture(const FrameScene& scene, const CameraPictureOptions& options) {
  assert(scene.left.width > 0 && scene.left.height > 0);
  Picture picture = picture_of(image_pane(scene));
  if (!options.panel) return picture;
  const FrameReport& report = scene.report;
  Picture panel = vconcat(picture_of(health_panel(options.title, report.state, report.health, options.health)),
                          picture_of(seen_legend(kHealthPanelWidth)));
  return filled_up(hconcat(std::move(picture), panel));
}

}  // namespace byre
