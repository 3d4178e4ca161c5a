#include "byre/viewer/calibration_picture.h"

#include "byre/viewer/palette.h"
#include "byre/viewer/picture_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Calibration barrel_pair() {
  const Camera camera{CameraModel::radial_tangential, 752, 480, 458.0, 457.0, 367.0, 248.0, {-0.28, 0.07, 2e-4, 2e-5}};
  return {.left = camera,
          .right = StereoPartner{camera, {Eigen::Quaterniond::Identity(), {-0.11, 0.0, 0.0}}},
          .body_from_left = {}};
}

// Lines of this colour in the first or second plot of a picture with heading, frames and plots.
std::vector<PictureLine> lines_of(const Picture& picture, std::size_t pane, const Colour& colour) {
  std::vector<PictureLine> lines;
  for (const PictureMark& mark : picture.panes.at(pane).marks) {
    const auto* const line = std::get_if<PictureLine>(&mark);
    if (line != nullptr && line->colour == colour) lines.push_back(*line);
  }
  return lines;
}

constexpr std::size_t kImagePlot = 2, kIdealPlot = 4;  // panes: heading, frame, plot, frame, plot

TEST(CalibrationPicture, NamesBothCamerasWithTheirFieldsOfView) {
  const std::string svg = to_svg(calibration_picture(barrel_pair(), "camchain.yaml"));
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_THAT(svg, AllOf(HasSubstr(">camchain.yaml<"), HasSubstr(">left: radial_tangential<"),
                         HasSubstr(">right: radial_tangential<"), HasSubstr(">left, undistorted<"),
                         HasSubstr("752x480, view 9"), HasSubstr(">u [px]<"), HasSubstr(" deg<")));
  Calibration one = barrel_pair();
  one.right.reset();
  EXPECT_THAT(to_svg(calibration_picture(one, "x")), Not(HasSubstr("right")));
}

TEST(CalibrationPicture, DrawsTheGridOfAnIdealCameraBentInTheImage) {
  const Picture picture = calibration_picture(barrel_pair(), "");
  const std::vector<PictureLine> lines = lines_of(picture, kImagePlot, palette::kPaths[0]);
  ASSERT_FALSE(lines.empty());
  double most_bent = 0.0;
  for (const PictureLine& line : lines) {
    const Eigen::Vector2d chord = 0.5 * (line.points.front() + line.points.back());
    most_bent = std::max(most_bent, (line.points[line.points.size() / 2] - chord).norm());
  }
  EXPECT_GT(most_bent, 10.0);
  EXPECT_LT(most_bent, 80.0);
}

TEST(CalibrationPicture, DrawsStraightGridsOfAnIdealPair) {
  Calibration ideal = barrel_pair();
  ideal.left = {CameraModel::pinhole, 752, 480, 458.0, 458.0, 367.0, 248.0, {}};
  ideal.right->camera = ideal.left;
  const Picture picture = calibration_picture(ideal, "");
  for (const std::size_t pane : {kImagePlot, kIdealPlot}) {
    for (const PictureLine& line :
         lines_of(picture, pane, pane == kImagePlot ? palette::kPaths[0] : palette::kPaths[2])) {
      const Eigen::Vector2d along = (line.points.back() - line.points.front()).normalized();
      for (const Eigen::Vector2d& point : line.points) {
        const Eigen::Vector2d off = point - line.points.front();
        EXPECT_NEAR(along.x() * off.y() - along.y() * off.x(), 0.0, 1e-6);
      }
    }
  }
}

TEST(CalibrationPicture, DrawsCamerasThatCannotBeRectifiedTogether) {
  Calibration exchanged = barrel_pair();
  exchanged.right->right_from_left.translation.x() = 0.11;
  const cv::Mat drawn = decoded(to_png(calibration_picture(exchanged, "exchanged.yaml")));
  EXPECT_EQ(drawn.size(), decoded(to_png(calibration_picture(barrel_pair(), "x"))).size());
}

TEST(CalibrationPicture, DrawsAWideFisheyeWithRaysBehindTheImagePlane) {
  const Camera camera{CameraModel::equidistant, 512, 512, 160.0, 160.0, 255.5, 255.5, {}};
  const Picture picture = calibration_picture({.left = camera, .right = std::nullopt, .body_from_left = {}}, "");
  EXPECT_FALSE(lines_of(picture, kImagePlot, palette::kPaths[0]).empty());
  EXPECT_FALSE(lines_of(picture, kIdealPlot, palette::kPaths[2]).empty());
}

}  // namespace
}  // namespace byre
