#pragma once

#include "byre/map/map_bytes_scene.h"

#include <random>
#include <string>
#include <vector>

namespace byre {

struct Mutant {
  MapBytes bytes;
  std::string damage;
  bool has_right_checksums = false;
};

// Damages map files in random ways: flipped bits, other numbers (huge counts, NaN, indices out of range), truncated and
// appended bytes, sections swapped, truncated and extended, and pieces copied. Every second mutant gets right
// checksums, so that the damage reaches the parser. Deterministic in the seed.
class MapMutator {
 public:
  // Precondition: at least one original, all valid map files.
  MapMutator(std::vector<MapBytes> originals, std::uint64_t seed) : originals_(std::move(originals)), random_(seed) {}

  Mutant next();

 private:
  std::size_t below(std::size_t limit) { return static_cast<std::size_t>(random_() % limit); }

  std::string damage(MapBytes& bytes);
  std::size_t any_filled_section(const MapBytes& bytes);
  std::size_t place_in_any_section(const MapBytes& bytes);
  void flip_bits(MapBytes& bytes);
  void write_number(MapBytes& bytes);
  void change_header(MapBytes& bytes);
  void cut_end(MapBytes& bytes);
  void append(MapBytes& bytes);
  void swap_sections(MapBytes& bytes);
  void swap_table_entries(MapBytes& bytes);
  void cut_from_section(MapBytes& bytes);
  void grow_section(MapBytes& bytes);
  void copy_piece(MapBytes& bytes);
  void zero_piece(MapBytes& bytes);

  std::vector<MapBytes> originals_;
  std::mt19937_64 random_;
  std::size_t count_ = 0;
};

}  // namespace byre
