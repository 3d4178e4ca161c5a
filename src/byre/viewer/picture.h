#pragma once

#include "byre/image.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace byre {

// A drawing as a value: what is on it, not how it is put on screen. to_svg and to_png make the same picture of it.
// Positions are pixels of the pane they are in, x right, y down, continuous: the top left pixel covers 0 to 1.

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

// Equal symbols in many places: what there can be thousands of.
struct PictureSymbols {
  std::string name;  // class of the element in the SVG
  Symbol symbol = Symbol::disc;
  std::vector<Eigen::Vector2d> centres;
  double size = 4.0;  // across
  Colour colour;
  double opacity = 1.0;
  std::optional<Colour> rim{};  // one pixel around each
};

enum class Align : std::uint8_t { left, centre, right };

struct PictureText {
  Eigen::Vector2d at;  // place on the baseline
  std::string text;    // ASCII
  double size = 13.0;  // height of capitals and of what hangs below the line together
  Colour colour;
  Align align = Align::left;
  bool bold = false;
};

struct PictureImage {
  std::shared_ptr<const Image> image;           // not null
  Eigen::Matrix<double, 2, 3> pane_from_image;  // affine; of the image's pixels, whole numbers are centres
  double opacity = 1.0;
};

using PictureMark = std::variant<PictureImage, PictureArea, PictureLine, PictureSymbols, PictureText>;

// A rectangle of the picture that nothing drawn in it leaves.
struct Pane {
  int left = 0;
  int top = 0;
  int width = 0;
  int height = 0;
  Colour background{255, 255, 255};
  std::vector<PictureMark> marks;  // later ones above earlier ones
};

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Pane> panes;
};

// The second at the right of the first one, or below it.
Picture beside(Picture first, const Picture& second);
Picture below(Picture first, const Picture& second);

// Self-contained: images are in it, fonts are the viewer's own sans serif.
std::string to_svg(const Picture& picture);

// The bytes of a PNG file of the picture's size.
std::vector<std::byte> to_png(const Picture& picture);

// SVG where the file is called so, else PNG. Throws InputError when it cannot be written.
void write_picture(const Picture& picture, const std::filesystem::path& file);

}  // namespace byre
