#include "byre/viewer/plan_picture.h"

#include "byre/viewer/legend.h"
#include "byre/viewer/plan_view.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

PlanView view_of(const PlanScene& scene, const PlanPictureOptions& options) {
  PlanView view;
  view.shown = options.shown ? *options.shown : shown_ground(scene, options.heights);
  const Vector2d size = view.shown.sizes();
  view.pixels_per_metre = std::min(options.width / size.x(), options.height / size.y());
  view.ground_from_map = scene.ground.ground_from_map;
  return view;
}

bool is_in(const HeightBand& heights, double height) {
  return height >= heights.low && height <= heights.high;
}

// Points on the ground; on level ground only those in the height band.
std::vector<Vector2d> points_on_ground(const PlanScene& scene, const HeightBand& heights, Origin origin) {
  std::vector<Vector2d> points;
  for (const ScenePoint& point : scene.map.points) {
    if (point.origin != origin) continue;
    const Eigen::Vector3d on_ground = scene.ground.ground_from_map * point.position_in_map.cast<double>();
    if (scene.ground.is_level && !is_in(heights, on_ground.z())) continue;
    points.emplace_back(on_ground.head<2>());
  }
  return points;
}

// Range without one per cent of the values at each end.
std::pair<double, double> usual_range(std::vector<double> values) {
  constexpr double kUnusual = 0.01;
  const auto skipped = static_cast<std::ptrdiff_t>(kUnusual * static_cast<double>(values.size()));
  std::ranges::nth_element(values, values.begin() + skipped);
  const double low = values[static_cast<std::size_t>(skipped)];
  std::ranges::nth_element(values, values.end() - 1 - skipped);
  return {low, *(values.end() - 1 - skipped)};
}

AlignedBox2d usual_box(const std::vector<Vector2d>& points) {
  if (points.empty()) return {};
  std::vector<double> x, y;
  for (const Vector2d& point : points) {
    x.push_back(point.x());
    y.push_back(point.y());
  }
  const auto [left, right] = usual_range(std::move(x));
  const auto [bottom, top] = usual_range(std::move(y));
  return {Vector2d(left, bottom), Vector2d(right, top)};
}

AlignedBox2d box_of_plan(const FloorPlan& plan) {
  AlignedBox2d box;
  for (const double column : {-0.5, plan.width - 0.5}) {
    for (const double row : {-0.5, plan.height - 0.5}) box.extend(plan.point_at({column, row}));
  }
  return box;
}

AlignedBox2d box_of_map(const PlanScene& scene, const HeightBand& heights) {
  AlignedBox2d box;
  const Similarity& ground_from_map = scene.ground.ground_from_map;
  for (const Origin origin : {Origin::offline, Origin::online}) {
    box.extend(usual_box(points_on_ground(scene, heights, origin)));
  }
  for (const SceneKeyframe& keyframe : scene.map.keyframes) {
    box.extend((ground_from_map * keyframe.map_from_body.translation).head<2>());
  }
  for (const PlanPath& path : scene.paths) {
    for (const StampedPose& sample : path.map_from_body)
      box.extend((ground_from_map * sample.world_from_body.translation).head<2>());
  }
  if (box.isEmpty()) box.extend(Vector2d::Zero());
  return box;
}

AlignedBox2d with_margin(const AlignedBox2d& box, double share) {
  constexpr double kMin = 0.5;  // metres
  const double margin = std::max(kMin, share * box.sizes().maxCoeff());
  return {box.min() - Vector2d::Constant(margin), box.max() + Vector2d::Constant(margin)};
}

// Merges points that coincide at half a pixel.
std::vector<Vector2d> distinct_pixels(const std::vector<Vector2d>& on_ground, const PlanView& view, const Pane& pane) {
  std::vector<std::pair<int, int>> cells;
  for (const Vector2d& point : on_ground) {
    const Vector2d pixel = view.pixel(point);
    if (pixel.x() < 0.0 || pixel.y() < 0.0 || pixel.x() > pane.width || pixel.y() > pane.height) continue;
    cells.emplace_back(static_cast<int>(std::lround(2.0 * pixel.y())), static_cast<int>(std::lround(2.0 * pixel.x())));
  }
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::vector<Vector2d> pixels;
  for (const auto& [y, x] : cells) pixels.emplace_back(0.5 * x, 0.5 * y);
  return pixels;
}

PictureSymbols dots(const PlanScene& scene, const HeightBand& heights, Origin origin, const PlanView& view,
                    const Pane& pane) {
  PictureSymbols dots;
  dots.name = origin == Origin::offline ? "offline-points" : "online-points";
  dots.symbol = Symbol::square;
  dots.centres = distinct_pixels(points_on_ground(scene, heights, origin), view, pane);
  dots.size = 1.5;
  dots.colour = scene.style_of(origin).colour;
  dots.opacity = origin == Origin::offline ? 0.7 : 0.85;
  return dots;
}

// Grid that shows the scale without a plan.
std::vector<PictureMark> grid(const PlanView& view, const Pane& pane) {
  constexpr double kStep = 140.0;  // pixels, largest
  const double step = round_length(view.pixels_per_metre, kStep);
  std::vector<PictureMark> lines;
  for (double x = std::ceil(view.shown.min().x() / step) * step; x < view.shown.max().x(); x += step) {
    const double column = view.pixel({x, 0.0}).x();
    lines.emplace_back(PictureLine{{{column, 0.0}, {column, static_cast<double>(pane.height)}}, palette::kRule, 0.5});
  }
  for (double y = std::ceil(view.shown.min().y() / step) * step; y < view.shown.max().y(); y += step) {
    const double row = view.pixel({0.0, y}).y();
    lines.emplace_back(PictureLine{{{0.0, row}, {static_cast<double>(pane.width), row}}, palette::kRule, 0.5});
  }
  return lines;
}

void append(MarksWithLegend more, Pane& pane, std::vector<LegendEntry>& entries) {
  std::ranges::move(more.marks, std::back_inserter(pane.marks));
  std::ranges::move(more.legend, std::back_inserter(entries));
}

// Ground and content; later marks cover earlier ones.
MarksWithLegend ground_marks(const PlanScene& scene, const PlanPictureOptions& options, const PlanView& view,
                             const Pane& pane) {
  MarksWithLegend all;
  if (scene.ground.image) all.marks.emplace_back(ground_image(scene.ground, view));
  if (!scene.ground.image) all.marks = grid(view, pane);
  for (const Origin origin : {Origin::offline, Origin::online}) {
    PictureSymbols points = dots(scene, options.heights, origin, view, pane);
    if (points.centres.empty()) continue;
    const PointStyle& style = scene.style_of(origin);
    all.legend.push_back({style.meaning, style.colour, Symbol::square});
    all.marks.emplace_back(std::move(points));
  }
  return all;
}

std::string note_on(const PlanScene& scene, const HeightBand& heights) {
  if (!scene.ground.is_level) return "Map points of all heights.";
  const char* const above = scene.ground.plan ? "the floor" : "the driving plane";
  return fmt::format("Map points from {:.1f} to {:.1f} m above {}.", heights.low, heights.high, above);
}

std::vector<LegendEntry> whole_legend() {
  std::vector<LegendEntry> entries = {{"offline map", palette::kOffline, Symbol::square},
                                      {"online map", palette::kOnline, Symbol::square},
                                      {"keyframes", palette::kKeyframe, Symbol::disc},
                                      {"start", palette::kInk, Symbol::triangle},
                                      {"camera", palette::kCamera, Symbol::disc}};
  for (const Verdict verdict : {Verdict::trusted, Verdict::degraded, Verdict::untrusted}) {
    entries.push_back(verdict_entry(verdict));
  }
  return entries;
}

// Title and size of the scene.
Pane head(const PlanScene& scene, const PlanView& view, int width) {
  constexpr double kBorder = 16.0, kLine = 25.0, kTitle = 16.0;  // pixels
  Pane pane;
  pane.width = width;
  pane.height = 38;
  pane.marks.emplace_back(PictureText{{kBorder, kLine}, scene.title, kTitle, palette::kInk, Align::left, true});
  const std::vector<PictureMark> bar =
      scale_bar({width - kBorder, kLine}, view.pixels_per_metre, scene.ground.is_metric);
  pane.marks.insert(pane.marks.end(), bar.begin(), bar.end());
  return pane;
}

Picture stacked(std::vector<Pane> panes) {
  Picture picture;
  for (Pane& pane : panes) {
    pane.top = picture.height;
    picture.width = std::max(picture.width, pane.width);
    picture.height += pane.height;
    picture.panes.push_back(std::move(pane));
  }
  return picture;
}

}  // namespace

PictureImage ground_image(const Ground& ground, const PlanView& view) {
  constexpr double kFaded = 0.55;  // keeps walls visible in the background
  PictureImage image;
  image.image = ground.image;
  Eigen::Matrix2d pixels_from_metres = view.pixels_per_metre * Eigen::Matrix2d::Identity();
  pixels_from_metres(1, 1) *= -1.0;
  image.pane_from_image.leftCols<2>() = pixels_from_metres * ground.plan->metres_per_pixel;
  image.pane_from_image.col(2) = view.pixel(ground.plan->top_left_in_plan);
  image.opacity = kFaded;
  return image;
}

PlanCamera plan_camera(const Pose& map_from_body, const Rig& rig) {
  return {map_from_body * rig.body_from_camera, 2.0 * std::atan2(0.5 * rig.width, rig.focal)};
}

AlignedBox2d shown_ground(const PlanScene& scene, const HeightBand& heights) {
  constexpr double kMarginShare = 0.04;  // margin as a share of the larger side
  constexpr double kSiteMargin = 0.2;    // margin around a part of a large plan, as a share of the larger side
  constexpr double kSite = 4.0;          // smallest large plan, in lengths of the map
  const AlignedBox2d of_map = box_of_map(scene, heights);
  if (!scene.ground.plan) return with_margin(of_map, kMarginShare);
  const AlignedBox2d of_plan = box_of_plan(*scene.ground.plan);
  if (of_plan.sizes().maxCoeff() > kSite * of_map.sizes().maxCoeff()) return with_margin(of_map, kSiteMargin);
  AlignedBox2d both = of_plan;
  for (const PlanPath& path : scene.paths) {
    for (const StampedPose& sample : path.map_from_body)
      both.extend((scene.ground.ground_from_map * sample.world_from_body.translation).head<2>());
  }
  return both;
}

Picture plan_picture(const PlanScene& scene, const PlanPictureOptions& options) {
  constexpr int kNarrowest = 420;  // pixels, for the legend
  const PlanView view = view_of(scene, options);
  Pane pane;
  pane.width = std::max(kNarrowest, static_cast<int>(std::lround(view.pixels_per_metre * view.shown.sizes().x())));
  pane.height = static_cast<int>(std::lround(view.pixels_per_metre * view.shown.sizes().y()));
  std::vector<LegendEntry> entries;
  append(ground_marks(scene, options, view, pane), pane, entries);
  if (options.keyframes) append(keyframe_marks(scene.map, view), pane, entries);
  append(path_marks(scene.paths, view), pane, entries);
  if (scene.camera) append(camera_marks(*scene.camera, view), pane, entries);
  if (options.whole_legend) entries = whole_legend();
  const int width = pane.width;
  return stacked({head(scene, view, width), std::move(pane), legend(entries, note_on(scene, options.heights), width)});
}

}  // namespace byre
