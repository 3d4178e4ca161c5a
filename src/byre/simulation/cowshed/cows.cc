// Cows, each a few smooth bodies.

#include "byre/simulation/cowshed/cowshed_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kMetresPerStride = 1.5f;

// State of a walk: the cow turns within the last metre before either end.
struct WalkState {
  Eigen::Vector2f position;
  float heading = 0.0f;
  float distance = 0.0f;  // metres walked
};

WalkState walk_state(const Cow& cow, float time_s) {
  if (!cow.walks) return {cow.position, cow.heading, 0.0f};
  constexpr float kHalfLoop = 0.5f * std::numbers::pi_v<float> * 0.5f;  // metres: half a circle of radius 0.25
  const float half = cow.reach + kHalfLoop;
  const float distance = cow.speed * (time_s + cow.phase);
  const float along = std::fmod(distance, half);
  const bool is_returning = std::fmod(distance, 2.0f * half) >= half;
  WalkState state{{std::min(along, cow.reach), 0.0f}, 0.0f, distance};
  if (along > cow.reach) {
    const float turned = (along - cow.reach) / kHalfLoop * std::numbers::pi_v<float>;
    state.position += 0.25f * Eigen::Vector2f(std::sin(turned), 1.0f - std::cos(turned));
    state.heading = turned;
  }
  if (is_returning)
    state = {Eigen::Vector2f(cow.reach, 0.5f) - state.position, state.heading + std::numbers::pi_v<float>, distance};
  state.position += cow.position;
  return state;
}

void add_legs(QuadMesh& mesh, const Isometry3f& world_from_cow, float stride, const Material& hide) {
  for (int leg = 0; leg < 4; ++leg) {
    const bool is_front = leg < 2;
    const float y = leg % 2 == 0 ? -0.2f : 0.2f;
    // Diagonal legs move together.
    const float beat = stride + (leg == 0 || leg == 3 ? 0.0f : std::numbers::pi_v<float>);
    const Vector3f hip(is_front ? 0.52f : -0.6f, y, 0.85f);
    const Vector3f knee = hip + Vector3f(0.07f * std::sin(beat), 0.0f, -0.42f);
    const Vector3f hoof(hip.x() + 0.18f * std::sin(beat), y, std::max(0.08f * std::cos(beat), 0.0f));
    add_bar(mesh, world_from_cow * hip, world_from_cow * knee, 0.11f, hide);
    add_bar(mesh, world_from_cow * knee, world_from_cow * hoof, 0.06f, hide);
  }
}

void add_head(QuadMesh& mesh, const Isometry3f& world_from_cow, float nod, const Material& hide) {
  const Isometry3f neck =
      world_from_cow * make_isometry({0.75f, 0.0f, 1.25f}) * Eigen::AngleAxisf(nod - 0.5f, Vector3f::UnitY());
  add_ellipsoid(mesh, neck * make_isometry({0.25f, 0.0f, 0.0f}), {0.45f, 0.15f, 0.22f}, hide, 8);
  const Isometry3f head = neck * make_isometry({0.62f, 0.0f, 0.03f}) * Eigen::AngleAxisf(0.75f, Vector3f::UnitY());
  add_ellipsoid(mesh, head * make_isometry({0.14f, 0.0f, 0.0f}), {0.29f, 0.12f, 0.14f}, hide, 8);
  for (const float side : {-1.0f, 1.0f}) {
    add_ellipsoid(mesh, head * make_isometry({-0.06f, 0.17f * side, 0.09f}), {0.04f, 0.11f, 0.06f}, hide, 5);
  }
}

void add_cow(QuadMesh& mesh, const Cow& cow, float time_s, std::size_t number) {
  const WalkState state = walk_state(cow, time_s);
  const float stride = 2.0f * std::numbers::pi_v<float> * state.distance / kMetresPerStride;
  const float bob = cow.walks ? 0.02f * std::sin(2.0f * stride) : 0.0f;
  const float nod = cow.walks ? 0.12f * std::sin(stride) : 0.85f + 0.25f * std::sin(1.1f * (time_s + cow.phase));
  Isometry3f world_from_cow = make_isometry({state.position.x(), state.position.y(), 0.0f}, state.heading);
  world_from_cow.linear() *= cow.size;
  Material hide{.texture = BarnTexture::hide, .texture_width = 2.2f};
  hide.texture_offset = {0.13f * static_cast<float>(number), 0.29f * static_cast<float>(number)};
  const Isometry3f body = world_from_cow * make_isometry({0.0f, 0.0f, bob});
  add_ellipsoid(mesh, body * make_isometry({0.0f, 0.0f, 1.08f}), {0.88f, 0.35f, 0.43f}, hide, 12);
  add_ellipsoid(mesh, body * make_isometry({-0.55f, 0.0f, 1.18f}), {0.36f, 0.31f, 0.36f}, hide, 8);
  add_head(mesh, body, nod, hide);
  add_legs(mesh, world_from_cow, cow.walks ? stride : 0.0f, hide);
  add_bar(mesh, body * Vector3f(-0.88f, 0.0f, 1.3f), body * Vector3f(-0.95f, 0.06f * std::sin(time_s), 0.6f), 0.025f,
          hide, 5);
}

}  // namespace

std::vector<Cow> cows_of(const CowshedOptions& options, int count) {
  SeededDraws draws(hash(options.seed, static_cast<std::uint64_t>(options.mission), 2), 34);
  std::vector<Cow> cows;
  for (int i = 0; i < count; ++i) {
    const float side = i % 4 < 2 ? 1.0f : -1.0f;
    Cow cow;
    cow.walks = i % 2 == 0;
    cow.phase = draws.between(0.0f, 30.0f);
    cow.size = draws.between(0.88f, 1.05f);
    cow.speed = cow.walks ? draws.between(0.4f, 0.8f) : 0.0f;
    cow.reach = draws.between(8.0f, 20.0f);
    cow.heading = -0.5f * std::numbers::pi_v<float> * side;  // head through the fence
    const float x = draws.between(2.0f, 26.0f - (cow.walks ? cow.reach : 0.0f));
    cow.position = {x, side * (cow.walks ? 4.6f : 3.55f) - (cow.walks ? 0.25f : 0.0f)};
    cows.push_back(cow);
  }
  return cows;
}

QuadMesh cows_at(const std::vector<Cow>& cows, double time_s) {
  QuadMesh mesh;
  for (std::size_t i = 0; i < cows.size(); ++i) add_cow(mesh, cows[i], static_cast<float>(time_s), i);
  return mesh;
}

}  // namespace byre
