// Fixed fittings: fences, cubicles, signs, lamps; and the feed along the fences.

#include "byre/features/tag_detector.h"
#include "byre/simulation/cowshed/cowshed_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

using Eigen::Vector3f;

constexpr float kAlleyLength = kCowshedSize.length;
constexpr float kFence = kCowshedSize.alley_half_width;

const Material kSteel{.texture = BarnTexture::rust, .texture_width = 0.7f};
const Material kStallPlanks{.texture = BarnTexture::planks, .texture_width = 1.7f};
const Material kFloorConcrete{.texture = BarnTexture::concrete, .texture_width = 1.5f};

// A feeding place: two bars leaning towards each other, one with a shackle.
void add_feeding_place(QuadMesh& mesh, float x, float y, SeededDraws& draws) {
  const Material material = varied(kSteel, draws);
  const float lean = draws.between(0.06f, 0.17f);
  add_bar(mesh, {x, y, 0.5f}, {x, y, 1.35f}, 0.022f, material, 6);
  add_bar(mesh, {x + 0.28f, y, 0.5f}, {x + 0.28f + lean, y, 1.35f}, 0.022f, material, 6);
  add_box(mesh, make_isometry({x + 0.28f + lean, y, 1.28f}), {0.04f, 0.03f, 0.05f}, material);
}

void add_fence(Cowshed& barn, float side, SeededDraws& draws) {
  QuadMesh& mesh = barn.still;
  const float y = side * kFence;
  constexpr float kCurb = 2.5f;  // length of a curb piece, metres
  for (float x = 0.5f * kCurb; x < kAlleyLength; x += kCurb) {
    add_box(mesh, make_isometry({x, y, 0.24f}), {0.5f * kCurb, 0.15f, 0.24f}, varied(kFloorConcrete, draws), 0.4f);
  }
  add_outline_of_box(barn, make_isometry({0.5f * kAlleyLength, y, 0.0f}), {0.5f * kAlleyLength, 0.15f, 0.24f});
  for (const float z : {0.52f, 1.36f}) add_bar(mesh, {0.0f, y, z}, {kAlleyLength, y, z}, 0.03f, varied(kSteel, draws));
  for (float x = 1.25f; x < kAlleyLength; x += 2.5f) {
    const float post_x = x + draws.between(-0.08f, 0.08f);
    add_bar(mesh, {post_x, y, 0.4f}, {post_x, y, 1.6f}, 0.05f, varied(kSteel, draws), 10);
    add_drum(mesh, {post_x, y, 1.6f}, {post_x, y, 1.64f}, 0.06f, 0.05f, varied(kSteel, draws));
    for (int place = 0; place < 3; ++place) {
      if (draws.below(9) == 0) continue;  // this place lost its bars
      add_feeding_place(mesh, x + 0.3f + 0.72f * static_cast<float>(place), y, draws);
    }
  }
}

// Bent tubes between two cubicles.
void add_divider(QuadMesh& mesh, float x, float side, SeededDraws& draws) {
  const Material material = varied(kSteel, draws);
  const auto at = [&](float y, float z) { return Vector3f(x, side * y, z); };
  add_bar(mesh, at(5.6f, 1.05f), at(8.3f, 1.15f), 0.03f, material);
  add_bar(mesh, at(5.6f, 0.55f), at(8.0f, 0.5f), 0.03f, material);
  add_bar(mesh, at(5.6f, 0.55f), at(5.6f, 1.05f), 0.03f, material);
  add_bar(mesh, at(8.0f, 0.2f), at(8.0f, 1.15f), 0.04f, material);
}

void add_sign(Cowshed& barn, const Eigen::Isometry3f& world_from_sign, float half_size, int number,
              const std::string& name) {
  Material material{.texture = BarnTexture::signs};
  material.texture_width = 2.0f * half_size * kSignsPerSide;
  material.texture_offset = {static_cast<float>(number % kSignsPerSide) / kSignsPerSide,
                             static_cast<float>(number / kSignsPerSide % kSignsPerSide) / kSignsPerSide};
  const Vector3f right = half_size * world_from_sign.linear().col(0);
  const Vector3f up = half_size * world_from_sign.linear().col(1);
  const Vector3f centre = world_from_sign.translation();
  add_panel(barn.still, centre - right - up, 2.0f * right, 2.0f * up, material);
  barn.marks.push_back({name, centre.cast<double>()});
}

// Placement of an upright board, viewed along -normal.
Eigen::Isometry3f hanging(const Vector3f& centre, const Vector3f& normal) {
  Eigen::Isometry3f world_from_sign = Eigen::Isometry3f::Identity();
  world_from_sign.linear() << Vector3f::UnitZ().cross(normal), Vector3f::UnitZ(), normal;
  world_from_sign.translation() = centre;
  return world_from_sign;
}

// Signs on the columns, facing the approaching robot: north ones face west, south ones east.
void add_signs(Cowshed& barn) {
  int number = 0;
  for (const float x : bay_lines()) {
    const std::string bay = std::to_string(number / 2 + 1);
    add_sign(barn, hanging({x - 0.115f, -3.0f, 1.75f}, -Vector3f::UnitX()), 0.16f, number++, "south-column-" + bay);
    add_sign(barn, hanging({x + 0.115f, 3.0f, 1.75f}, Vector3f::UnitX()), 0.16f, number++, "north-column-" + bay);
  }
  add_sign(barn, hanging({0.02f, -3.2f, 1.9f}, Vector3f::UnitX()), 0.4f, 12, "west-gable-south");
  add_sign(barn, hanging({0.02f, 2.9f, 2.1f}, Vector3f::UnitX()), 0.3f, 13, "west-gable-north");
  add_sign(barn, hanging({kAlleyLength - 0.02f, -2.9f, 2.2f}, -Vector3f::UnitX()), 0.3f, 14, "east-gable-south");
  add_sign(barn, hanging({kAlleyLength - 0.02f, 3.3f, 1.9f}, -Vector3f::UnitX()), 0.4f, 15, "east-gable-north");
}

// A tag on a white board; each black module is a panel in front of it.
void add_tag(QuadMesh& mesh, const Tag& tag, const Eigen::Isometry3f& world_from_board) {
  constexpr float kInFront = 0.001f;  // metres
  const Material white{.texture = BarnTexture::plastic, .brightness = 1.5f};
  const Material black{.texture = BarnTexture::plastic, .brightness = 0.05f};
  const TagPicture picture = tag_picture(tag.id);
  const float module = static_cast<float>(tag.size) / static_cast<float>(picture.edge);
  const auto add = [&](float column, float row, float columns, float rows, float front, const Material& material) {
    const float x = module * (column - 0.5f * static_cast<float>(picture.modules.width));
    const float y = module * (0.5f * static_cast<float>(picture.modules.height) - row - rows);
    add_panel(mesh, world_from_board * Vector3f(x, y, front), columns * module * world_from_board.linear().col(0),
              rows * module * world_from_board.linear().col(1), material);
  };
  add(0.0f, 0.0f, static_cast<float>(picture.modules.width), static_cast<float>(picture.modules.height), 0.0f, white);
  for (int i = 0; i < picture.modules.width * picture.modules.height; ++i) {
    if (picture.modules.pixels[static_cast<std::size_t>(i)] > 127) continue;
    add(static_cast<float>(i % picture.modules.width), static_cast<float>(i / picture.modules.width), 1.0f, 1.0f,
        kInFront, black);
  }
}

// An uneven pile, highest in its middle.
void add_pile(QuadMesh& mesh, float from_x, float to_x, float side, SeededDraws& draws) {
  const float length = to_x - from_x;
  const float height = draws.between(0.22f, 0.42f);
  const float width = draws.between(0.55f, 0.8f);
  const float phases[] = {draws.between(0.0f, 6.0f), draws.between(0.0f, 6.0f), draws.between(0.0f, 6.0f)};
  const auto point_at = [&](float u, float v) -> Vector3f {
    const float x = from_x + u * length;
    const float end = std::clamp(std::min(u, 1.0f - u) * length / 0.5f, 0.0f, 1.0f);
    const float across = std::cos(0.5f * std::numbers::pi_v<float> * v);  // from the curb to the alley
    const float uneven = 1.0f + 0.2f * std::sin(2.3f * x + phases[0]) + 0.14f * std::sin(5.9f * x + phases[1]) +
                         0.12f * std::sin(9.0f * v + 3.1f * x + phases[2]) + 0.06f * std::sin(23.0f * x + 17.0f * v);
    const float reach = width * (1.0f + 0.18f * std::sin(1.7f * x + phases[2]) + 0.07f * std::sin(7.7f * x));
    return {x, side * (kFence - 0.15f - v * reach), std::max(height * end * across * uneven, 0.0f) + 0.004f};
  };
  const Material material{.texture = BarnTexture::feed,
                          .brightness = draws.between(0.75f, 1.1f),
                          .texture_width = 1.2f,
                          .texture_offset = {draws.between(0.0f, 1.0f), draws.between(0.0f, 1.0f)}};
  const int columns = std::max(4, static_cast<int>(length / 0.12f));
  if (side > 0.0f) {
    add_grid(
        mesh, columns, 8, [&](float u, float v) { return point_at(1.0f - u, v); }, {length, 0.9f}, material);
  } else {
    add_grid(mesh, columns, 8, point_at, {length, 0.9f}, material);
  }
}

}  // namespace

void add_fences(Cowshed& barn, std::uint64_t seed) {
  SeededDraws draws(seed, 21);
  for (const float side : {-1.0f, 1.0f}) add_fence(barn, side, draws);
}

void add_cubicles(Cowshed& barn, std::uint64_t seed) {
  SeededDraws draws(seed, 22);
  const Material straw{.texture = BarnTexture::straw, .brightness = 0.9f, .texture_width = 1.6f};
  for (const float side : {-1.0f, 1.0f}) {
    const Eigen::Isometry3f bed = make_isometry({0.5f * kAlleyLength, side * 6.95f, 0.1f});
    const Vector3f half_size(0.5f * kAlleyLength - 1.0f, 1.5f, 0.1f);
    add_box(barn.still, bed, half_size, straw);
    add_outline_of_box(barn, make_isometry({0.5f * kAlleyLength, side * 5.5f, 0.0f}), {half_size.x(), 0.05f, 0.1f});
    for (float x = 1.2f; x < kAlleyLength - 1.0f; x += 1.2f) {
      add_divider(barn.still, x, side, draws);
      add_outline_of_box(barn, make_isometry({x, side * 6.95f, 0.0f}), {0.03f, 1.4f, 1.0f});
    }
  }
}

void add_stall(Cowshed& barn, std::uint64_t seed) {
  SeededDraws draws(seed, 24);
  const float x = draws.between(12.0f, 20.0f);
  for (const float side : {-1.0f, 1.0f}) {
    const Eigen::Isometry3f wall = make_isometry({x + 1.5f * side, 4.0f, 0.8f});
    add_box(barn.still, wall, {0.04f, 0.9f, 0.8f}, varied(kStallPlanks, draws));
  }
  const Eigen::Isometry3f front = make_isometry({x, 3.1f, 0.8f});
  add_box(barn.still, front, {1.5f, 0.04f, 0.8f}, varied(kStallPlanks, draws));
  add_outline_of_box(barn, make_isometry({x, 4.0f, 0.0f}), {1.5f, 0.9f, 0.8f});
}

void add_fittings(Cowshed& barn, std::uint64_t seed) {
  SeededDraws draws(seed, 23);
  add_signs(barn);
  for (const float side : {-1.0f, 1.0f}) {
    add_bar(barn.still, {0.0f, side * 2.85f, 2.6f}, {kAlleyLength, side * 2.85f, 2.6f}, 0.035f, varied(kSteel, draws));
    for (const float x : {5.4f, 14.8f, 24.1f}) {  // drinking troughs
      const Eigen::Isometry3f trough = make_isometry({x, side * 3.6f, 0.4f});
      add_box(barn.still, trough, {0.6f, 0.25f, 0.4f}, varied(kFloorConcrete, draws));
      add_outline_of_box(barn, trough, {0.6f, 0.25f, 0.4f});
    }
    for (const float x : {0.55f, kAlleyLength - 0.55f}) {  // barrels in the corners of the alley
      const Vector3f foot(x, side * draws.between(1.95f, 2.05f), 0.0f);
      const Material material =
          varied({.texture = BarnTexture::plastic, .brightness = 0.6f, .texture_width = 1.0f}, draws);
      add_drum(barn.still, foot, foot + Vector3f(0.0f, 0.0f, 0.9f), 0.29f, 0.29f, material);
      add_outline_of_box(barn, make_isometry(foot), {0.29f, 0.29f, 0.9f});
    }
  }
}

// On the columns, above the signs and the fence, facing as the signs do.
void add_tags(Cowshed& barn, const CowshedOptions& options) {
  constexpr double kSize = 0.45;  // metres
  const auto bays = bay_lines();
  for (int i = 0; i < options.tags; ++i) {
    const bool is_south = i % 2 == 0;
    const float side = is_south ? -1.0f : 1.0f;
    const float x = bays[static_cast<std::size_t>(i / 2) % bays.size()] + 0.125f * side;
    const Vector3f centre(x, 2.75f * side, 2.2f);
    Tag tag{{TagFamily::tag36h11, options.first_tag + i}, kSize, {}};
    tag.survey = SurveyedTag{centre.cast<double>(), 0.005, is_south ? std::numbers::pi : 0.0};
    add_tag(barn.still, tag, hanging(centre, Vector3f(side, 0.0f, 0.0f)));
    barn.tags.push_back(tag);
  }
}

void add_lamp(Cowshed& barn, const Vector3f& middle, float ceiling, BarnTime time) {
  const bool is_lit = time == BarnTime::dusk;
  Material tube{.texture = BarnTexture::plastic};
  tube.glow = is_lit ? 6.0f : 0.0f;
  add_box(barn.still, make_isometry(middle + Vector3f(0.0f, 0.0f, 0.1f)), {0.65f, 0.08f, 0.05f}, kSteel);
  add_bar(barn.still, middle - Vector3f(0.6f, 0.0f, 0.0f), middle + Vector3f(0.6f, 0.0f, 0.0f), 0.03f, tube);
  for (const float end : {-0.5f, 0.5f}) {
    const Vector3f hook = middle + Vector3f(end, 0.0f, 0.1f);
    add_bar(barn.still, hook, {hook.x(), hook.y(), ceiling}, 0.008f, kSteel, 5);
  }
  if (is_lit) barn.light.lamps.push_back({middle - Vector3f(0.0f, 0.0f, 0.1f), 1.3f});
}

void add_lamps(Cowshed& barn, BarnTime time) {
  for (float x = kCowshedSize.bay; x < kAlleyLength - 0.1f; x += kCowshedSize.bay) {
    add_lamp(barn, {x, 0.0f, 3.5f}, kCowshedSize.ridge, time);
  }
}

void add_feed(Cowshed& barn, const CowshedOptions& options) {
  SeededDraws draws(hash(options.seed, static_cast<std::uint64_t>(options.mission), 0), 24);
  for (const float side : {-1.0f, 1.0f}) {
    float x = draws.between(1.5f, 3.0f);
    while (x < kAlleyLength - 4.0f) {
      const float end = std::min(x + draws.between(2.5f, 6.0f), kAlleyLength - 1.5f);
      add_pile(barn.still, x, end, side, draws);
      x = end + draws.between(0.6f, 1.6f);
    }
  }
}

}  // namespace byre
