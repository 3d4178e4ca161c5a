// Paths, keyframes and the camera on a plan picture.

#include "byre/geometry/median.h"
#include "byre/viewer/palette.h"
#include "byre/viewer/plan_view.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace byre {
namespace {

using Eigen::Vector2d;

constexpr double kCasing = 1.5;  // pixels of white on each side of a path, for contrast with points
constexpr std::array kVerdicts = {Verdict::trusted, Verdict::degraded, Verdict::untrusted};

double median_pixel_step(const std::vector<Vector2d>& pixels) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < pixels.size(); ++i) steps.push_back((pixels[i] - pixels[i - 1]).norm());
  return median_or(std::move(steps), 0.0);
}

// Part of a path without gaps and with one verdict.
struct Piece {
  std::optional<Verdict> verdict;
  std::vector<Vector2d> pixels;
};

std::optional<Verdict> verdict_of(const PlanPath& path, std::size_t i) {
  return path.verdicts.empty() ? std::nullopt : std::optional(path.verdicts[i]);
}

// Longest time between consecutive poses of an uninterrupted path.
Timestamp longest_step(const PlanPath& path) {
  constexpr int kMissed = 10;  // frames
  std::vector<Timestamp> steps;
  for (std::size_t i = 1; i < path.map_from_body.size(); ++i) {
    steps.push_back(path.map_from_body[i].time - path.map_from_body[i - 1].time);
  }
  return kMissed * median_or(std::move(steps), Timestamp::zero());
}

// Skips points closer than half a pixel to the previous one.
void add_visible(std::vector<Vector2d>& pixels, const Vector2d& pixel) {
  constexpr double kVisible = 0.5;
  if (pixels.empty() || (pixel - pixels.back()).norm() >= kVisible) pixels.push_back(pixel);
}

std::vector<Piece> pieces_of(const PlanPath& path, const PlanView& view) {
  const Timestamp longest = longest_step(path);
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < path.map_from_body.size(); ++i) {
    const StampedPose& sample = path.map_from_body[i];
    const std::optional<Verdict> verdict = verdict_of(path, i);
    const Vector2d pixel = view.pixel_of(sample.world_from_body.translation);
    const bool is_gap = i == 0 || sample.time - path.map_from_body[i - 1].time > longest;
    const bool is_change = i > 0 && pieces.back().verdict != verdict;
    if (is_change && !is_gap) pieces.back().pixels.push_back(pixel);  // joins the next piece
    if (is_gap || is_change) pieces.push_back({verdict, {}});
    add_visible(pieces.back().pixels, pixel);
  }
  return pieces;
}

Stroke stroke_of(Verdict verdict) {
  if (verdict == Verdict::trusted) return Stroke::solid;
  return verdict == Verdict::degraded ? Stroke::dashed : Stroke::dotted;
}

// Legend entry of a path or of a verdict.
LegendEntry legend_entry(const PlanPath& path, const std::optional<Verdict>& verdict, std::size_t number) {
  if (!verdict) return {path.name, palette::kPaths[number % palette::kPaths.size()], {}, Stroke::solid};
  LegendEntry entry = verdict_entry(*verdict);
  if (!path.name.empty()) entry.meaning = path.name + ", " + entry.meaning;
  return entry;
}

MarksWithLegend path_marks_of(const PlanPath& path, std::size_t number, const PlanView& view) {
  assert(path.verdicts.empty() || path.verdicts.size() == path.map_from_body.size());
  constexpr double kWidth = 3.0;
  MarksWithLegend all;
  const std::vector<Piece> pieces = pieces_of(path, view);
  for (const Piece& piece : pieces) {
    all.marks.emplace_back(PictureLine{piece.pixels, palette::kPaper, kWidth + 2.0 * kCasing});
  }
  for (const Piece& piece : pieces) {
    const LegendEntry entry = legend_entry(path, piece.verdict, number);
    all.marks.emplace_back(PictureLine{piece.pixels, entry.colour, kWidth, entry.stroke});
  }
  if (path.verdicts.empty()) all.legend = {legend_entry(path, {}, number)};
  for (const Verdict verdict : kVerdicts) {
    if (std::ranges::count(path.verdicts, verdict) > 0) all.legend.push_back(legend_entry(path, verdict, number));
  }
  return all;
}

PictureSymbols start_symbols(const std::vector<Vector2d>& pixels) {
  PictureSymbols symbols;
  symbols.name = "starts";
  symbols.symbol = Symbol::triangle;
  symbols.centres = pixels;
  symbols.size = 12.0;
  symbols.colour = palette::kInk;
  symbols.rim = palette::kPaper;
  return symbols;
}

void append(MarksWithLegend more, MarksWithLegend& all) {
  std::ranges::move(more.marks, std::back_inserter(all.marks));
  std::ranges::move(more.legend, std::back_inserter(all.legend));
}

}  // namespace

LegendEntry verdict_entry(Verdict verdict) {
  return {std::string(to_string(verdict)), palette::of(verdict), {}, stroke_of(verdict)};
}

MarksWithLegend keyframe_marks(const MapScene& map, const PlanView& view) {
  constexpr double kFarthest = 6.0;  // in usual distances between keyframes
  constexpr double kWidth = 0.75;
  std::vector<SceneKeyframe> keyframes = map.keyframes;
  const auto order = [](const SceneKeyframe& keyframe) { return std::pair(keyframe.origin, keyframe.time); };
  std::ranges::stable_sort(keyframes, {}, order);
  PictureSymbols symbols;
  symbols.name = "keyframes";
  symbols.size = 3.0;
  symbols.colour = palette::kKeyframe;
  for (const SceneKeyframe& keyframe : keyframes) {
    symbols.centres.push_back(view.pixel_of(keyframe.map_from_body.translation));
  }
  if (keyframes.empty()) return {};
  MarksWithLegend all;
  const double farthest = kFarthest * median_pixel_step(symbols.centres);
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    const std::vector<Vector2d> step = {symbols.centres[i - 1], symbols.centres[i]};
    if (keyframes[i].origin != keyframes[i - 1].origin || (step[1] - step[0]).norm() > farthest) continue;
    all.marks.emplace_back(PictureLine{step, palette::kKeyframe, kWidth});
  }
  all.legend.push_back({"keyframes", symbols.colour, symbols.symbol});
  all.marks.emplace_back(std::move(symbols));
  return all;
}

MarksWithLegend path_marks(const std::vector<PlanPath>& paths, const PlanView& view) {
  MarksWithLegend all;
  std::vector<Vector2d> starts;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (paths[i].map_from_body.empty()) continue;
    append(path_marks_of(paths[i], i, view), all);
    starts.push_back(view.pixel_of(paths[i].map_from_body.front().world_from_body.translation));
  }
  if (starts.empty()) return all;
  all.marks.emplace_back(start_symbols(starts));
  all.legend.push_back({"start", palette::kInk, Symbol::triangle});
  return all;
}

MarksWithLegend camera_marks(const PlanCamera& camera, const PlanView& view) {
  constexpr double kReach = 70.0;    // pixels
  constexpr double kSteepest = 0.2;  // least horizontal part of the unit viewing direction; below, no heading is drawn
  constexpr int kParts = 12;
  const Vector2d at = view.pixel_of(camera.map_from_camera.translation);
  const Eigen::Vector3d ahead =
      view.ground_from_map.target_from_source.rotation * (camera.map_from_camera.rotation * Eigen::Vector3d::UnitZ());
  MarksWithLegend all;
  if (ahead.head<2>().norm() > kSteepest) {
    const double heading = std::atan2(-ahead.y(), ahead.x());  // heading in the picture, y down
    std::vector<Vector2d> wedge = {at};
    for (int i = 0; i <= kParts; ++i) {
      const double angle = heading + camera.field_of_view * (static_cast<double>(i) / kParts - 0.5);
      wedge.emplace_back(at + kReach * Vector2d(std::cos(angle), std::sin(angle)));
    }
    all.marks.emplace_back(PictureArea{wedge, palette::kCamera, 0.3});
    wedge.push_back(at);
    all.marks.emplace_back(PictureLine{wedge, palette::kCamera, 1.5});
  }
  PictureSymbols place{"camera", Symbol::disc, {at}, 9.0, palette::kCamera, 1.0, palette::kPaper};
  all.marks.emplace_back(std::move(place));
  all.legend.push_back({"camera", palette::kCamera, Symbol::disc});
  return all;
}

}  // namespace byre
