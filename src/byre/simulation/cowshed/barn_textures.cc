#include "byre/simulation/cowshed/barn_textures.h"

#include "byre/simulation/row_workers.h"
#include "byre/simulation/tiling_canvas.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

constexpr int kFineSize = 1024;  // texels a side of textures seen from near
constexpr int kSmallSize = 512;
constexpr float kUpright = 0.5f * std::numbers::pi_v<float>;

// Two noise layers, common to most materials: blotches and single-texel grain.
struct Grain {
  Grain(int picture_size, SeededDraws& draws)
      : size(picture_size),
        broad(tiling_noise(size, 4, 4, 7, draws.bits())),
        fine(tiling_noise(size, size / 16, size / 16, 4, draws.bits())) {}

  float at(int column, int row, float broad_part, float fine_part) const {
    const auto i = static_cast<std::size_t>(row * size + column);
    return broad_part * broad[i] + fine_part * fine[i];
  }

  int size;
  std::vector<float> broad;
  std::vector<float> fine;
};

// 0 on a line between cells of a width, 1 away from it.
float away_from_line(int place, int cell, float line_width) {
  const int within = place % cell;
  return std::clamp((static_cast<float>(std::min(within, cell - 1 - within)) - line_width) / 2.0f, 0.0f, 1.0f);
}

TilingCanvas draw_concrete(SeededDraws& draws) {
  TilingCanvas canvas(kFineSize, 0.0f);
  const Grain grain(kFineSize, draws);
  canvas.fill([&](int column, int row, float) { return 0.42f + grain.at(column, row, 0.13f, 0.05f); });
  canvas.scatter({.count = 5200, .length = {0, 3}, .width = {1.5f, 4.5f}, .reflectance = {0.14f, 0.68f}}, draws);
  canvas.scatter({.count = 320, .length = {8, 45}, .width = {1, 2.2f}, .reflectance = {0.15f, 0.8f}}, draws);
  const auto side = static_cast<float>(kFineSize);
  for (int i = 0; i < 9; ++i) {
    canvas.crack({.x = draws.between(0.0f, side),
                  .y = draws.between(0.0f, side),
                  .direction = draws.between(-3.0f, 3.0f),
                  .length = draws.between(14.0f, 34.0f),
                  .width = draws.between(1.4f, 3.2f),
                  .reflectance = 0.12f},
                 14, draws);
  }
  return canvas;
}

TilingCanvas draw_dung(SeededDraws& draws) {
  TilingCanvas canvas(kFineSize, 0.0f);
  const Grain grain(kFineSize, draws);
  canvas.fill([&](int column, int row, float) {
    const float slot = away_from_line(row, 128, 7.0f);  // gaps of a slatted floor
    return (0.2f + grain.at(column, row, 0.1f, 0.05f)) * (0.35f + 0.65f * slot);
  });
  canvas.scatter({.count = 240, .length = {4, 26}, .width = {8, 26}, .reflectance = {0.06f, 0.24f}}, draws);
  canvas.scatter({.count = 1500, .length = {8, 40}, .width = {1, 2.5f}, .reflectance = {0.2f, 0.55f}}, draws);
  return canvas;
}

void draw_knots(TilingCanvas& canvas, int count, SeededDraws& draws) {
  const auto side = static_cast<float>(canvas.size());
  for (int i = 0; i < count; ++i) {
    TilingCanvas::Stroke knot{.x = draws.between(0.0f, side),
                              .y = draws.between(0.0f, side),
                              .direction = kUpright,
                              .length = draws.between(4.0f, 14.0f),
                              .width = draws.between(9.0f, 18.0f),
                              .reflectance = 0.2f};
    canvas.draw(knot);
    knot.width *= 0.5f;
    knot.reflectance = 0.1f;
    canvas.draw(knot);
  }
}

// Boards of equal width and different greys, with gaps and joints at different heights.
TilingCanvas draw_boards(int board_width, float darkest, float brightest, SeededDraws& draws) {
  TilingCanvas canvas(kFineSize, 0.0f);
  const Grain blotches(kFineSize, draws);
  const std::vector<float> fibres = tiling_noise(kFineSize, 128, 4, 4, draws.bits());
  std::vector<float> tones;
  for (int i = 0; i < kFineSize / board_width; ++i) tones.push_back(draws.between(darkest, brightest));
  canvas.fill([&](int column, int row, float) {
    const int board = column / board_width;
    const float fibre = fibres[static_cast<std::size_t>(row * kFineSize + column)];
    const float wood = tones[static_cast<std::size_t>(board)] + 0.08f * fibre + blotches.at(column, row, 0.05f, 0.015f);
    const float joint = away_from_line(row + 389 * board, kFineSize, 2.0f);
    return wood * (0.2f + 0.8f * away_from_line(column, board_width, 2.0f) * joint);
  });
  canvas.scatter({.count = 700,
                  .direction = kUpright,
                  .spread = 0.1f,
                  .length = {6, 70},
                  .width = {1, 2.4f},
                  .reflectance = {0.08f, 0.55f}},
                 draws);
  draw_knots(canvas, 46, draws);
  return canvas;
}

TilingCanvas draw_stalks(int count, float longest, float darkest, float brightest, SeededDraws& draws) {
  TilingCanvas canvas(kFineSize, 0.0f);
  const Grain grain(kFineSize, draws);
  canvas.fill([&](int column, int row, float) { return 0.16f + grain.at(column, row, 0.05f, 0.04f); });
  canvas.scatter({.count = count,
                  .length = {0.25f * longest, longest},
                  .width = {1.6f, 5.0f},
                  .reflectance = {darkest, brightest}},
                 draws);
  return canvas;
}

TilingCanvas draw_rust(SeededDraws& draws) {
  TilingCanvas canvas(kSmallSize, 0.0f);
  const Grain grain(kSmallSize, draws);
  canvas.fill([&](int column, int row, float) {
    const float rust = std::clamp(grain.at(column, row, 0.9f, 0.5f) - 0.1f, 0.0f, 1.0f);
    return 0.48f + grain.at(column, row, 0.04f, 0.04f) - 0.3f * rust;
  });
  canvas.scatter({.count = 420, .length = {2, 40}, .width = {1, 2}, .reflectance = {0.12f, 0.8f}}, draws);
  canvas.scatter({.count = 260, .length = {0, 5}, .width = {2, 5}, .reflectance = {0.1f, 0.7f}}, draws);
  return canvas;
}

TilingCanvas draw_roof_sheet(SeededDraws& draws) {
  TilingCanvas canvas(kFineSize, 0.0f);
  const Grain grain(kFineSize, draws);
  canvas.fill([&](int column, int row, float) {
    const float wave = std::sin(2.0f * std::numbers::pi_v<float> * static_cast<float>(column) / 64.0f);
    const float seam = away_from_line(row, 512, 3.0f);
    return (0.36f + 0.1f * wave + grain.at(column, row, 0.09f, 0.02f)) * (0.5f + 0.5f * seam);
  });
  canvas.scatter({.count = 340, .length = {2, 34}, .width = {4, 16}, .reflectance = {0.16f, 0.55f}}, draws);
  return canvas;
}

TilingCanvas draw_hide(SeededDraws& draws) {
  TilingCanvas canvas(kSmallSize, 0.0f);
  const Grain grain(kSmallSize, draws);
  const std::vector<float> patches = tiling_noise(kSmallSize, 4, 4, 2, draws.bits());
  canvas.fill([&](int column, int row, float) {
    const float patch = patches[static_cast<std::size_t>(row * kSmallSize + column)] + grain.at(column, row, 0.1f, 0);
    return 0.1f + 0.62f * std::clamp(8.0f * patch + 0.5f, 0.0f, 1.0f) + grain.at(column, row, 0.0f, 0.04f);
  });
  canvas.scatter({.count = 1500,
                  .direction = kUpright,
                  .spread = 0.5f,
                  .length = {5, 18},
                  .width = {1, 1.5f},
                  .reflectance = {0.05f, 0.5f}},
                 draws);
  return canvas;
}

TilingCanvas draw_plastic(SeededDraws& draws) {
  TilingCanvas canvas(kSmallSize, 0.0f);
  const Grain grain(kSmallSize, draws);
  canvas.fill([&](int column, int row, float) { return 0.6f + grain.at(column, row, 0.08f, 0.02f); });
  canvas.scatter({.count = 260, .length = {6, 60}, .width = {1, 3}, .reflectance = {0.2f, 0.85f}}, draws);
  canvas.scatter({.count = 60, .length = {2, 20}, .width = {6, 20}, .reflectance = {0.15f, 0.4f}}, draws);
  return canvas;
}

// A framed board with a number, a few bars under it, and dirt.
void draw_sign(cv::Mat board, int number, SeededDraws& draws) {
  const bool is_dark = draws.below(3) == 0;
  const cv::Scalar ground(is_dark ? 0.14 : 0.78);
  const cv::Scalar ink(is_dark ? 0.85 : 0.06);
  const int side = board.cols;
  board.setTo(ink);
  board(cv::Rect(side / 24, side / 24, side - side / 12, side - side / 12)).setTo(ground);
  std::string text(1, static_cast<char>('A' + draws.below(6)));
  text += std::to_string(number + 1);
  cv::putText(board, text, {side / 8, side * 11 / 20}, cv::FONT_HERSHEY_DUPLEX, side / 70.0, ink, side / 28,
              cv::LINE_8);
  for (int i = 0; i < 7; ++i) {
    const int left = side / 8 + i * side / 9;
    const int height = side / 12 + draws.below(side / 6);
    board(cv::Rect(left, side * 13 / 20, side / 30 + draws.below(side / 20), height)).setTo(ink);
  }
}

TilingCanvas draw_signs(SeededDraws& draws) {
  cv::Mat boards(kFineSize, kFineSize, CV_32F);
  constexpr int kBoard = kFineSize / kSignsPerSide;
  for (int i = 0; i < kSignsPerSide * kSignsPerSide; ++i) {
    const cv::Rect place(i % kSignsPerSide * kBoard, i / kSignsPerSide * kBoard, kBoard, kBoard);
    draw_sign(boards(place), i, draws);
  }
  TilingCanvas canvas(kFineSize, 0.0f);
  const Grain grain(kFineSize, draws);
  canvas.fill([&](int column, int row, float) {  // rows flipped: v points up on boards that hang
    return boards.at<float>(kFineSize - 1 - row, column) * (0.92f + grain.at(column, row, 0.12f, 0.03f));
  });
  canvas.scatter({.count = 500, .length = {1, 14}, .width = {1, 4}, .reflectance = {0.15f, 0.5f}}, draws);
  return canvas;
}

TilingCanvas draw_stains(SeededDraws& draws) {
  TilingCanvas canvas(kSmallSize, 0.0f);
  const Grain grain(kSmallSize, draws);
  canvas.fill([&](int column, int row, float) { return 0.5f + grain.at(column, row, 0.22f, 0.03f); });
  return canvas;
}

TilingCanvas draw_texture(BarnTexture texture, SeededDraws draws) {
  switch (texture) {
    case BarnTexture::concrete:
      return draw_concrete(draws);
    case BarnTexture::planks:
      return draw_boards(128, 0.2f, 0.5f, draws);
    case BarnTexture::timber:
      return draw_boards(512, 0.3f, 0.44f, draws);
    case BarnTexture::straw:
      return draw_stalks(7500, 130.0f, 0.2f, 0.8f, draws);
    case BarnTexture::feed:
      return draw_stalks(13000, 46.0f, 0.1f, 0.46f, draws);
    case BarnTexture::rust:
      return draw_rust(draws);
    case BarnTexture::roof_sheet:
      return draw_roof_sheet(draws);
    case BarnTexture::hide:
      return draw_hide(draws);
    case BarnTexture::plastic:
      return draw_plastic(draws);
    case BarnTexture::dung:
      return draw_dung(draws);
    case BarnTexture::signs:
      return draw_signs(draws);
    case BarnTexture::stains:
      break;
  }
  return draw_stains(draws);
}

}  // namespace

BarnTextures draw_barn_textures(std::uint64_t seed, int threads) {
  std::vector<std::optional<MipTexture>> drawn(kBarnTextures);
  for_each_row(kBarnTextures, threads, [&](int i) {
    const auto stream = static_cast<std::uint64_t>(i);
    const TilingCanvas canvas = draw_texture(static_cast<BarnTexture>(i), SeededDraws(seed, 1000 + stream));
    drawn[static_cast<std::size_t>(i)].emplace(canvas.size(), canvas.texels());
  });
  BarnTextures textures;
  for (std::optional<MipTexture>& texture : drawn) textures.push_back(std::move(*texture));
  return textures;
}

}  // namespace byre
