// The feed store behind the eastern gable: bales, a heap of silage, barrels and shelves around free floor.

#include "byre/simulation/cowshed/cowshed_parts.h"

#include <cmath>
#include <numbers>

namespace byre {
namespace {

using Eigen::Vector3f;

constexpr float kWest = kCowshedSize.length + 0.15f;
constexpr float kEast = kCowshedSize.length + kCowshedSize.store_length;
constexpr float kStoreHalfWidth = kCowshedSize.store_half_width;
constexpr float kHeight = kCowshedSize.store_height;
constexpr float kStorePlinth = 1.2f;  // height of concrete walls, metres

const Material kStoreConcrete{.texture = BarnTexture::concrete, .brightness = 0.9f, .texture_width = 1.9f};
const Material kStorePlanks{.texture = BarnTexture::planks, .brightness = 0.9f, .texture_width = 1.5f};
const Material kStoreTimber{.texture = BarnTexture::timber, .texture_width = 1.1f};

// A wall between two points on the floor, seen from its right; concrete up to the plinth, planks above.
void add_wall(QuadMesh& mesh, const Vector3f& from, const Vector3f& to) {
  add_panel(mesh, from, to - from, {0.0f, 0.0f, kStorePlinth}, kStoreConcrete);
  add_panel(mesh, from + Vector3f(0.0f, 0.0f, kStorePlinth), to - from, {0.0f, 0.0f, kHeight - kStorePlinth},
            kStorePlanks);
}

void add_walls(Cowshed& barn) {
  QuadMesh& mesh = barn.still;
  constexpr float kGate = kCowshedSize.gate_half_width;
  add_wall(mesh, {kEast, -kStoreHalfWidth, 0.0f}, {kWest, -kStoreHalfWidth, 0.0f});
  add_wall(mesh, {kWest, -kStoreHalfWidth, 0.0f}, {kWest, -kGate, 0.0f});
  add_wall(mesh, {kWest, kGate, 0.0f}, {kWest, kStoreHalfWidth, 0.0f});
  add_wall(mesh, {kWest, kStoreHalfWidth, 0.0f}, {kEast, kStoreHalfWidth, 0.0f});
  add_wall(mesh, {kEast, kStoreHalfWidth, 0.0f}, {kEast, -kStoreHalfWidth, 0.0f});
  const float lintel = kCowshedSize.gate_height;
  add_panel(mesh, {kWest, -kGate, lintel}, {0.0f, 2.0f * kGate, 0.0f}, {0.0f, 0.0f, kHeight - lintel}, kStorePlanks);
  const float middle = 0.5f * (kWest + kEast);
  add_outline_of_box(barn, make_isometry({kEast, 0.0f, 0.0f}), {0.1f, kStoreHalfWidth, 1.0f});
  for (const float y : {-kStoreHalfWidth, kStoreHalfWidth}) {
    add_outline_of_box(barn, make_isometry({middle, y, 0.0f}), {0.5f * (kEast - kWest), 0.1f, 1.0f});
  }
}

// A ceiling with a daylight strip along its middle.
void add_ceiling(Cowshed& barn, float daylight, SeededDraws& draws) {
  constexpr float kStrip = 0.5f;  // half of the strip's width, metres
  const float length = kEast - kWest;
  const auto add_part = [&](float from_y, float to_y, const Material& material) {
    add_panel(barn.still, {kWest, to_y, kHeight}, {length, 0.0f, 0.0f}, {0.0f, from_y - to_y, 0.0f}, material);
  };
  const Material sheet{.texture = BarnTexture::roof_sheet, .texture_width = 2.2f};
  add_part(-kStoreHalfWidth, -kStrip, sheet);
  add_part(kStrip, kStoreHalfWidth, sheet);
  Material sky = sheet;
  sky.glow = daylight;
  add_part(-kStrip, kStrip, sky);
  for (float x = kWest + 1.2f; x < kEast; x += 2.1f) {
    add_box(barn.still, make_isometry({x, 0.0f, kHeight - 0.13f}), {0.07f, kStoreHalfWidth, 0.12f},
            varied(kStoreTimber, draws));
  }
  barn.light.windows.push_back({{0.5f * (kWest + kEast), 0.0f, kHeight},
                                {0.5f * length, 0.0f, 0.0f},
                                {0.0f, kStrip, 0.0f},
                                -Vector3f::UnitZ(),
                                daylight});
}

// Stacked bales along the northern wall, each slightly rotated.
void add_bales(Cowshed& barn, SeededDraws& draws) {
  const Vector3f half_size(0.45f, 0.24f, 0.21f);
  const Material straw{.texture = BarnTexture::straw, .brightness = 0.9f, .texture_width = 1.0f};
  for (float x = kWest + 3.0f; x < kEast - 0.6f; x += 2.05f * half_size.x()) {
    const int layers = 2 + draws.below(5);
    for (int layer = 0; layer < layers; ++layer) {
      const float z = (2.0f * static_cast<float>(layer) + 1.0f) * half_size.z();
      const Vector3f place(x + draws.between(-0.05f, 0.05f), kStoreHalfWidth - 0.4f - draws.between(0.0f, 0.3f), z);
      add_box(barn.still, make_isometry(place, draws.between(-0.12f, 0.12f)), half_size, varied(straw, draws));
    }
    add_outline_of_box(barn, make_isometry({x, kStoreHalfWidth - 0.5f, 0.0f}), half_size);
  }
}

// Silage against the southern wall, steepest at the wall.
void add_heap(QuadMesh& mesh, float x, float length, SeededDraws& draws) {
  const float phases[] = {draws.between(0.0f, 6.0f), draws.between(0.0f, 6.0f)};
  const auto point_at = [&](float u, float v) -> Vector3f {
    const float end = std::sin(std::numbers::pi_v<float> * u);
    const float slope = std::cos(0.5f * std::numbers::pi_v<float> * v);
    const float uneven = 1.0f + 0.13f * std::sin(11.0f * u + phases[0]) + 0.1f * std::sin(7.0f * v + 17.0f * u) +
                         0.06f * std::sin(31.0f * u + 19.0f * v + phases[1]);
    return {x + u * length, -kStoreHalfWidth + v * (0.6f + 1.4f * end), 1.7f * end * slope * uneven + 0.004f};
  };
  const Material feed{.texture = BarnTexture::feed, .brightness = 0.9f, .texture_width = 1.1f};
  add_grid(
      mesh, 40, 16, [&](float u, float v) { return point_at(1.0f - u, 1.0f - v); }, {length, 2.0f}, feed);
}

// Barrels and crates in front of the eastern wall, boards above them.
void add_stock(Cowshed& barn, SeededDraws& draws) {
  const Material plastic{.texture = BarnTexture::plastic, .brightness = 0.7f, .texture_width = 1.0f};
  const Material wood{.texture = BarnTexture::planks, .texture_width = 1.3f};
  for (float y = -2.2f; y < 3.0f; y += 0.85f) {
    const Vector3f foot(kEast - draws.between(0.4f, 0.7f), y, 0.0f);
    if (draws.below(2) == 0) {
      add_drum(barn.still, foot, foot + Vector3f(0.0f, 0.0f, 0.9f), 0.29f, 0.29f, varied(plastic, draws));
    } else {
      add_box(barn.still, make_isometry(foot + Vector3f(0.0f, 0.0f, 0.35f), draws.between(-0.2f, 0.2f)),
              {0.3f, 0.33f, 0.35f}, varied(wood, draws));
    }
    add_outline_of_box(barn, make_isometry(foot), {0.29f, 0.29f, 0.9f});
  }
  for (const float z : {1.5f, 2.1f}) {
    add_box(barn.still, make_isometry({kEast - 0.2f, 0.4f, z}), {0.2f, 2.8f, 0.02f}, varied(kStoreTimber, draws));
    for (float y = -2.2f; y < 3.0f; y += 0.3f) {
      const float height = draws.between(0.05f, 0.2f);
      add_box(barn.still, make_isometry({kEast - 0.2f, y, z + height}, draws.between(-0.4f, 0.4f)),
              {0.1f, 0.1f, height}, varied(draws.below(2) == 0 ? plastic : wood, draws));
    }
  }
}

}  // namespace

void add_store(Cowshed& barn, BarnTime time, std::uint64_t seed) {
  SeededDraws draws(seed, 25);
  add_panel(barn.still, {kCowshedSize.length, -kStoreHalfWidth, 0.0f}, {kEast - kCowshedSize.length, 0.0f, 0.0f},
            {0.0f, 2.0f * kStoreHalfWidth, 0.0f}, kStoreConcrete, 0.4f);
  add_walls(barn);
  add_ceiling(barn, time == BarnTime::day ? 3.0f : 0.12f, draws);
  add_bales(barn, draws);
  add_heap(barn.still, kWest + 1.5f, 3.2f, draws);
  add_heap(barn.still, kWest + 5.0f, 4.2f, draws);
  add_stock(barn, draws);
  for (const float x : {kWest + 2.6f, kWest + 6.8f}) add_lamp(barn, {x, 0.0f, 3.3f}, kHeight, time);
}

}  // namespace byre
