#include "byre/benchmark/demo/mission_picture.h"

#include "byre/viewer/palette.h"

#include <algorithm>

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

}  // namespace

std::string plain_name(Arm arm) {
  switch (arm) {
    case Arm::no_map:
      return "Without a map";
    case Arm::localise_only:
      return "With the map, mapping nothing new";
    case Arm::hybrid:
      break;
  }
  return "byre: with the map, and mapping what is new";
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

}  // namespace byre
