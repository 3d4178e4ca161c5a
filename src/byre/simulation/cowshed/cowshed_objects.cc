// Movable objects in a cowshed: buckets, wheelbarrows, pallets, brooms, bales, crates.

#include "byre/simulation/cowshed/cowshed_parts.h"

#include <numeric>

namespace byre {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr int kObjects = 32;

Material make_material(BarnTexture texture, float texture_width, std::uint64_t variant) {
  SeededDraws draws(variant, 31);
  return {.texture = texture,
          .brightness = draws.between(0.5f, 1.1f),
          .texture_width = texture_width,
          .texture_offset = {draws.between(0.0f, 1.0f), draws.between(0.0f, 1.0f)}};
}

void add_bucket(QuadMesh& mesh, const Isometry3f& world_from_object, const Material& material) {
  add_drum(mesh, world_from_object.translation(), world_from_object * Vector3f(0.0f, 0.0f, 0.32f), 0.12f, 0.17f,
           material);
}

void add_wheelbarrow(QuadMesh& mesh, const Isometry3f& world_from_object, const Material& material) {
  const Material steel = make_material(BarnTexture::rust, 0.7f, 7);
  const Isometry3f tray = world_from_object * make_isometry({0.1f, 0.0f, 0.48f});
  add_box(mesh, tray * Eigen::AngleAxisf(0.12f, Vector3f::UnitY()), {0.42f, 0.3f, 0.14f}, material);
  add_drum(mesh, world_from_object * Vector3f(0.62f, -0.05f, 0.19f), world_from_object * Vector3f(0.62f, 0.05f, 0.19f),
           0.19f, 0.19f, make_material(BarnTexture::plastic, 0.5f, 9));
  for (const float y : {-0.25f, 0.25f}) {
    const Vector3f handle = world_from_object * Vector3f(-0.8f, y, 0.62f);
    add_bar(mesh, world_from_object * Vector3f(0.62f, 0.2f * y, 0.19f), handle, 0.02f, steel);
    add_bar(mesh, world_from_object * Vector3f(-0.3f, y, 0.0f), world_from_object * Vector3f(-0.2f, y, 0.48f), 0.02f,
            steel);
  }
}

void add_pallet(QuadMesh& mesh, const Isometry3f& world_from_object, const Material& material) {
  for (int i = 0; i < 6; ++i) {
    const float x = -0.5f + 0.2f * static_cast<float>(i);
    add_box(mesh, world_from_object * make_isometry({x, 0.0f, 0.13f}), {0.07f, 0.4f, 0.012f}, material);
  }
  for (const float y : {-0.35f, 0.0f, 0.35f}) {
    add_box(mesh, world_from_object * make_isometry({0.0f, y, 0.06f}), {0.58f, 0.05f, 0.055f}, material);
  }
}

// A broom that leans back.
void add_broom(QuadMesh& mesh, const Isometry3f& world_from_object, const Material& material) {
  add_bar(mesh, world_from_object * Vector3f(0.0f, 0.0f, 0.1f), world_from_object * Vector3f(-0.4f, 0.05f, 1.4f),
          0.016f, material);
  add_box(mesh, world_from_object * make_isometry({0.0f, 0.0f, 0.06f}), {0.05f, 0.22f, 0.06f},
          make_material(BarnTexture::straw, 0.8f, 3));
}

void add_crate(QuadMesh& mesh, const Isometry3f& world_from_object, const Material& material) {
  add_box(mesh, world_from_object * make_isometry({0.0f, 0.0f, 0.22f}), {0.3f, 0.22f, 0.22f}, material);
  for (const float z : {0.08f, 0.36f}) {
    add_box(mesh, world_from_object * make_isometry({0.0f, 0.0f, z}), {0.315f, 0.235f, 0.03f}, material);
  }
}

// A position along the fences or in front of the western gate, off the robot's course.
MovableObject draw_object(ObjectKind kind, SeededDraws& draws) {
  const float side = draws.below(2) == 0 ? -1.0f : 1.0f;
  const float yaw = draws.between(-0.6f, 0.6f) + (draws.below(2) == 0 ? 0.0f : 1.5708f);
  switch (draws.below(5)) {
    case 0:  // in front of the western gate
      return {kind, {draws.between(1.0f, 1.6f), side * draws.between(0.2f, 1.4f), 0.0f}, yaw};
    case 1:  // between fence and cubicles
      return {kind, {draws.between(2.0f, 28.0f), side * draws.between(4.7f, 5.1f), 0.0f}, yaw};
    default:  // along the fence
      return {kind, {draws.between(2.0f, 28.0f), side * draws.between(1.98f, 2.12f), 0.0f}, yaw};
  }
}

// Indices of the objects in an order drawn for a mission; the first ones are moved.
std::vector<std::size_t> shuffled(std::size_t count, SeededDraws& draws) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<std::size_t>(draws.below(static_cast<int>(i)))]);
  }
  return order;
}

// The share of tools that a mission moves; other things are moved three times less often.
double share_moved(ObjectKind kind, double change) {
  const bool is_tool = kind == ObjectKind::bucket || kind == ObjectKind::wheelbarrow || kind == ObjectKind::broom;
  return is_tool ? change : change / 3.0;
}

// Moves each object as the last mission that moved it did.
void move_as_last_left(const CowshedOptions& options, std::vector<MovableObject>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (int mission = options.mission; mission > 1; --mission) {
      SeededDraws draws(hash(options.seed, static_cast<std::uint64_t>(mission), i + 2), 34);
      if (draws.between(0.0f, 1.0f) >= share_moved(objects[i].kind, options.change)) continue;
      objects[i] = draw_object(objects[i].kind, draws);
      break;
    }
  }
}

}  // namespace

std::vector<MovableObject> make_objects(const CowshedOptions& options) {
  SeededDraws first(options.seed, 32);
  std::vector<MovableObject> objects;
  for (int i = 0; i < kObjects; ++i) objects.push_back(draw_object(static_cast<ObjectKind>(i % kObjectKinds), first));
  if (options.mission == 1) return objects;
  if (options.keeps_places) {
    move_as_last_left(options, objects);
    return objects;
  }
  SeededDraws later(hash(options.seed, static_cast<std::uint64_t>(options.mission), 1), 33);
  const auto moved = static_cast<std::size_t>(std::lround(options.change * kObjects));
  const std::vector<std::size_t> order = shuffled(objects.size(), later);
  for (std::size_t i = 0; i < moved; ++i) objects[order[i]] = draw_object(objects[order[i]].kind, later);
  return objects;
}

std::array<Eigen::Vector2f, 4> footprint_of(const MovableObject& object) {
  QuadMesh mesh;
  add_object(mesh, {object.kind, Vector3f::Zero(), 0.0f});
  Eigen::AlignedBox2f box;
  for (const Vector3f& vertex : mesh.vertices) box.extend(vertex.head<2>());
  const Eigen::Rotation2Df turned(object.yaw);
  std::array<Eigen::Vector2f, 4> corners = {
      box.min(), {box.max().x(), box.min().y()}, box.max(), {box.min().x(), box.max().y()}};
  for (Eigen::Vector2f& corner : corners) corner = object.position.head<2>() + turned * corner;
  return corners;
}

void add_object(QuadMesh& mesh, const MovableObject& object) {
  const Isometry3f world_from_object = make_isometry(object.position, object.yaw);
  const auto variant = static_cast<std::uint64_t>(std::lround(1000.0f * std::abs(object.yaw)));
  switch (object.kind) {
    case ObjectKind::bucket:
      return add_bucket(mesh, world_from_object, make_material(BarnTexture::plastic, 0.6f, variant));
    case ObjectKind::wheelbarrow:
      return add_wheelbarrow(mesh, world_from_object, make_material(BarnTexture::rust, 0.9f, variant));
    case ObjectKind::pallet:
      return add_pallet(mesh, world_from_object, make_material(BarnTexture::timber, 0.9f, variant));
    case ObjectKind::broom:
      return add_broom(mesh, world_from_object, make_material(BarnTexture::timber, 0.6f, variant));
    case ObjectKind::bale:
      return add_box(mesh, world_from_object * make_isometry({0.0f, 0.0f, 0.21f}), {0.42f, 0.23f, 0.21f},
                     make_material(BarnTexture::straw, 0.9f, variant));
    case ObjectKind::crate:
      return add_crate(mesh, world_from_object, make_material(BarnTexture::planks, 1.4f, variant));
  }
}

}  // namespace byre
