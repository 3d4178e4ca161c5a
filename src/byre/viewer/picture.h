#pragma once

#include "byre/image.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Vector drawing as a value; to_svg and to_png render it equally. Positions are pixels of the pane, x right, y down,
// continuous: the top left pixel covers 0 to 1.

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  auto operator<=>(const Colour&) const = default;
};

enum class Stroke : std::uint8_t { solid, dashed, dotted };

struct PictureLine {
  std::vector<Eigen::Vector2d> points;
  Colour colour;
  double width = 1.0;
  Stroke stroke = Stroke::solid;
};

struct PictureArea {
  std::vector<Eigen::Vector2d> corners;
  Colour colour;
  double opacity = 1.0;
};

enum class Symbol : std::uint8_t { disc, square, diamond, triangle, cross, plus };

// Equal symbols at many positions, possibly thousands.
struct PictureSymbols {
  std::string name;  // class of the element in the SVG
  Symbol symbol = Symbol::disc;
  std::vector<Eigen::Vector2d> centres;
  double size = 4.0;  // width and height, pixels
  Colour colour;
  double opacity = 1.0;
  std::optional<Colour> rim{};  // colour of a rim one pixel wide
};

enum class Align : std::uint8_t { left, centre, right };

struct PictureText {
  Eigen::Vector2d at;  // position on the baseline
  std::string text;    // ASCII
  double size = 13.0;  // height of capitals plus descenders, pixels
  Colour colour;
  Align align = Align::left;
  bool bold = false;
};

struct PictureImage {
  std::shared_ptr<const Image> image;           // not null
  Eigen::Matrix<double, 2, 3> pane_from_image;  // affine; integers are centres of image pixels
  double opacity = 1.0;
};

using PictureMark = std::variant<PictureImage, PictureArea, PictureLine, PictureSymbols, PictureText>;

// Rectangle of the picture; clips its marks.
struct Pane {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
  Colour background{255, 255, 255};
  std::vector<PictureMark> marks;  // later marks cover earlier ones
};

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Pane> panes;
};

// Places the second picture to the right of the first one, or below it.
Picture hconcat(Picture first, const Picture& second);
Picture vconcat(Picture first, const Picture& second);

// Self-contained SVG with embedded images; text in the viewer's sans serif font.
std::string to_svg(const Picture& picture);

// PNG file of the picture's size.
std::vector<std::byte> to_png(const Picture& picture);

// Endlessly repeating PNG file of pictures of equal size, at most 255 colours. The last picture is shown for last_s
// seconds. Preconditions: at least one picture; at most 65 s per picture.
std::vector<std::byte> to_animated_png(const std::vector<Picture>& pictures, double frame_rate_hz, double last_s);

// Writes SVG for the extension .svg, else PNG. Throws InputError if the file cannot be written.
void write_picture(const Picture& picture, const std::filesystem::path& file);

}  // namespace byre
