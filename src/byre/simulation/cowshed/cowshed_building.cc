// The building: floor, walls, roof and load-bearing frame.

#include "byre/simulation/cowshed/cowshed_parts.h"

#include <cmath>
#include <numbers>

namespace byre {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kLength = kCowshedSize.length;
constexpr float kHalfWidth = kCowshedSize.half_width;
constexpr float kCurbInside = kCowshedSize.alley_half_width - 0.15f;
constexpr float kCurbOutside = kCowshedSize.alley_half_width + 0.15f;
constexpr float kPlinth = 1.2f;  // height of concrete walls, metres

const Material kConcrete{.texture = BarnTexture::concrete, .texture_width = 2.2f};
const Material kPlanks{.texture = BarnTexture::planks, .texture_width = 1.7f};
const Material kTimber{.texture = BarnTexture::timber, .texture_width = 1.3f};
const Material kRoof{.texture = BarnTexture::roof_sheet, .brightness = 1.1f, .texture_width = 2.6f};

void add_floor(Cowshed& barn, SeededDraws& draws) {
  constexpr float kSlab = 2.5f;  // metres along the alley
  const Material dung{.texture = BarnTexture::dung, .texture_width = 1.9f};
  for (float x = 0.0f; x < kLength - 0.1f; x += kSlab) {
    const auto add_slab = [&](float from_y, float to_y, const Material& material) {
      add_panel(barn.still, {x, from_y, 0.0f}, {kSlab, 0.0f, 0.0f}, {0.0f, to_y - from_y, 0.0f},
                varied(material, draws), 0.4f);
    };
    add_slab(-kCurbInside, 0.0f, kConcrete);
    add_slab(0.0f, kCurbInside, kConcrete);
    add_slab(kCurbOutside, kHalfWidth, dung);
    add_slab(-kHalfWidth, -kCurbOutside, dung);
  }
}

// Part of a gable between two heights and two y, seen from inside. to_roof: the roof is its upper edge.
void add_gable_part(QuadMesh& mesh, float x, const Vector2f& y_range, const Vector2f& z_range, bool to_roof,
                    const Material& material) {
  const auto point_at = [&](float u, float v) -> Vector3f {
    const float y = y_range.x() + u * (y_range.y() - y_range.x());
    const float top = to_roof ? roof_height(y) : z_range.y();
    return {x, y, z_range.x() + v * (top - z_range.x())};
  };
  const float width = std::abs(y_range.y() - y_range.x());
  const float height = z_range.y() - z_range.x();
  add_grid(mesh, static_cast<int>(std::ceil(width / 0.4f)), static_cast<int>(std::ceil(height / 0.4f)), point_at,
           {width, height}, material);
}

// A gable of concrete below and planks above, with an opening for a gate. inward: x direction of the barn's interior, 1
// or -1.
void add_gable(Cowshed& barn, float x, float inward, SeededDraws& draws) {
  constexpr float kGate = kCowshedSize.gate_half_width;
  for (const float side : {-1.0f, 1.0f}) {
    const bool is_left = side * inward < 0.0f;  // as seen from inside
    const float outer = side * kHalfWidth;
    const Vector2f y_range = is_left ? Vector2f(outer, side * kGate) : Vector2f(side * kGate, outer);
    add_gable_part(barn.still, x, y_range, {0.0f, kPlinth}, false, varied(kConcrete, draws));
    add_gable_part(barn.still, x, y_range, {kPlinth, kCowshedSize.gate_height}, false, varied(kPlanks, draws));
    const float middle = 0.5f * (kGate + kHalfWidth);
    add_outline_of_box(barn, make_isometry({x, side * middle, 0.0f}), {0.1f, kHalfWidth - middle, 1.0f});
  }
  add_gable_part(barn.still, x, inward * Vector2f(-kHalfWidth, kHalfWidth),
                 {kCowshedSize.gate_height, kCowshedSize.ridge}, true, varied(kPlanks, draws));
}

// Two steel leaves with wooden bars that open away from the barn. inward: as for add_gable.
void add_gate(QuadMesh& mesh, float x, float inward, BarnGate state) {
  const Material steel{.texture = BarnTexture::rust, .brightness = 0.8f, .texture_width = 1.1f};
  constexpr float kLeaf = 0.5f * kCowshedSize.gate_half_width;  // half of a leaf's width
  for (const float side : {-1.0f, 1.0f}) {
    const float swing = state == BarnGate::open ? -0.5f * std::numbers::pi_v<float> * side * inward : 0.0f;
    const Eigen::Isometry3f hinge = make_isometry({x + 0.08f * inward, side * 2.0f * kLeaf, 0.0f}, swing);
    const auto in_leaf = [&](float out_of_leaf, float z) {
      return hinge * make_isometry({out_of_leaf * inward, -side * kLeaf, z});
    };
    add_box(mesh, in_leaf(0.0f, 1.55f), {0.05f, kLeaf - 0.02f, 1.5f}, steel);
    for (const float z : {0.35f, 1.4f, 2.5f}) add_box(mesh, in_leaf(0.07f, z), {0.03f, kLeaf - 0.05f, 0.06f}, kTimber);
  }
}

// Side wall of one bay: plinth, boards, an open band that lets daylight in, boards.
void add_side_bay(Cowshed& barn, float x, float side, float daylight, SeededDraws& draws) {
  const float y = side * kHalfWidth;
  constexpr float kSill = 1.75f;
  constexpr float kLintel = 2.9f;
  const auto add_band = [&](float from_z, float to_z, const Material& material) {
    const Vector3f along(side > 0.0f ? kCowshedSize.bay : -kCowshedSize.bay, 0.0f, 0.0f);
    add_panel(barn.still, {side > 0.0f ? x : x + kCowshedSize.bay, y, from_z}, along, {0.0f, 0.0f, to_z - from_z},
              material);
  };
  add_band(0.0f, kPlinth, varied(kConcrete, draws));
  add_band(kPlinth, kSill, varied(kPlanks, draws));
  add_band(kLintel, kCowshedSize.eaves, varied(kPlanks, draws));
  Material sky = kPlanks;
  sky.glow = daylight;
  add_band(kSill, kLintel, sky);
  for (int i = 1; i < 5; ++i) {  // slats in front of the opening
    const float slat_x = x + kCowshedSize.bay * static_cast<float>(i) / 5.0f;
    add_box(barn.still, make_isometry({slat_x, y - 0.05f * side, 0.5f * (kSill + kLintel)}), {0.05f, 0.03f, 0.6f},
            varied(kTimber, draws));
  }
  barn.light.windows.push_back({{x + 0.5f * kCowshedSize.bay, y, 0.5f * (kSill + kLintel)},
                                {0.5f * kCowshedSize.bay, 0.0f, 0.0f},
                                {0.0f, 0.0f, 0.5f * (kLintel - kSill)},
                                {0.0f, -side, 0.0f},
                                daylight});
}

// One bay of a roof slope, with a translucent sheet in its middle.
void add_roof_bay(Cowshed& barn, float x, float side, float daylight, SeededDraws& draws) {
  const Vector3f eaves(0.0f, side * kHalfWidth, kCowshedSize.eaves);
  const Vector3f slope = Vector3f(0.0f, 0.0f, kCowshedSize.ridge) - eaves;
  const auto add_sheet = [&](float from_x, float to_x, const Material& material) {  // normal points down
    const float begin = side > 0.0f ? from_x : to_x;
    add_panel(barn.still, eaves + Vector3f(begin, 0.0f, 0.0f),
              {side > 0.0f ? to_x - from_x : from_x - to_x, 0.0f, 0.0f}, slope, material, 0.6f);
  };
  const float sheet_from = x + 0.39f * kCowshedSize.bay;
  const float sheet_to = x + 0.61f * kCowshedSize.bay;
  add_sheet(x, sheet_from, varied(kRoof, draws));
  add_sheet(sheet_to, x + kCowshedSize.bay, varied(kRoof, draws));
  Material sheet = kRoof;
  sheet.glow = daylight;
  add_sheet(sheet_from, sheet_to, sheet);
  const Vector3f inward = Vector3f(0.0f, -side * slope.z(), -std::abs(slope.y())).normalized();
  barn.light.windows.push_back({eaves + 0.5f * slope + Vector3f(0.5f * (sheet_from + sheet_to), 0.0f, 0.0f),
                                {0.5f * (sheet_to - sheet_from), 0.0f, 0.0f},
                                0.5f * slope,
                                inward,
                                daylight});
}

void add_beam(QuadMesh& mesh, const Vector3f& from, const Vector3f& to, float half_width, float half_height,
              const Material& material) {
  const Vector3f along = (to - from).normalized();
  const Vector3f sideways = Vector3f::UnitZ().cross(along).normalized();
  Eigen::Isometry3f world_from_beam = Eigen::Isometry3f::Identity();
  world_from_beam.linear() << sideways, along.cross(sideways), along;  // grain runs along the beam
  world_from_beam.translation() = 0.5f * (from + to);
  add_box(mesh, world_from_beam, {half_width, half_height, 0.5f * (to - from).norm()}, material);
}

void add_column(Cowshed& barn, float x, float y, const Material& post, const Material& foot) {
  const float height = 0.5f * roof_height(y);
  const Vector3f half_size(0.1f, 0.1f, height);
  add_box(barn.still, make_isometry({x, y, height}), half_size, post);
  add_box(barn.still, make_isometry({x, y, 0.3f}), {0.19f, 0.19f, 0.3f}, foot);
  add_outline_of_box(barn, make_isometry({x, y, 0.0f}), {0.19f, 0.19f, 1.0f});
}

void add_truss(Cowshed& barn, float x, SeededDraws& draws) {
  const Vector3f ridge(x, 0.0f, kCowshedSize.ridge - 0.2f);
  constexpr float kTie = 3.55f;  // height of the cross beam, metres
  for (const float side : {-1.0f, 1.0f}) {
    const float inner_y = side * 3.0f;
    add_beam(barn.still, {x, side * kHalfWidth, kCowshedSize.eaves - 0.15f}, ridge, 0.08f, 0.12f,
             varied(kTimber, draws));
    add_beam(barn.still, {x, inner_y, kTie}, {x, 0.4f * inner_y, roof_height(0.4f * inner_y) - 0.2f}, 0.05f, 0.07f,
             varied(kTimber, draws));
    add_column(barn, x, inner_y, varied(kTimber, draws), varied(kConcrete, draws));
    add_box(barn.still, make_isometry({x, side * (kHalfWidth - 0.12f), 1.7f}), {0.1f, 0.1f, 1.7f},
            varied(kTimber, draws));
  }
  add_beam(barn.still, {x, -kHalfWidth, kTie}, {x, kHalfWidth, kTie}, 0.07f, 0.12f, varied(kTimber, draws));
}

}  // namespace

Material varied(Material material, SeededDraws& draws) {
  material.texture_offset = {draws.between(0.0f, 1.0f), draws.between(0.0f, 1.0f)};
  material.brightness *= draws.between(0.8f, 1.15f);
  return material;
}

float roof_height(float y) {
  return kCowshedSize.ridge - (kCowshedSize.ridge - kCowshedSize.eaves) * std::abs(y) / kHalfWidth;
}

std::vector<float> bay_lines() {
  std::vector<float> lines;
  for (float x = 0.5f * kCowshedSize.bay; x < kLength; x += kCowshedSize.bay) lines.push_back(x);
  return lines;
}

void add_outline_of_box(Cowshed& barn, const Eigen::Isometry3f& world_from_box, const Vector3f& half_size) {
  PlanOutline outline;
  for (const auto& [x, y] : {std::pair(-1.0f, -1.0f), {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
    const Vector3f corner = world_from_box * Vector3f(x * half_size.x(), y * half_size.y(), 0.0f);
    outline.corners_in_world.emplace_back(corner.head<2>().cast<double>());
  }
  barn.outlines.push_back(outline);
}

void add_shell(Cowshed& barn, const CowshedOptions& options) {
  const bool is_day = time_of(options) == BarnTime::day;
  SeededDraws draws(options.seed, 12), paint(options.seed, 13);
  add_floor(barn, draws);
  add_gable(barn, 0.0f, 1.0f, draws);
  Cowshed unpainted;
  add_gable(options.painted ? unpainted : barn, kLength, -1.0f, draws);
  if (options.painted) add_gable(barn, kLength, -1.0f, paint);
  for (float x = 0.0f; x < kLength - 0.1f; x += kCowshedSize.bay) {
    add_side_bay(barn, x, 1.0f, is_day ? 3.6f : 0.16f, draws);  // the sun is south, behind the other wall
    add_side_bay(barn, x, -1.0f, is_day ? 5.2f : 0.3f, draws);
    add_roof_bay(barn, x, 1.0f, is_day ? 3.0f : 0.1f, draws);
    add_roof_bay(barn, x, -1.0f, is_day ? 3.8f : 0.14f, draws);
  }
  for (const float side : {-1.0f, 1.0f}) {
    add_outline_of_box(barn, make_isometry({0.5f * kLength, side * kHalfWidth, 0.0f}), {0.5f * kLength, 0.1f, 1.0f});
  }
}

void add_gates(Cowshed& barn, BarnGate eastern) {
  add_gate(barn.still, 0.0f, 1.0f, BarnGate::closed);
  add_gate(barn.still, kLength, -1.0f, eastern);
}

void add_frame(Cowshed& barn, std::uint64_t seed) {
  SeededDraws draws(seed, 11);
  for (const float x : bay_lines()) add_truss(barn, x, draws);
  for (const float y : {-7.6f, -6.1f, -4.6f, -3.1f, -1.6f, 1.6f, 3.1f, 4.6f, 6.1f, 7.6f}) {
    const float z = roof_height(y) - 0.06f;
    for (float x = 0.0f; x < kLength - 0.1f; x += kCowshedSize.bay) {
      add_beam(barn.still, {x, y, z}, {x + kCowshedSize.bay, y, z}, 0.04f, 0.06f, varied(kTimber, draws));
    }
  }
}

}  // namespace byre
