#include "byre/viewer/picture.h"

#include "byre/base/output_file.h"
#include "byre/viewer/picture_shapes.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

Picture joined(Picture first, const Picture& second, int left, int top) {
  for (Pane pane : second.panes) {
    pane.left += left;
    pane.top += top;
    first.panes.push_back(std::move(pane));
  }
  first.width = std::max(first.width, left + second.width);
  first.height = std::max(first.height, top + second.height);
  return first;
}

}  // namespace

Picture hconcat(Picture first, const Picture& second) {
  const int left = first.width;
  return joined(std::move(first), second, left, 0);
}

Picture vconcat(Picture first, const Picture& second) {
  const int top = first.height;
  return joined(std::move(first), second, 0, top);
}

void write_picture(const Picture& picture, const std::filesystem::path& file) {
  if (file.extension() == ".svg" || file.extension() == ".SVG") return write_atomically(file, to_svg(picture));
  const std::vector<std::byte> png = to_png(picture);
  write_atomically(file, png);
}

std::vector<Eigen::Vector2d> corners_of(Symbol symbol, double size) {
  const double half = 0.5 * size;
  if (symbol == Symbol::square) return {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  constexpr double kSlender = 1.2;  // scale that gives other shapes nearly the area of a disc
  const double reach = kSlender * half;
  if (symbol == Symbol::diamond) return {{0.0, -reach}, {reach, 0.0}, {0.0, reach}, {-reach, 0.0}};
  return {{0.0, -reach}, {reach, 0.8 * reach}, {-reach, 0.8 * reach}};
}

std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> strokes_of(Symbol symbol, double size) {
  const double half = 0.5 * size;
  if (symbol == Symbol::plus) return {{{-half, 0.0}, {half, 0.0}}, {{0.0, -half}, {0.0, half}}};
  const double reach = 0.8 * half;
  return {{{-reach, -reach}, {reach, reach}}, {{-reach, reach}, {reach, -reach}}};
}

double stroke_width(double size) {
  return std::max(1.0, 0.25 * size);
}

bool is_stroked(Symbol symbol) {
  return symbol == Symbol::cross || symbol == Symbol::plus;
}

}  // namespace byre
