#include "byre/features/detect.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace byre {
namespace {

// Squares of the level inside its border, row by row; those of the last row and column are cut off.
struct CellGrid {
  cv::Rect area;
  int cell_size;

  int columns() const { return (area.width + cell_size - 1) / cell_size; }
  int rows() const { return (area.height + cell_size - 1) / cell_size; }
  std::size_t size() const { return static_cast<std::size_t>(columns() * rows()); }
  std::size_t index_of(const Corner& corner) const {
    return static_cast<std::size_t>((corner.y - area.y) / cell_size * columns() + (corner.x - area.x) / cell_size);
  }
  cv::Rect cell(std::size_t index) const {
    const int row = static_cast<int>(index) / columns();
    const int column = static_cast<int>(index) % columns();
    return cv::Rect(area.x + column * cell_size, area.y + row * cell_size, cell_size, cell_size) & area;
  }
};

// The part of the level in which corners may lie.
cv::Rect searched_area(const cv::Mat& level, int border) {
  return {border, border, level.cols - 2 * border, level.rows - 2 * border};
}

struct RankedCorner {
  Corner corner;
  int square = 0;
  int rank = 0;  // within its square, strongest first
};

// Memory of a detection, kept by its thread from one to the next.
struct Memory {
  std::vector<std::uint8_t> strengths;
  std::vector<std::uint8_t> cell;
  std::vector<Corner> corners;
  std::vector<int> found;
  std::vector<bool> poor;
  std::vector<RankedCorner> ranked;
};

Memory& memory_of_thread() {
  thread_local Memory memory;
  return memory;
}

// Pixels of an image that is used for a while.
cv::Mat scratch_image(std::vector<std::uint8_t>& memory, cv::Size size) {
  memory.resize(std::max(memory.size(), static_cast<std::size_t>(size.area())));
  return {size, CV_8U, memory.data()};
}

// Corners of one cell at the lower threshold, each stronger than its neighbours in the cell.
void search_cell(const cv::Mat& strengths, const cv::Rect& cell, int threshold, std::vector<std::uint8_t>& memory,
                 std::vector<Corner>& corners) {
  cv::Mat widened = scratch_image(memory, {cell.width + 2, cell.height + 2});
  std::fill_n(memory.begin(), widened.total(), std::uint8_t{0});
  const cv::Rect inside(1, 1, cell.width, cell.height);
  strengths(cell).copyTo(widened(inside));
  const std::size_t before = corners.size();
  append_peaks(widened, inside, threshold, corners);
  for (std::size_t i = before; i < corners.size(); ++i) {
    corners[i].x += cell.x - 1;
    corners[i].y += cell.y - 1;
  }
}

// Looks again, with the lower threshold, into the cells that gave less than their share of the corners wanted.
void search_poor_cells(const cv::Mat& strengths, int max_corners, const DetectOptions& options, Memory& memory) {
  std::vector<Corner>& corners = memory.corners;
  const CellGrid grid{searched_area(strengths, options.border), options.cell_size};
  std::vector<int>& found = memory.found;
  found.assign(grid.size(), 0);
  for (const Corner& corner : corners) ++found[grid.index_of(corner)];
  std::vector<bool>& poor = memory.poor;
  poor.assign(grid.size(), false);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    poor[i] = static_cast<double>(found[i]) * grid.area.area() < static_cast<double>(max_corners) * grid.cell(i).area();
  }
  // Corners of poor cells are found again.
  std::erase_if(corners, [&](const Corner& corner) { return poor[grid.index_of(corner)]; });
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (poor[i]) search_cell(strengths, grid.cell(i), options.min_fast_threshold, memory.cell, corners);
  }
}

// Refills `ranked`.
void rank_in_squares(const std::vector<Corner>& corners, const cv::Size& size, int max_corners,
                     std::vector<RankedCorner>& ranked) {
  const double area = static_cast<double>(size.width) * size.height;
  const double side = std::max(1.0, std::sqrt(area / std::max(1, max_corners)));
  const int columns = static_cast<int>(size.width / side) + 1;
  ranked.clear();
  for (const Corner& corner : corners) {
    ranked.push_back({corner, static_cast<int>(corner.y / side) * columns + static_cast<int>(corner.x / side), 0});
  }
  std::sort(ranked.begin(), ranked.end(), [](const RankedCorner& a, const RankedCorner& b) {
    return std::tuple(a.square, -a.corner.response, a.corner.y, a.corner.x) <
           std::tuple(b.square, -b.corner.response, b.corner.y, b.corner.x);
  });
  for (std::size_t i = 1; i < ranked.size(); ++i) {
    if (ranked[i].square == ranked[i - 1].square) ranked[i].rank = ranked[i - 1].rank + 1;
  }
}

}  // namespace

std::vector<Corner> detect_corners(const cv::Mat& level, int max_corners, const DetectOptions& options) {
  const cv::Rect area = level.empty() ? cv::Rect() : searched_area(level, options.border);
  if (std::min(area.width, area.height) <= 0) return {};
  Memory& memory = memory_of_thread();
  cv::Mat strengths = scratch_image(memory.strengths, level.size());
  measure_fast_strengths(level, area, std::min(options.fast_threshold, options.min_fast_threshold), strengths);
  memory.corners.clear();
  append_peaks(strengths, area, options.fast_threshold, memory.corners);
  search_poor_cells(strengths, max_corners, options, memory);

  std::vector<RankedCorner>& ranked = memory.ranked;
  rank_in_squares(memory.corners, level.size(), max_corners, ranked);
  const std::size_t wanted = std::min(ranked.size(), static_cast<std::size_t>(std::max(0, max_corners)));
  const auto by_rank = [](const RankedCorner& a, const RankedCorner& b) {
    return std::tuple(a.rank, -a.corner.response, a.square) < std::tuple(b.rank, -b.corner.response, b.square);
  };
  if (wanted < ranked.size()) {
    std::nth_element(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(wanted), ranked.end(), by_rank);
  }
  ranked.resize(wanted);
  std::sort(ranked.begin(), ranked.end(), [](const RankedCorner& a, const RankedCorner& b) {
    return std::tuple(a.square, a.rank) < std::tuple(b.square, b.rank);
  });
  std::vector<Corner> spread;
  spread.reserve(ranked.size());
  for (const RankedCorner& candidate : ranked) spread.push_back(candidate.corner);
  return spread;
}

}  // namespace byre
