#include "byre/features/detect.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace byre {
namespace {

// Squares of the level inside its border, row by row; the last row and column may be cut off.
struct CellGrid {
  cv::Rect area;
  int cell_size;

  int columns() const { return (area.width + cell_size - 1) / cell_size; }
  int rows() const { return (area.height + cell_size - 1) / cell_size; }
  std::size_t size() const { return static_cast<std::size_t>(columns() * rows()); }
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

// Sort key of corners, smallest first: square, then decreasing strength, then row and column.
using Key = std::uint64_t;

constexpr unsigned kPlaceBits = 16, kStrengthShift = 2 * kPlaceBits, kSquareShift = kStrengthShift + 8;

Key key_of(const Corner& corner, int square) {
  const auto weakness = static_cast<Key>(255 - static_cast<int>(corner.response));
  return static_cast<Key>(square) << kSquareShift | weakness << kStrengthShift |
         static_cast<Key>(corner.y) << kPlaceBits | static_cast<Key>(corner.x);
}

Corner corner_of(Key key) {
  constexpr Key kPlace = (Key{1} << kPlaceBits) - 1;
  return {static_cast<int>(key & kPlace), static_cast<int>(key >> kPlaceBits & kPlace),
          static_cast<float>(255 - static_cast<int>(key >> kStrengthShift & 0xff))};
}

// Orders by decreasing strength, then by square.
Key key_among_equal_ranks(Key key, std::size_t square) {
  return (key >> kStrengthShift & 0xff) << 32U | static_cast<Key>(square);
}

using Corners = ScratchVector<Corner>;

// Corners by square.
struct RankedCorners {
  ScratchVector<std::size_t> begin;  // start of each square in `sorted`, and the end
  ScratchVector<Key> sorted;         // by square, strongest first
};

// Corners of one cell at the lower threshold; local maxima within the cell.
void search_cell(const cv::Mat& strengths, const cv::Rect& cell, int threshold, Corners& corners) {
  const cv::Size size(cell.width + 2, cell.height + 2);
  ScratchVector<std::uint8_t> memory(static_cast<std::size_t>(size.area()), 0);
  cv::Mat widened(size, CV_8U, memory.data());
  const cv::Rect inside(1, 1, cell.width, cell.height);
  strengths(cell).copyTo(widened(inside));
  const std::size_t before = corners.size();
  append_peaks(widened, inside, threshold, corners);
  for (std::size_t i = before; i < corners.size(); ++i) {
    corners[i].x += cell.x - 1;
    corners[i].y += cell.y - 1;
  }
}

// Searches the cells with less than their share of corners again, at the lower threshold.
void search_poor_cells(const cv::Mat& strengths, int max_corners, const DetectOptions& options, Corners& corners) {
  const CellGrid grid{searched_area(strengths, options.border), options.cell_size};
  ScratchVector<int> cell_of_column(static_cast<std::size_t>(grid.area.width));
  for (int x = 0; x < grid.area.width; ++x) cell_of_column[static_cast<std::size_t>(x)] = x / grid.cell_size;
  const auto cell_of = [&](const Corner& corner) {
    return static_cast<std::size_t>((corner.y - grid.area.y) / grid.cell_size * grid.columns() +
                                    cell_of_column[static_cast<std::size_t>(corner.x - grid.area.x)]);
  };
  ScratchVector<int> found(grid.size(), 0);
  for (const Corner& corner : corners) ++found[cell_of(corner)];
  ScratchVector<bool> poor(grid.size(), false);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    poor[i] = static_cast<double>(found[i]) * grid.area.area() < static_cast<double>(max_corners) * grid.cell(i).area();
  }
  // The second search finds the corners of these cells again.
  std::erase_if(corners, [&](const Corner& corner) { return poor[cell_of(corner)]; });
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (poor[i]) search_cell(strengths, grid.cell(i), options.min_fast_threshold, corners);
  }
}

RankedCorners rank_in_squares(const cv::Size& size, int max_corners, const Corners& corners) {
  const double area = static_cast<double>(size.width) * size.height;
  const double side = std::max(1.0, std::sqrt(area / std::max(1, max_corners)));
  const int columns = static_cast<int>(size.width / side) + 1;
  const int rows = static_cast<int>(size.height / side) + 1;
  RankedCorners ranked;
  ScratchVector<std::size_t>& begin = ranked.begin;
  begin.assign(static_cast<std::size_t>(columns * rows) + 2, 0);
  ScratchVector<int> squares;
  squares.reserve(corners.size());
  for (const Corner& corner : corners) {
    squares.push_back(static_cast<int>(corner.y / side) * columns + static_cast<int>(corner.x / side));
    ++begin[static_cast<std::size_t>(squares.back()) + 2];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  ranked.sorted.resize(corners.size());
  // Each begin advances to that of the next square.
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const int square = squares[i];
    ranked.sorted[begin[static_cast<std::size_t>(square) + 1]++] = key_of(corners[i], square);
  }
  begin.pop_back();
  for (std::size_t square = 0; square + 1 < begin.size(); ++square) {
    const auto at = [&](std::size_t i) { return ranked.sorted.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(at(begin[square]), at(begin[square + 1]));
  }
  return ranked;
}

// Number of corners that all squares contribute, and the end of the next rank's corners that are also used.
struct Selection {
  std::size_t of_all = 0;
  Key end_of_next = 0;  // see key_among_equal_ranks
};

Selection select_from_squares(std::size_t wanted, const RankedCorners& ranked) {
  ScratchVector<int> of_rank;  // number of squares with a corner of that rank
  const ScratchVector<std::size_t>& begin = ranked.begin;
  for (std::size_t square = 0; square + 1 < begin.size(); ++square) {
    const std::size_t count = begin[square + 1] - begin[square];
    if (count > of_rank.size()) of_rank.resize(count, 0);
    for (std::size_t rank = 0; rank < count; ++rank) ++of_rank[rank];
  }
  Selection share;
  for (; share.of_all < of_rank.size() && wanted >= static_cast<std::size_t>(of_rank[share.of_all]); ++share.of_all) {
    wanted -= static_cast<std::size_t>(of_rank[share.of_all]);
  }
  if (share.of_all == of_rank.size()) return share;
  ScratchVector<Key> last;  // corners of the last rank used
  for (std::size_t square = 0; square + 1 < begin.size(); ++square) {
    const std::size_t next = begin[square] + share.of_all;
    if (next < begin[square + 1]) last.push_back(key_among_equal_ranks(ranked.sorted[next], square));
  }
  const auto end = last.begin() + static_cast<std::ptrdiff_t>(wanted);
  std::nth_element(last.begin(), end, last.end());
  share.end_of_next = *end;
  return share;
}

}  // namespace

Corners detect_corners(const cv::Mat& level, int max_corners, const DetectOptions& options, cv::Mat& strengths) {
  const cv::Rect area = level.empty() ? cv::Rect() : searched_area(level, options.border);
  if (std::min(area.width, area.height) <= 0) return {};
  strengths.create(level.size(), CV_8U);
  measure_fast_strengths(level, area, std::min(options.fast_threshold, options.min_fast_threshold), strengths);
  Corners found;
  append_peaks(strengths, area, options.fast_threshold, found);
  search_poor_cells(strengths, max_corners, options, found);

  const RankedCorners ranked = rank_in_squares(level.size(), max_corners, found);
  const auto& [begin, sorted] = ranked;
  const std::size_t wanted = std::min(sorted.size(), static_cast<std::size_t>(std::max(0, max_corners)));
  const Selection share = select_from_squares(wanted, ranked);
  Corners corners;
  corners.reserve(wanted);
  for (std::size_t square = 0; square + 1 < begin.size(); ++square) {
    const std::size_t end = begin[square + 1];
    std::size_t i = begin[square];
    for (const std::size_t next = std::min(end, i + share.of_all); i < next; ++i) {
      corners.push_back(corner_of(sorted[i]));
    }
    if (i < end && key_among_equal_ranks(sorted[i], square) < share.end_of_next) {
      corners.push_back(corner_of(sorted[i]));
    }
  }
  return corners;
}

}  // namespace byre
