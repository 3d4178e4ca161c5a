#pragma once

#include "byre/simulation/cowshed/barn_light.h"
#include "byre/simulation/cowshed/scene_renderer.h"
#include "byre/tag.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace byre {

enum class BarnTime : std::uint8_t { day, dusk };
enum class BarnGate : std::uint8_t { closed, open };  // gate of the feed store, in the eastern gable

// A cowshed during one visit. World frame: x along the feed alley from the western gable, y north from the alley's
// centre line, z up from its floor; metres.
struct CowshedOptions {
  std::uint64_t seed = 1;          // draws the building
  int mission = 1;                 // from 1; draws the changes between visits
  double change = 0.25;            // share of movable objects that later missions find moved
  bool keeps_places = false;       // the share is moved at each mission, from where the last one left it, see barn_life
  bool painted = false;            // the eastern gable was painted
  bool has_stall = false;          // a stall was built behind the northern fence
  std::optional<BarnTime> time{};  // empty: day, in even missions dusk
  std::optional<int> cows{};       // empty: 3 in the first mission, 8 in later ones
  std::optional<BarnGate> gate{};  // empty: closed in the first mission, open in later ones
  double dust = 0.0;               // dust in the air: 0 none, 1 loses half of the light in 14 m
  int tags = 0;                    // AprilTags of 0.45 m on the columns
  int first_tag = 0;               // number of the first one
};

struct CowshedSize {
  float length = 30.0f;
  float half_width = 8.5f;
  float alley_half_width = 2.5f;  // from the centre line of the alley to the fence
  float eaves = 3.4f;
  float ridge = 6.2f;
  float bay = 5.0f;  // distance between columns
  float gate_half_width = 2.0f;
  float gate_height = 3.05f;
  float store_length = 10.0f;  // feed store behind the eastern gable
  float store_half_width = 4.5f;
  float store_height = 3.9f;
};
inline constexpr CowshedSize kCowshedSize;

struct PlanOutline {
  std::vector<Eigen::Vector2d> corners_in_world;
};

// A landmark that can be recognised in images and on the plan.
struct NamedPoint {
  std::string name;
  Eigen::Vector3d point_in_world;
};

enum class ObjectKind : std::uint8_t { bucket, wheelbarrow, pallet, broom, bale, crate };
inline constexpr int kObjectKinds = 6;

struct MovableObject {
  ObjectKind kind = ObjectKind::bucket;
  Eigen::Vector3f position;  // position of its foot in the world
  float yaw = 0.0f;          // radians
};

// Corners of the rectangle along the object's axes that contains it seen from above; counter-clockwise, in the world.
std::array<Eigen::Vector2f, 4> footprint_of(const MovableObject& object);

struct Cow {
  bool walks = false;  // true: walks up and down the alley; false: stands and eats
  Eigen::Vector2f position;
  float heading = 0.0f;  // radians, of a standing cow
  float reach = 0.0f;    // metres between the ends of a walk, which begins at position along x
  float speed = 0.0f;    // metres per second
  float phase = 0.0f;    // seconds added to the time of its walk
  float size = 1.0f;
};

// Shapes and lights of one visit.
struct Cowshed {
  QuadMesh still;
  BarnLight light;
  Air air;
  std::vector<PlanOutline> outlines;
  std::vector<NamedPoint> marks;
  std::vector<Tag> tags;  // with their poses in the world
  std::vector<MovableObject> objects;
  std::vector<Cow> cows;
};

// Resolves options that are empty by default.
BarnTime time_of(const CowshedOptions& options);
BarnGate gate_of(const CowshedOptions& options);

// Throws InputError for tags without libapriltag, and for options out of range: mission below 1, share outside 0 to 1,
// dust or number of cows negative or too large.
Cowshed build_cowshed(const CowshedOptions& options);

// The cows in the world at a time, seconds from the start of the recording.
QuadMesh cows_at(const std::vector<Cow>& cows, double time_s);

}  // namespace byre
