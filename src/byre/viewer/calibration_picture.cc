#include "byre/viewer/calibration_picture.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/rectification.h"
#include "byre/input_error.h"
#include "byre/viewer/legend.h"
#include "byre/viewer/palette.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::Vector2d;

constexpr int kPlotSide = 520;  // pixels, longer side of an image; for all lengths in this file
constexpr int kPlotLeft = 56;
constexpr int kPlotTop = 64;
constexpr int kPlotBelow = 40;
constexpr double kPlotText = 12.0;
constexpr Colour kIdealGrid = palette::kPaths[0];
constexpr Colour kSourceGrid = palette::kPaths[2];
constexpr double kBeyond = 0.12;  // share of the ideal image that is drawn around it

// A camera, and the ideal camera that its images are resampled to.
struct IdealView {
  Camera camera;
  Rig rig;
  Eigen::Quaterniond camera_from_ideal;
};

using PixelMap = std::function<std::optional<Vector2d>(const Vector2d&)>;

std::optional<Vector2d> in_image(const IdealView& view, const Vector2d& ideal) {
  return view.camera.project(view.camera_from_ideal * view.rig.ray(ideal));
}

std::optional<Vector2d> in_ideal(const IdealView& view, const Vector2d& pixel) {
  constexpr double kMinForward = 0.05;  // cosine of the angle off the axis
  const auto bearing = view.camera.bearing(pixel);
  if (!bearing) return std::nullopt;
  const Eigen::Vector3d ray = view.camera_from_ideal.conjugate() * *bearing;
  if (ray.z() < kMinForward) return std::nullopt;
  return Vector2d(view.rig.focal * ray.head<2>() / ray.z() + Vector2d(view.rig.cx, view.rig.cy));
}

// Positions of grid lines of an image side: round numbers, and the last pixel.
std::vector<double> grid_positions(int side) {
  constexpr double kLines = 8.0;
  const double step = round_length(1.0, side / kLines);
  std::vector<double> positions;
  for (double at = 0.0; at < side - 1; at += step) positions.push_back(at);
  positions.push_back(side - 1);
  return positions;
}

// A straight line through a pixel map, in pieces where pixels have an image.
void add_mapped_line(const Vector2d& from, const Vector2d& to, const PixelMap& map, PictureLine line, Pane& pane) {
  constexpr int kSamples = 96;
  for (int i = 0; i <= kSamples; ++i) {
    const auto at = map(from + i / static_cast<double>(kSamples) * (to - from));
    if (at) line.points.push_back(*at);
    if (at && i < kSamples) continue;
    if (line.points.size() > 1) pane.marks.emplace_back(line);
    line.points.clear();
  }
}

// Regular grid of an image of this size through a pixel map; its border is wider.
void add_grid(int width, int height, const PixelMap& map, const Colour& colour, Pane& pane) {
  const auto line_at = [&](bool is_border) { return PictureLine{{}, colour, is_border ? 2.5 : 1.0}; };
  const double right = width - 1, bottom = height - 1;
  for (const double x : grid_positions(width)) {
    add_mapped_line({x, 0.0}, {x, bottom}, map, line_at(x == 0.0 || x == right), pane);
  }
  for (const double y : grid_positions(height)) {
    add_mapped_line({0.0, y}, {right, y}, map, line_at(y == 0.0 || y == bottom), pane);
  }
}

// Axes with ticks in pixels around a plot of width x height image pixels, whose first pixel is at a pane position.
void add_axes(int width, int height, const Vector2d& first, double scale, int plot_bottom, Pane& pane) {
  const auto add = [&](const Vector2d& at, double value, Align align) {
    pane.marks.emplace_back(PictureText{at, fmt::format("{:.0f}", value), kPlotText, palette::kFaint, align});
  };
  for (const double x : grid_positions(width)) {
    const bool is_close = x < width - 1 && scale * (width - 1 - x) < 36.0;
    if (!is_close) add({first.x() + scale * x, plot_bottom + 16.0}, x, Align::centre);
  }
  for (const double y : grid_positions(height)) {
    const bool is_close = y < height - 1 && scale * (height - 1 - y) < 14.0;
    if (!is_close) add({kPlotLeft - 6.0, first.y() + scale * y + 4.0}, y, Align::right);
  }
  pane.marks.emplace_back(
      PictureText{{kPlotLeft + 6.0, plot_bottom + 32.0}, "u [px]", kPlotText, palette::kFaint, Align::left});
  pane.marks.emplace_back(PictureText{{6.0, kPlotTop - 8.0}, "v [px]", kPlotText, palette::kFaint, Align::left});
}

// Angles off the axis at the middles of the sides.
void add_angles(int width, int height, const std::function<std::optional<Eigen::Vector3d>(const Vector2d&)>& bearing,
                const Vector2d& centre, const PixelMap& on_plot, Pane& pane) {
  const Vector2d last(width - 1, height - 1);
  const auto add = [&](const Vector2d& pixel, const Vector2d& shift, Align align) {
    const auto ray = bearing(pixel);
    const auto at = on_plot(pixel);
    if (!ray || !at) return;
    const double angle = std::acos(std::clamp(ray->normalized().z(), -1.0, 1.0)) / kDegree;
    pane.marks.emplace_back(
        PictureText{*at + shift, fmt::format("{:.1f} deg", angle), kPlotText, palette::kUntrusted, align, true});
  };
  add({0.0, centre.y()}, {6.0, -5.0}, Align::left);
  add({last.x(), centre.y()}, {-6.0, -5.0}, Align::right);
  add({centre.x(), 0.0}, {5.0, 16.0}, Align::left);
  add({centre.x(), last.y()}, {5.0, -6.0}, Align::left);
}

void add_cross(const Vector2d& at, Pane& pane) {
  pane.marks.emplace_back(
      PictureSymbols{"principal-point", Symbol::plus, {at}, 13.0, palette::kUntrusted, 1.0, palette::kPaper});
}

// Title, axes, and a plot that clips its marks, one above the other.
Picture framed(Pane frame, Pane plot, const std::string& title, const std::string& note) {
  frame.marks.emplace_back(PictureText{{kPlotLeft * 1.0, 22.0}, title, 14.0, palette::kInk, Align::left, true});
  frame.marks.emplace_back(PictureText{{kPlotLeft * 1.0, 41.0}, note, kPlotText, palette::kFaint, Align::left});
  Picture picture;
  picture.width = frame.width;
  picture.height = frame.height;
  plot.left = kPlotLeft;
  plot.top = kPlotTop;
  picture.panes = {std::move(frame), std::move(plot)};
  return picture;
}

Pane frame_around(const Pane& plot) {
  Pane frame;
  frame.width = kPlotLeft + plot.width + 28;
  frame.height = kPlotTop + plot.height + kPlotBelow;
  return frame;
}

std::string view_text(const std::optional<Eigen::Vector3d>& a, const std::optional<Eigen::Vector3d>& b) {
  if (!a || !b) return "?";
  return fmt::format("{:.1f}", std::acos(std::clamp(a->normalized().dot(b->normalized()), -1.0, 1.0)) / kDegree);
}

// Grid of the ideal camera in the image.
Picture image_picture(const IdealView& view, const std::string& name) {
  const Camera& camera = view.camera;
  const double scale = static_cast<double>(kPlotSide) / std::max(camera.width, camera.height);
  const auto on_plot = [&](const Vector2d& pixel) { return Vector2d(scale * (pixel + Vector2d::Constant(0.5))); };
  Pane plot;
  plot.width = static_cast<int>(std::lround(scale * camera.width));
  plot.height = static_cast<int>(std::lround(scale * camera.height));
  plot.background = palette::kWash;
  const PixelMap map = [&](const Vector2d& ideal) -> std::optional<Vector2d> {
    const auto pixel = in_image(view, ideal);
    return pixel ? std::optional(on_plot(*pixel)) : std::nullopt;
  };
  add_grid(view.rig.width, view.rig.height, map, kIdealGrid, plot);
  add_angles(
      camera.width, camera.height, [&](const Vector2d& pixel) { return camera.bearing(pixel); }, {camera.cx, camera.cy},
      [&](const Vector2d& pixel) { return std::optional(on_plot(pixel)); }, plot);
  add_cross(on_plot({camera.cx, camera.cy}), plot);
  Pane frame = frame_around(plot);
  add_axes(camera.width, camera.height, Vector2d(kPlotLeft, kPlotTop) + on_plot({0.0, 0.0}), scale,
           kPlotTop + plot.height, frame);
  const double right = camera.width - 1.0, bottom = camera.height - 1.0;
  const std::string note =
      fmt::format("{}x{}, view {} x {} deg", camera.width, camera.height,
                  view_text(camera.bearing({0.0, camera.cy}), camera.bearing({right, camera.cy})),
                  view_text(camera.bearing({camera.cx, 0.0}), camera.bearing({camera.cx, bottom})));
  return framed(std::move(frame), std::move(plot), name + ": " + std::string(to_string(camera.model)), note);
}

// Grid of the image in the ideal camera, with its surroundings.
Picture ideal_picture(const IdealView& view, const std::string& name) {
  const Rig& rig = view.rig;
  const double scale = kPlotSide / ((1.0 + 2.0 * kBeyond) * std::max(rig.width, rig.height));
  const Vector2d margin = kBeyond * Vector2d(rig.width, rig.height);
  const auto on_plot = [&](const Vector2d& pixel) {
    return Vector2d(scale * (pixel + margin + Vector2d::Constant(0.5)));
  };
  Pane plot;
  plot.width = static_cast<int>(std::lround(scale * (rig.width + 2.0 * margin.x())));
  plot.height = static_cast<int>(std::lround(scale * (rig.height + 2.0 * margin.y())));
  plot.background = palette::kWash;
  const PixelMap map = [&](const Vector2d& pixel) -> std::optional<Vector2d> {
    const auto ideal = in_ideal(view, pixel);
    return ideal ? std::optional(on_plot(*ideal)) : std::nullopt;
  };
  add_grid(view.camera.width, view.camera.height, map, kSourceGrid, plot);
  const Vector2d last(rig.width - 1, rig.height - 1);
  plot.marks.emplace_back(
      PictureLine{{on_plot({0, 0}), on_plot({last.x(), 0}), on_plot(last), on_plot({0, last.y()}), on_plot({0, 0})},
                  kIdealGrid,
                  2.5});
  const auto ray = [&](const Vector2d& pixel) { return std::optional<Eigen::Vector3d>(rig.ray(pixel)); };
  add_angles(
      rig.width, rig.height, ray, {rig.cx, rig.cy},
      [&](const Vector2d& pixel) { return std::optional(on_plot(pixel)); }, plot);
  add_cross(on_plot({rig.cx, rig.cy}), plot);
  Pane frame = frame_around(plot);
  add_axes(rig.width, rig.height, Vector2d(kPlotLeft, kPlotTop) + on_plot({0.0, 0.0}), scale, kPlotTop + plot.height,
           frame);
  const std::string note = fmt::format("{}x{}, focal length {:.1f} px, view {} x {} deg", rig.width, rig.height,
                                       rig.focal, view_text(ray({0.0, rig.cy}), ray({last.x(), rig.cy})),
                                       view_text(ray({rig.cx, 0.0}), ray({rig.cx, last.y()})));
  return framed(std::move(frame), std::move(plot), name + ", undistorted", note);
}

IdealView alone(const Camera& camera) {
  return {camera, rectification_of({.left = camera, .right = std::nullopt, .body_from_left = {}}).rig,
          Eigen::Quaterniond::Identity()};
}

std::vector<IdealView> ideal_views(const Calibration& calibration) {
  if (!calibration.right) return {alone(calibration.left)};
  try {
    const Rectification common = rectification_of(calibration);
    return {{calibration.left, common.rig, common.left_from_rectified},
            {calibration.right->camera, common.rig, common.right_from_rectified}};
  } catch (const InputError&) {
    return {alone(calibration.left), alone(calibration.right->camera)};
  }
}

}  // namespace

Picture calibration_picture(const Calibration& calibration, const std::string& title) {
  assert(calibration.left.width > 0 && (!calibration.right || calibration.right->camera.width > 0));
  Picture picture;
  for (const IdealView& view : ideal_views(calibration)) {
    const std::string name = picture.panes.empty() ? "left" : "right";
    const Picture column = vconcat(image_picture(view, name), ideal_picture(view, name));
    picture = picture.panes.empty() ? column : hconcat(std::move(picture), column);
  }
  Pane heading;
  heading.width = picture.width;
  heading.height = 36;
  heading.marks.emplace_back(PictureText{{16.0, 25.0}, title, 15.0, palette::kInk, Align::left, true});
  const Picture top{heading.width, heading.height, {heading}};
  const Pane signs = legend({{"pixels of the ideal camera, wide: its border", kIdealGrid, std::nullopt},
                             {"pixels of the image, wide: its border", kSourceGrid, std::nullopt},
                             {"principal point", palette::kUntrusted, Symbol::plus}},
                            "angles are off the optical axis", picture.width);
  return vconcat(vconcat(top, picture), Picture{signs.width, signs.height, {signs}});
}

}  // namespace byre
