#pragma once

#include "byre/simulation/cowshed/cowshed.h"
#include "byre/simulation/seeded_draws.h"

// Building steps of a cowshed; each adds its part. Random draws depend on the seed only.
namespace byre {

// Height of the roof's underside, metres.
float roof_height(float y);

// x of columns and trusses, metres.
std::vector<float> bay_lines();

// The material with another texture offset and slightly different brightness.
Material varied(Material material, SeededDraws& draws);

void add_outline_of_box(Cowshed& barn, const Eigen::Isometry3f& world_from_box, const Eigen::Vector3f& half_size);

void add_shell(Cowshed& barn, const CowshedOptions& options);  // floor, walls, roof, windows
void add_gates(Cowshed& barn, BarnGate eastern);
void add_store(Cowshed& barn, BarnTime time, std::uint64_t seed);  // feed store behind the eastern gable
void add_frame(Cowshed& barn, std::uint64_t seed);                 // columns, trusses, purlins
void add_fences(Cowshed& barn, std::uint64_t seed);
void add_cubicles(Cowshed& barn, std::uint64_t seed);
void add_stall(Cowshed& barn, std::uint64_t seed);
void add_fittings(Cowshed& barn, std::uint64_t seed);  // signs, pipes, troughs, barrels
void add_tags(Cowshed& barn, const CowshedOptions& options);
// A tube lamp along x that hangs from the ceiling and is lit at dusk.
void add_lamp(Cowshed& barn, const Eigen::Vector3f& middle, float ceiling, BarnTime time);
void add_lamps(Cowshed& barn, BarnTime time);
void add_feed(Cowshed& barn, const CowshedOptions& options);  // piles along the fence, different in each mission

std::vector<MovableObject> make_objects(const CowshedOptions& options);
void add_object(QuadMesh& mesh, const MovableObject& object);

std::vector<Cow> cows_of(const CowshedOptions& options, int count);

}  // namespace byre
