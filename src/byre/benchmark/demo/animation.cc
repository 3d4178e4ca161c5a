#include "byre/benchmark/demo/animation.h"

#include "byre/base/enum_names.h"
#include "byre/viewer/camera_picture.h"
#include "byre/viewer/palette.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

constexpr int kPictureWidth = 1200;  // pixels
constexpr int kPictureMargin = 16;
constexpr int kPlanGap = 24;  // between the two lower plans
constexpr double kTitleSize = 24.0, kArmSize = 18.0;

Picture picture_of(Pane pane, int left) {
  Picture picture;
  picture.width = left + pane.width;
  picture.height = pane.height;
  pane.left = left;
  picture.panes.push_back(std::move(pane));
  return picture;
}

Pane text_pane(int width, int height) {
  Pane pane;
  pane.width = width;
  pane.height = height;
  return pane;
}

PictureText bold(PictureText text) {
  text.bold = true;
  return text;
}

PictureText faint(PictureText text) {
  text.colour = palette::kFaint;
  return text;
}

Pane title() {
  Pane pane = text_pane(kPictureWidth, 68);
  pane.marks.emplace_back(
      bold(plain_text({kPictureMargin, 34.0}, "Switched on somewhere in a barn that was mapped once", kTitleSize)));
  pane.marks.emplace_back(faint(
      plain_text({kPictureMargin, 58.0},
                 "Mapped by day. Now it is dusk, half of the things have moved, and the start is unknown.", 15.0)));
  return pane;
}

// Heading, figures and plan of one arm.
Picture arm_picture(const DemoPlace& place, const DemoArm& arm, int left, int width) {
  Pane heading = text_pane(width, 56);
  const double figure_size = arm.arm == Arm::hybrid ? 15.0 : 12.0;
  heading.marks.emplace_back(bold(plain_text({0.0, 25.0}, plain_name(arm.arm), kArmSize)));
  heading.marks.emplace_back(plain_text({0.0, 46.0}, figures_line(arm), figure_size));
  return vconcat(picture_of(std::move(heading), left), picture_of(plan_pane(place, arm, 1e9, width), left));
}

std::string whole_percent(double share) {
  return fmt::format("{:.0f} %", 1e2 * share);
}

std::string length_of(double metres) {
  return metres < 1.0 ? fmt::format("{:.1f} cm", 1e2 * metres) : fmt::format("{:.1f} m", metres);
}

constexpr int kCameraWidth = 384, kPlanWidth = 480, kSpace = 8, kTitleHeight = 34, kCaptionHeight = 54;  // pixels
constexpr int kAnimationWidth = kCameraWidth + kPlanWidth + 3 * kSpace;

PictureSymbols sign_at(const Eigen::Vector2d& at, Symbol symbol, const Colour& colour) {
  return {"sign", symbol, {at}, 9.0, colour};
}

const DemoMoment* moment_at(const DemoArm& arm, double time_s) {
  const auto after =
      std::ranges::find_if(arm.moments, [time_s](const DemoMoment& each) { return each.time_s > time_s; });
  return after == arm.moments.begin() ? nullptr : &*std::prev(after);
}

// State of the position in plain words, with its colour.
std::pair<std::string, Colour> state_of(const DemoMoment* moment) {
  if (moment == nullptr || !moment->error) return {"position not found yet", palette::kUntrusted};
  const std::string error = fmt::format("true error {:.1f} cm", 1e2 * *moment->error);
  if (moment->verdict == Verdict::trusted) return {"position trusted, " + error, palette::kOffline};
  return {"position not trusted, " + error, palette::kDegraded};
}

Pane title_pane() {
  Pane pane;
  pane.width = kAnimationWidth;
  pane.height = kTitleHeight;
  PictureText text =
      plain_text({kSpace, 23.0}, "Mapped once by day. Now: dusk, half of the things moved, start unknown.", 16.0);
  text.bold = true;
  pane.marks.emplace_back(std::move(text));
  return pane;
}

Pane caption_pane(const DemoMoment* moment, double time_s, int top) {
  constexpr double kSize = 13.0, kLine = 20.0;
  constexpr double kPlanLeft = kCameraWidth + 2.0 * kSpace;
  Pane pane;
  pane.top = top;
  pane.width = kAnimationWidth;
  pane.height = kCaptionHeight;
  const auto sign = [&pane](double x, double y, Symbol symbol, const Colour& colour, const char* meaning) {
    pane.marks.emplace_back(sign_at({x, y - 4.5}, symbol, colour));
    pane.marks.emplace_back(plain_text({x + 11.0, y}, meaning, kSize));
  };
  sign(kSpace + 5.0, kLine, Symbol::disc, palette::kOffline, "point of the map made by day");
  sign(kSpace + 5.0, 2.0 * kLine, Symbol::diamond, palette::kOnline, "point mapped new in this visit");
  const auto [state, colour] = state_of(moment);
  PictureText shown = plain_text({kPlanLeft, kLine}, fmt::format("{:4.1f} s: {}", time_s, state), 15.0);
  shown.bold = true;
  shown.colour = colour;
  pane.marks.emplace_back(std::move(shown));
  sign(kPlanLeft + 6.0, 2.0 * kLine, Symbol::triangle, palette::kInk, "switched on here");
  sign(kPlanLeft + 148.0, 2.0 * kLine, Symbol::disc, palette::kOffline, "within 10 cm");
  sign(kPlanLeft + 262.0, 2.0 * kLine, Symbol::diamond, palette::kDegraded, "off by up to 1 m");
  sign(kPlanLeft + 402.0, 2.0 * kLine, Symbol::square, {150, 95, 20}, "moved");
  return pane;
}

// Disc at the published position.
PictureSymbols robot_at(const DemoPlace& place, const DemoMoment& moment) {
  const double scale = kPlanWidth / place.shown.sizes().x();
  const Eigen::Vector2d& at = *moment.position;
  return {"robot",
          Symbol::disc,
          {scale * Eigen::Vector2d(at.x() - place.shown.min().x(), place.shown.max().y() - at.y())},
          11.0,
          palette::kCamera,
          1.0,
          palette::kPaper};
}

Picture frame_of(const DemoPlace& place, const DemoArm& hybrid, FrameScene filmed, double time_s) {
  std::erase_if(filmed.seen, [](const SeenPoint& point) { return !point.is_inlier; });
  Picture picture = camera_picture(filmed, {.title = {}, .panel = false, .width = kCameraWidth});
  Pane& camera = picture.panes.front();
  for (PictureMark& mark : camera.marks) {
    if (auto* const symbols = std::get_if<PictureSymbols>(&mark)) symbols->size = 5.0;
  }
  camera.left = kSpace;
  camera.top = kTitleHeight;
  Pane plan = plan_pane(place, hybrid, time_s, kPlanWidth);
  const DemoMoment* const moment = moment_at(hybrid, time_s);
  if (moment != nullptr && moment->position) plan.marks.emplace_back(robot_at(place, *moment));
  const int height = std::max(camera.height, plan.height);
  plan.left = kCameraWidth + 2 * kSpace;
  plan.top = kTitleHeight + (height - plan.height) / 2;
  picture.panes.insert(picture.panes.begin(), title_pane());
  picture.panes.push_back(std::move(plan));
  picture.panes.push_back(caption_pane(moment, time_s, kTitleHeight + height));
  picture.width = kAnimationWidth;
  picture.height = kTitleHeight + height + kCaptionHeight;
  return picture;
}

}  // namespace

std::string plain_name(Arm arm) {
  return std::string(name_among<Arm::hybrid>(
      {"Without a map", "With the map, mapping nothing new", "byre: with the map, and mapping what is new"}, arm));
}

std::string figures_line(const DemoArm& arm) {
  const PlanFigures figures = plan_figures(arm);
  if (!arm.is_on_plan()) {
    return "never on the plan; shape of its path: median error " +
           (figures.aligned_median_error ? length_of(*figures.aligned_median_error) : "-");
  }
  if (!figures.found_s) return "never found, position in " + whole_percent(figures.placed_share) + " of the frames";
  return fmt::format("found after {:.1f} s, position {}, trusted {}, falsely trusted {}, median error {}",
                     *figures.found_s, whole_percent(figures.placed_share), whole_percent(figures.trusted_share),
                     figures.wrong, length_of(*figures.median_error));
}

Picture mission_picture(const DemoPlace& place, const std::vector<DemoArm>& arms) {
  constexpr int kWhole = kPictureWidth - 2 * kPictureMargin;
  constexpr int kHalf = (kWhole - kPlanGap) / 2;
  Picture picture = picture_of(title(), 0);
  Picture row;
  for (const DemoArm& arm : arms) {
    if (arm.arm == Arm::hybrid) {
      picture = vconcat(std::move(picture), arm_picture(place, arm, kPictureMargin, kWhole));
    } else {
      const int left = row.width == 0 ? kPictureMargin : kPlanGap;
      row = hconcat(std::move(row), arm_picture(place, arm, left, kHalf));
    }
  }
  picture = vconcat(std::move(picture), row);
  return vconcat(std::move(picture), picture_of(plan_legend(plan_signs(), kPictureWidth), 0));
}

std::vector<Picture> animation_of(const DemoPlace& place, const DemoArm& hybrid,
                                  const std::vector<FrameScene>& filmed) {
  std::vector<Picture> frames;
  for (const FrameScene& scene : filmed) {
    frames.push_back(frame_of(place, hybrid, scene, to_seconds(scene.report.time - filmed.front().report.time)));
  }
  return frames;
}

}  // namespace byre
