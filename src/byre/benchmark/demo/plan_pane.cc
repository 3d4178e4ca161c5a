#include "byre/benchmark/demo/plan_pane.h"

#include "byre/viewer/camera_picture.h"
#include "byre/viewer/palette.h"
#include "byre/viewer/plan_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::Vector2d;

constexpr Colour kTruthBand{176, 190, 208};
constexpr Colour kMoved{150, 85, 10};
constexpr Colour kUnmapped{206, 213, 226};
constexpr double kOffMetres = 1.0;  // from this error on a position is shown as wrong

// Positions of a range of errors.
struct ErrorClass {
  double most = 0.0;  // metres
  const char* meaning = "";
  Symbol symbol = Symbol::disc;
  Colour colour;
};
constexpr std::array kErrorClasses = {
    ErrorClass{kCloseMetres, "position within 10 cm of the truth", Symbol::disc, palette::kOffline},
    ErrorClass{kOffMetres, "off by 10 cm to 1 m", Symbol::diamond, palette::kDegraded},
    ErrorClass{1e9, "off by more than 1 m (line: to the true place)", Symbol::cross, palette::kUntrusted},
};

const ErrorClass& class_of(double error) {
  return *std::ranges::find_if(kErrorClasses, [error](const ErrorClass& each) { return error <= each.most; });
}

std::vector<Vector2d> on_pane(const PlanView& view, std::vector<Vector2d> points) {
  for (Vector2d& point : points) point = view.pixel(point);
  return points;
}

std::vector<Vector2d> closed(std::vector<Vector2d> corners) {
  corners.push_back(corners.front());
  return corners;
}

// Parallel strokes in a convex area, at 45 degrees.
std::vector<PictureMark> hatching(const std::vector<Vector2d>& corners, double step) {
  const Vector2d across = Vector2d(1.0, 1.0).normalized();
  double low = 1e9, high = -1e9;
  for (const Vector2d& corner : corners) {
    low = std::min(low, across.dot(corner));
    high = std::max(high, across.dot(corner));
  }
  std::vector<PictureMark> strokes;
  for (double offset = low + 0.5 * step; offset < high; offset += step) {
    PictureLine stroke{{}, kMoved, 1.5};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2d& from = corners[i];
      const Vector2d& to = corners[(i + 1) % corners.size()];
      const double before = across.dot(from) - offset, after = across.dot(to) - offset;
      if ((before < 0.0) != (after < 0.0)) stroke.points.emplace_back(from + before / (before - after) * (to - from));
    }
    if (stroke.points.size() == 2) strokes.emplace_back(std::move(stroke));
  }
  return strokes;
}

void append(std::vector<PictureMark> more, std::vector<PictureMark>& marks) {
  std::ranges::move(more, std::back_inserter(marks));
}

std::vector<PictureMark> place_before(const std::vector<Vector2d>& corners) {
  return {PictureLine{closed(corners), palette::kFaint, 1.0, Stroke::dotted}};
}

std::vector<PictureMark> place_after(const std::vector<Vector2d>& corners) {
  constexpr double kStep = 5.0;  // pixels
  std::vector<PictureMark> marks = {PictureArea{corners, palette::kPaper}};
  append(hatching(corners, kStep), marks);
  marks.emplace_back(PictureLine{closed(corners), kMoved, 1.5});
  return marks;
}

std::vector<PictureMark> moved_marks(const std::vector<MovedThing>& moved, const PlanView& view) {
  std::vector<PictureMark> marks;
  for (const MovedThing& thing : moved) append(place_before(on_pane(view, thing.before)), marks);
  for (const MovedThing& thing : moved) append(place_after(on_pane(view, thing.after)), marks);
  return marks;
}

PictureArea shade(const Eigen::AlignedBox2d& area, const PlanView& view) {
  const Vector2d low = view.pixel(area.min()), high = view.pixel(area.max());
  return {{low, {high.x(), low.y()}, high, {low.x(), high.y()}}, kUnmapped};
}

std::vector<PictureMark> label_marks(const std::vector<PlanLabel>& labels, const PlanView& view) {
  const double size = std::clamp(0.45 * view.pixels_per_metre, 10.0, 15.0);
  std::vector<PictureMark> marks;
  for (const PlanLabel& label : labels) {
    marks.emplace_back(PictureText{view.pixel(label.at), label.text, size, palette::kFaint, Align::centre});
  }
  return marks;
}

// Positions of one range of errors; hollow if they have no place on the plan.
PictureSymbols position_symbols(const ErrorClass& shown, std::vector<Vector2d> centres, double size, bool is_hollow) {
  PictureSymbols symbols;
  symbols.name = "positions";
  symbols.symbol = shown.symbol;
  symbols.centres = std::move(centres);
  symbols.size = shown.symbol == Symbol::disc ? size : 1.4 * size;
  symbols.colour = is_hollow ? palette::kPaper : shown.colour;
  if (is_hollow) symbols.rim = shown.colour;
  return symbols;
}

std::vector<PictureMark> position_marks(const std::vector<DemoMoment>& moments, const PlanView& view, bool is_on_plan) {
  constexpr double kMetres = 0.14;  // size of a position on the plan
  constexpr int kEvery = 4;         // one of so many wrong positions is joined to its true place
  constexpr double kStep = 2.2;     // distance of hollow positions, in sizes
  const double size = std::clamp(kMetres * view.pixels_per_metre, 3.0, 6.0);
  std::array<std::vector<Vector2d>, kErrorClasses.size()> centres;
  std::vector<PictureMark> marks;
  int wrong = 0;
  Vector2d last = Vector2d::Constant(-1e9);
  for (const DemoMoment& moment : moments) {
    if (!moment.position || !moment.error) continue;
    const Vector2d at = view.pixel(*moment.position);
    if (!is_on_plan && (at - last).norm() < kStep * size) continue;
    last = at;
    const ErrorClass& shown = class_of(*moment.error);
    centres[static_cast<std::size_t>(&shown - kErrorClasses.data())].push_back(at);
    if (*moment.error <= kOffMetres || wrong++ % kEvery != 0) continue;
    marks.emplace_back(PictureLine{{at, view.pixel(moment.truth)}, palette::kUntrusted, 0.75});
  }
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (!centres[i].empty()) {
      marks.emplace_back(position_symbols(kErrorClasses[i], std::move(centres[i]), size, !is_on_plan));
    }
  }
  return marks;
}

PictureLine truth_line(std::vector<Vector2d> points, double width) {
  return {std::move(points), kTruthBand, width};
}

PictureSymbols start_symbol(const Vector2d& at, double size) {
  return {"start", Symbol::triangle, {at}, size, palette::kInk, 1.0, palette::kPaper};
}

PlanView view_of(const DemoPlace& place, int width) {
  return {place.shown, width / place.shown.sizes().x(), {}};
}

}  // namespace

void DemoPainter::add(const RunView& run) {
  const FrameReport& report = *run.frame.report;
  if (!first_) first_ = report.time;
  online_ = scene_of(run.session.map().online());
  if (every_for_film_ > 0 && frames_++ % every_for_film_ == 0) {
    film_.push_back(view_.scene_of(run.images.left, report, run.session.seen_points()));
  }
  if (!report.map_from_body) return;
  path_.map_from_body.push_back({report.time, *report.map_from_body});
  path_.verdicts.push_back(report.health.verdict);
  const int points = std::min(report.health.offline_inliers, report.health.online_inliers);
  if (points <= best_points_) return;
  best_points_ = points;
  best_ = view_.scene_of(run.images.left, report, run.session.seen_points());
}

std::optional<double> DemoPainter::camera_s() const {
  if (!best_) return std::nullopt;
  return to_seconds(best_->report.time - *first_);
}

std::string DemoPainter::plan_picture(PlanScene background) const {
  std::ranges::copy(online_.points, std::back_inserter(background.map.points));
  std::ranges::copy(online_.keyframes, std::back_inserter(background.map.keyframes));
  background.paths.push_back(path_);
  background.paths.back().name = "second visit, hybrid";
  if (best_) background.camera = plan_camera(*best_->report.map_from_body, view_.rig());
  return to_svg(byre::plan_picture(background));
}

std::string DemoPainter::camera_picture() const {
  CameraPictureOptions options;
  options.title = fmt::format("{:.1f} s", *camera_s());
  return to_svg(byre::camera_picture(*best_, options));
}

Eigen::AlignedBox2d ground_around(const std::vector<DemoMoment>& moments) {
  constexpr double kAlong = 3.0, kAcross = 4.4;  // metres
  Eigen::AlignedBox2d box;
  for (const DemoMoment& moment : moments) box.extend(moment.truth);
  if (box.isEmpty()) box.extend(Vector2d::Zero());
  return {box.min() - Vector2d(kAlong, kAcross), box.max() + Vector2d(kAlong, kAcross)};
}

Pane plan_pane(const DemoPlace& place, const DemoArm& arm, double until_s, int width) {
  constexpr double kBandMetres = 0.36, kStartMetres = 0.8;
  const PlanView view = view_of(place, width);
  std::vector<DemoMoment> moments;
  std::ranges::copy_if(arm.moments, std::back_inserter(moments),
                       [until_s](const DemoMoment& moment) { return moment.time_s <= until_s; });
  Pane pane;
  pane.width = width;
  pane.height = static_cast<int>(std::lround(view.pixels_per_metre * place.shown.sizes().y()));
  if (!place.unmapped.isEmpty()) pane.marks.emplace_back(shade(place.unmapped, view));
  if (place.ground.image) pane.marks.emplace_back(ground_image(place.ground, view));
  append(label_marks(place.labels, view), pane.marks);
  append(moved_marks(place.moved, view), pane.marks);
  std::vector<Vector2d> truth;
  for (const DemoMoment& moment : moments) truth.push_back(view.pixel(moment.truth));
  if (truth.empty()) return pane;
  pane.marks.emplace_back(truth_line(truth, kBandMetres * view.pixels_per_metre));
  append(position_marks(moments, view, arm.is_on_plan()), pane.marks);
  const double start = std::clamp(kStartMetres * view.pixels_per_metre, 12.0, 26.0);
  pane.marks.emplace_back(start_symbol(truth.front(), start));
  return pane;
}

std::vector<PlanSign> plan_signs() {
  constexpr double kHalf = 12.0;  // pixels
  std::vector<PlanSign> signs = {{{truth_line({{-kHalf, 0.0}, {kHalf, 0.0}}, 11.0)}, "true path of the robot"},
                                 {{start_symbol({0.0, 0.0}, 15.0)}, "switched on here, which no run is given"}};
  for (const ErrorClass& each : kErrorClasses) {
    signs.push_back({{position_symbols(each, {{-6.0, 0.0}, {6.0, 0.0}}, 7.0, false)}, each.meaning});
  }
  signs.push_back({{position_symbols(kErrorClasses[0], {{-6.0, 0.0}, {6.0, 0.0}}, 6.0, true)},
                   "shape of the path only, laid here by its best fit to the truth"});
  const std::vector<Vector2d> box = {{-kHalf, -7.0}, {kHalf, -7.0}, {kHalf, 7.0}, {-kHalf, 7.0}};
  signs.push_back({place_after(box), "moved since the map was made"});
  signs.push_back({place_before(box), "where that stood in the map"});
  return signs;
}

PictureText plain_text(const Vector2d& at, const std::string& text, double size) {
  return {at, text, size, palette::kInk};
}

Pane plan_legend(const std::vector<PlanSign>& signs, int width) {
  constexpr double kMargin = 16.0, kSign = 34.0, kGap = 26.0, kRow = 26.0, kSize = 14.0;  // pixels
  constexpr double kCharacter = 0.58 * kSize;                                             // mean width of a character
  Pane pane;
  pane.width = width;
  Vector2d at(kMargin, kRow);
  for (const PlanSign& sign : signs) {
    const double length = kSign + kCharacter * static_cast<double>(sign.meaning.size());
    if (at.x() > kMargin && at.x() + length > width - kMargin) at = {kMargin, at.y() + kRow};
    const Vector2d centre = at + Vector2d(12.0, -5.0);
    for (PictureMark mark : sign.marks) {
      if (auto* const line = std::get_if<PictureLine>(&mark))
        for (Vector2d& point : line->points) point += centre;
      if (auto* const area = std::get_if<PictureArea>(&mark))
        for (Vector2d& corner : area->corners) corner += centre;
      if (auto* const symbols = std::get_if<PictureSymbols>(&mark))
        for (Vector2d& one : symbols->centres) one += centre;
      pane.marks.push_back(std::move(mark));
    }
    pane.marks.emplace_back(plain_text(at + Vector2d(kSign, 0.0), sign.meaning, kSize));
    at.x() += length + kGap;
  }
  pane.height = static_cast<int>(std::lround(at.y() + 0.6 * kRow));
  return pane;
}

}  // namespace byre
