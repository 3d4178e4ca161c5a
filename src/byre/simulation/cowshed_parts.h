#pragma once

#include "byre/simulation/cowshed.h"
#include "byre/simulation/seeded_draws.h"

// The steps in which a cowshed is built; each adds its part. What they draw at random follows from the seed alone.
namespace byre {

// The height of the roof's underside, metres.
float roof_height(float y);

// x of the columns and trusses, metres.
std::vector<float> bay_lines();

// The look with another part of its picture, and a little darker or lighter.
SurfaceLook varied(SurfaceLook look, SeededDraws& draws);

void add_outline_of_box(Cowshed& barn, const Eigen::Isometry3f& world_from_box, const Eigen::Vector3f& half_size);

void add_shell(Cowshed& barn, BarnTime time, std::uint64_t seed);  // floor, walls, roof, windows
void add_gates(Cowshed& barn, BarnGate eastern);                   // gates in the gables
void add_store(Cowshed& barn, BarnTime time, std::uint64_t seed);  // store of feed behind the eastern gable
void add_frame(Cowshed& barn, std::uint64_t seed);                 // columns, trusses, purlins
void add_fences(Cowshed& barn, std::uint64_t seed);                // fences between the alley and the cows
void add_cubicles(Cowshed& barn, std::uint64_t seed);              // cubicles where the cows lie
void add_fittings(Cowshed& barn, std::uint64_t seed);              // signs, pipes, troughs, barrels
// A tube along x that hangs from a ceiling and shines at dusk.
void add_lamp(Cowshed& barn, const Eigen::Vector3f& middle, float ceiling, BarnTime time);
void add_lamps(Cowshed& barn, BarnTime time);
void add_feed(Cowshed& barn, const CowshedOptions& options);  // piles along the fence, others in each mission

// Where the movable things stand in a mission, and their shapes.
std::vector<MovableThing> things_of(const CowshedOptions& options);
void add_thing(QuadMesh& mesh, const MovableThing& thing);

std::vector<Cow> cows_of(const CowshedOptions& options, int count);

}  // namespace byre
