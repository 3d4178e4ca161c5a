// SVG rendering. Equal symbols form one path, which keeps the file of a building's map small.

#include "byre/base/markup.h"
#include "byre/io/image/image_codec.h"
#include "byre/viewer/picture_shapes.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using std::string;

string px(double value) {
  return fmt::format("{:.1f}", value);
}

string px(const Eigen::Vector2d& point) {
  return fmt::format("{:.1f} {:.1f}", point.x(), point.y());
}

string px(const std::vector<Eigen::Vector2d>& points) {
  string all;
  for (const Eigen::Vector2d& point : points) all += (all.empty() ? "" : " ") + px(point);
  return all;
}

// Attributes by name; those without a value are omitted.
using Attributes = std::vector<std::pair<std::string_view, string>>;

string begun(std::string_view name, const Attributes& attributes) {
  string tag = fmt::format("<{}", name);
  for (const auto& [key, value] : attributes) {
    if (!value.empty()) tag += fmt::format(" {}=\"{}\"", key, value);
  }
  return tag;
}

string empty_element(std::string_view name, const Attributes& attributes) {
  return begun(name, attributes) + "/>\n";
}

string element(std::string_view name, const Attributes& attributes, std::string_view content) {
  return fmt::format("{}>{}</{}>\n", begun(name, attributes), content, name);
}

string hex(const Colour& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

string opacity_text(double opacity) {
  return opacity < 1.0 ? fmt::format("{:.2f}", opacity) : "";
}

string base64(const std::vector<unsigned char>& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

// PNG or JPEG, whichever is smaller: drawings suit PNG, photographs JPEG.
string data_address(const Image& image) {
  constexpr int kJpegQuality = 90;
  const cv::Mat pixels(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  const std::vector<std::uint8_t> png = encode_image(".png", pixels);
  const std::vector<std::uint8_t> jpeg = encode_image(".jpg", pixels, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  const bool is_drawing = png.size() <= jpeg.size();
  return fmt::format("data:image/{};base64,{}", is_drawing ? "png" : "jpeg", base64(is_drawing ? png : jpeg));
}

// Shift by half a pixel: SVG places an image by its corner, not by a pixel centre.
string matrix_of(const Eigen::Matrix<double, 2, 3>& pane_from_image) {
  Eigen::Matrix<double, 2, 3> pane_from_corner = pane_from_image;
  pane_from_corner.col(2) = pane_from_image * Eigen::Vector3d(-0.5, -0.5, 1.0);
  return fmt::format("matrix({:.6f})", fmt::join(pane_from_corner.reshaped(), " "));
}

string svg_of(const PictureImage& mark) {
  return empty_element("image", {{"width", std::to_string(mark.image->width)},
                                 {"height", std::to_string(mark.image->height)},
                                 {"transform", matrix_of(mark.pane_from_image)},
                                 {"opacity", opacity_text(mark.opacity)},
                                 {"href", data_address(*mark.image)}});
}

string svg_of(const PictureArea& mark) {
  return empty_element(
      "polygon", {{"fill", hex(mark.colour)}, {"opacity", opacity_text(mark.opacity)}, {"points", px(mark.corners)}});
}

string dashes_of(const PictureLine& mark) {
  if (mark.stroke == Stroke::solid) return "";
  if (mark.stroke == Stroke::dotted) return fmt::format("0 {:.1f}", kDotGap * mark.width);
  return fmt::format("{:.1f} {:.1f}", kDash * mark.width, kDashGap * mark.width);
}

string svg_of(const PictureLine& mark) {
  return empty_element("polyline", {{"fill", "none"},
                                    {"stroke", hex(mark.colour)},
                                    {"stroke-width", px(mark.width)},
                                    {"stroke-linejoin", "round"},
                                    {"stroke-linecap", mark.stroke == Stroke::dashed ? "butt" : "round"},
                                    {"stroke-dasharray", dashes_of(mark)},
                                    {"points", px(mark.points)}});
}

bool is_dot(Symbol symbol) {
  return symbol == Symbol::disc || symbol == Symbol::square;
}

// Path of one symbol. A dot is a line of zero length with round caps.
string path_of(Symbol symbol, const Eigen::Vector2d& centre, double size) {
  if (is_dot(symbol)) return "M" + px(centre) + "h0";
  string path;
  if (is_stroked(symbol)) {
    for (const auto& [from, to] : strokes_of(symbol, size)) {
      path += "M" + px(centre + from) + "L" + px(centre + to);
    }
    return path;
  }
  for (const Eigen::Vector2d& corner : corners_of(symbol, size)) {
    path += (path.empty() ? "M" : "L") + px(centre + corner);
  }
  return path + "Z";
}

// Path of all symbols, widened by the rim on each side.
string path_of(const PictureSymbols& mark, double rim, const Colour& colour) {
  const bool is_filled = !is_dot(mark.symbol) && !is_stroked(mark.symbol);
  const double pen = is_filled ? 0.0 : is_stroked(mark.symbol) ? stroke_width(mark.size) : mark.size;
  string path;
  for (const Eigen::Vector2d& centre : mark.centres) path += path_of(mark.symbol, centre, mark.size);
  return empty_element("path", {{"fill", is_filled ? hex(colour) : "none"},
                                {"stroke", pen + rim > 0.0 ? hex(colour) : ""},
                                {"stroke-width", pen + rim > 0.0 ? px(pen + 2.0 * rim) : ""},
                                {"stroke-linecap", mark.symbol == Symbol::square ? "square" : "round"},
                                {"d", path}});
}

string svg_of(const PictureSymbols& mark) {
  if (mark.centres.empty()) return "";
  const string rims = mark.rim ? path_of(mark, kRim, *mark.rim) : "";
  return element("g", {{"class", markup_escaped(mark.name)}, {"opacity", opacity_text(mark.opacity)}},
                 rims + path_of(mark, 0.0, mark.colour));
}

string svg_of(const PictureText& mark) {
  constexpr std::array kAnchors = {"", "middle", "end"};
  return element("text",
                 {{"x", px(mark.at.x())},
                  {"y", px(mark.at.y())},
                  {"font-size", px(mark.size)},
                  {"font-weight", mark.bold ? "bold" : ""},
                  {"text-anchor", kAnchors[static_cast<std::size_t>(mark.align)]},
                  {"fill", hex(mark.colour)}},
                 markup_escaped(mark.text));
}

string svg_of(const Pane& pane) {
  const string width = std::to_string(pane.width);
  const string height = std::to_string(pane.height);
  string content = "\n" + empty_element("rect", {{"width", width}, {"height", height}, {"fill", hex(pane.background)}});
  for (const PictureMark& mark : pane.marks) content += std::visit([](const auto& one) { return svg_of(one); }, mark);
  return element(
      "svg", {{"x", std::to_string(pane.left)}, {"y", std::to_string(pane.top)}, {"width", width}, {"height", height}},
      content);
}

}  // namespace

string to_svg(const Picture& picture) {
  const string width = std::to_string(picture.width);
  const string height = std::to_string(picture.height);
  string content = "\n" + empty_element("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
  for (const Pane& pane : picture.panes) content += svg_of(pane);
  return element("svg",
                 {{"xmlns", "http://www.w3.org/2000/svg"},
                  {"width", width},
                  {"height", height},
                  {"viewBox", fmt::format("0 0 {} {}", width, height)},
                  {"font-family", "Helvetica, Arial, sans-serif"}},
                 content);
}

}  // namespace byre
