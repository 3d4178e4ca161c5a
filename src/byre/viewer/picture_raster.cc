// Raster rendering: drawn at twice the size and halved, so that lines and small text stay sharp.

#include "byre/io/image/animated_png.h"
#include "byre/io/image/image_codec.h"
#include "byre/viewer/picture_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr int kOversampling = 2;
constexpr int kFractionBits = 4;  // fractional bits of OpenCV's drawing coordinates

cv::Scalar bgr(const Colour& colour) {
  return {static_cast<double>(colour.blue), static_cast<double>(colour.green), static_cast<double>(colour.red)};
}

// Shift by half a pixel: integers are pixel centres in OpenCV, pixel borders in pictures.
cv::Point on_canvas(const Eigen::Vector2d& point) {
  constexpr double kSteps = 1 << kFractionBits;
  const Eigen::Vector2d steps = kSteps * (kOversampling * point - Eigen::Vector2d::Constant(0.5));
  return {cvRound(steps.x()), cvRound(steps.y())};
}

std::vector<cv::Point> on_canvas(const std::vector<Eigen::Vector2d>& points) {
  std::vector<cv::Point> result;
  for (const Eigen::Vector2d& point : points) result.push_back(on_canvas(point));
  return result;
}

int canvas_width(double width) {
  return std::max(1, cvRound(kOversampling * width));
}

// Anti-aliased lines of OpenCV are wider than requested.
void draw_line(cv::Mat& canvas, const std::vector<Eigen::Vector2d>& points, const Colour& colour, double width) {
  constexpr double kSmoothed = 1.7;  // canvas pixels
  const std::vector<cv::Point> line = on_canvas(points);
  const int thickness = std::max(1, cvRound(kOversampling * width - kSmoothed));
  cv::polylines(canvas, line, false, bgr(colour), thickness, cv::LINE_AA, kFractionBits);
}

void draw_area(cv::Mat& canvas, const std::vector<Eigen::Vector2d>& corners, const Colour& colour) {
  const std::vector<cv::Point> area = on_canvas(corners);
  cv::fillPoly(canvas, std::vector<std::vector<cv::Point>>{area}, bgr(colour), cv::LINE_AA, kFractionBits);
}

// Splits a line into dashes.
std::vector<std::vector<Eigen::Vector2d>> dashes(const std::vector<Eigen::Vector2d>& points, double dash, double gap) {
  std::vector<std::vector<Eigen::Vector2d>> pieces;
  bool is_drawn = false;
  double left = 0.0;  // remaining length of the dash or gap
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d step = points[i] - points[i - 1];
    const double length = step.norm();
    double done = 0.0;
    while (done < length) {
      if (left <= 0.0) {
        is_drawn = !is_drawn;
        left = is_drawn ? dash : gap;
        if (is_drawn) pieces.push_back({points[i - 1] + done / length * step});
      }
      const double taken = std::min(left, length - done);
      done += taken;
      left -= taken;
      if (is_drawn) pieces.back().emplace_back(points[i - 1] + done / length * step);
    }
  }
  return pieces;
}

void draw_disc(cv::Mat& canvas, const Eigen::Vector2d& centre, double size, const Colour& colour) {
  const int radius = cvRound(0.5 * size * kOversampling * (1 << kFractionBits));
  cv::circle(canvas, on_canvas(centre), radius, bgr(colour), cv::FILLED, cv::LINE_AA, kFractionBits);
}

// Snapped to canvas pixels; the only symbol drawn in large numbers.
void draw_square(cv::Mat& canvas, const Eigen::Vector2d& centre, double size, const Colour& colour) {
  const int width = canvas_width(size);
  const cv::Rect square(cvRound(kOversampling * centre.x() - 0.5 * width),
                        cvRound(kOversampling * centre.y() - 0.5 * width), width, width);
  cv::rectangle(canvas, square, bgr(colour), cv::FILLED);
}

void draw_symbol(cv::Mat& canvas, const PictureSymbols& mark, const Eigen::Vector2d& centre, double rim,
                 const Colour& colour) {
  if (mark.symbol == Symbol::disc) return draw_disc(canvas, centre, mark.size + 2.0 * rim, colour);
  if (mark.symbol == Symbol::square) return draw_square(canvas, centre, mark.size + 2.0 * rim, colour);
  if (is_stroked(mark.symbol)) {
    for (const auto& [from, to] : strokes_of(mark.symbol, mark.size)) {
      draw_line(canvas, {centre + from, centre + to}, colour, stroke_width(mark.size) + 2.0 * rim);
    }
    return;
  }
  std::vector<Eigen::Vector2d> corners = corners_of(mark.symbol, mark.size);
  for (Eigen::Vector2d& corner : corners) corner += centre;
  draw_area(canvas, corners, colour);
  if (rim == 0.0) return;
  corners.push_back(corners.front());
  draw_line(canvas, corners, colour, 2.0 * rim);
}

// Same picture on a coarser grid, averaging all pixels for strong reduction.
PictureImage thinned(const PictureImage& mark, int factor) {
  const Image& image = *mark.image;
  const cv::Mat pixels(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  auto smaller = std::make_shared<Image>();
  smaller->width = std::max(1, image.width / factor);
  smaller->height = std::max(1, image.height / factor);
  smaller->pixels.resize(static_cast<std::size_t>(smaller->width) * static_cast<std::size_t>(smaller->height));
  cv::Mat target(smaller->height, smaller->width, CV_8U, smaller->pixels.data());
  cv::resize(pixels, target, target.size(), 0.0, 0.0, cv::INTER_AREA);
  const Eigen::Vector2d step(static_cast<double>(image.width) / smaller->width,
                             static_cast<double>(image.height) / smaller->height);
  PictureImage result = mark;
  result.image = std::move(smaller);
  const Eigen::Vector2d first = 0.5 * (step - Eigen::Vector2d::Ones());
  result.pane_from_image.leftCols<2>() = mark.pane_from_image.leftCols<2>() * step.asDiagonal();
  result.pane_from_image.col(2) = mark.pane_from_image * first.homogeneous();
  return result;
}

void draw(cv::Mat& canvas, const PictureImage& mark) {
  const double magnified = kOversampling * std::sqrt(std::abs(mark.pane_from_image.leftCols<2>().determinant()));
  if (magnified <= 0.5) return draw(canvas, thinned(mark, static_cast<int>(1.0 / magnified)));
  Eigen::Matrix<double, 2, 3> canvas_from_image = kOversampling * mark.pane_from_image;
  canvas_from_image.col(2) -= Eigen::Vector2d::Constant(0.5);
  const cv::Mat warp =
      (cv::Mat_<double>(2, 3) << canvas_from_image(0, 0), canvas_from_image(0, 1), canvas_from_image(0, 2),
       canvas_from_image(1, 0), canvas_from_image(1, 1), canvas_from_image(1, 2));
  const Image& image = *mark.image;
  const cv::Mat pixels(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat drawn;
  cv::cvtColor(pixels, drawn, cv::COLOR_GRAY2BGR);
  const int interpolation = magnified >= kOversampling ? cv::INTER_NEAREST : cv::INTER_LINEAR;
  cv::warpAffine(drawn, canvas, warp, canvas.size(), interpolation, cv::BORDER_TRANSPARENT);
}

void draw(cv::Mat& canvas, const PictureArea& mark) {
  draw_area(canvas, mark.corners, mark.colour);
}

void draw(cv::Mat& canvas, const PictureLine& mark) {
  if (mark.stroke == Stroke::solid) return draw_line(canvas, mark.points, mark.colour, mark.width);
  const bool is_dashed = mark.stroke == Stroke::dashed;
  const double dash = is_dashed ? (kDash - 1.0) * mark.width : 0.0;  // round ends lengthen it
  const double gap = is_dashed ? (kDashGap + 1.0) * mark.width : kDotGap * mark.width;
  for (const auto& piece : dashes(mark.points, dash, gap)) {
    if (is_dashed) draw_line(canvas, piece, mark.colour, mark.width);
    if (!is_dashed) draw_disc(canvas, piece.front(), mark.width, mark.colour);
  }
}

void draw(cv::Mat& canvas, const PictureSymbols& mark) {
  if (mark.rim) {
    for (const Eigen::Vector2d& centre : mark.centres) draw_symbol(canvas, mark, centre, kRim, *mark.rim);
  }
  for (const Eigen::Vector2d& centre : mark.centres) draw_symbol(canvas, mark, centre, 0.0, mark.colour);
}

void draw(cv::Mat& canvas, const PictureText& mark) {
  constexpr double kCapitals = 0.70;      // height of sans serif capitals, in sizes
  constexpr double kFaceCapitals = 21.0;  // height of OpenCV's capitals, pixels
  constexpr double kPen = 0.085;          // stroke width, in sizes
  constexpr int kFace = cv::FONT_HERSHEY_SIMPLEX;
  const double scale = kOversampling * kCapitals * mark.size / kFaceCapitals;
  const int pen = std::max(1, cvRound((mark.bold ? 1.5 : 1.0) * kPen * kOversampling * mark.size));
  int baseline = 0;
  const int width = cv::getTextSize(mark.text, kFace, scale, pen, &baseline).width;
  const double share = 0.5 * static_cast<int>(mark.align);  // share of the width to the left of the anchor
  const cv::Point start(cvRound(kOversampling * mark.at.x() - share * width), cvRound(kOversampling * mark.at.y()));
  cv::putText(canvas, mark.text, start, kFace, scale, bgr(mark.colour), pen, cv::LINE_AA);
}

template <typename Mark>
double opacity_of(const Mark& mark) {
  if constexpr (requires { mark.opacity; }) return mark.opacity;
  return 1.0;
}

template <typename Mark>
void draw_with_opacity(cv::Mat& canvas, const Mark& mark) {
  const double opacity = opacity_of(mark);
  if (opacity >= 1.0) return draw(canvas, mark);
  cv::Mat drawn = canvas.clone();
  draw(drawn, mark);
  cv::addWeighted(drawn, opacity, canvas, 1.0 - opacity, 0.0, canvas);
}

void draw(cv::Mat& canvas, const Pane& pane) {
  const cv::Rect whole(0, 0, canvas.cols, canvas.rows);
  const cv::Rect area(kOversampling * pane.left, kOversampling * pane.top, kOversampling * pane.width,
                      kOversampling * pane.height);
  cv::Mat part = canvas(area & whole);
  part.setTo(bgr(pane.background));
  for (const PictureMark& mark : pane.marks) {
    std::visit([&part](const auto& one) { draw_with_opacity(part, one); }, mark);
  }
}

std::vector<std::byte> bytes_of(const std::vector<std::uint8_t>& file) {
  std::vector<std::byte> bytes(file.size());
  std::ranges::transform(file, bytes.begin(), [](std::uint8_t byte) { return std::byte(byte); });
  return bytes;
}

}  // namespace

cv::Mat rasterised(const Picture& picture) {
  cv::Mat canvas(kOversampling * picture.height, kOversampling * picture.width, CV_8UC3, cv::Scalar::all(255));
  for (const Pane& pane : picture.panes) draw(canvas, pane);
  cv::Mat result;
  cv::resize(canvas, result, cv::Size(picture.width, picture.height), 0.0, 0.0, cv::INTER_AREA);
  return result;
}

std::vector<std::byte> to_png(const Picture& picture) {
  return bytes_of(encode_image(".png", rasterised(picture)));
}

std::vector<std::byte> to_animated_png(const std::vector<Picture>& pictures, double frame_rate_hz, double last_s) {
  std::vector<cv::Mat> frames;
  for (const Picture& picture : pictures) frames.push_back(rasterised(picture));
  const auto milliseconds = [](double seconds) { return static_cast<std::uint16_t>(std::lround(1e3 * seconds)); };
  return bytes_of(encode_animated_png(frames, {milliseconds(1.0 / frame_rate_hz), milliseconds(last_s)}));
}

}  // namespace byre
