#include "mutate_map.h"

#include <array>
#include <limits>
#include <utility>

namespace byre {
namespace {

// Integers at typical parser limits, truncated to the written width.
constexpr std::array<std::uint64_t, 12> kIntegers = {0,          1,          2,          0x7f,       0xff,       0xffff,
                                                     0x7fffffff, 0x80000000, 0xfffffff0, 0xffffffff, 1ull << 40, ~0ull};
constexpr std::array<double, 10> kReals = {0.0,
                                           -0.0,
                                           -1.0,
                                           1e-30,
                                           1e30,
                                           3e9,
                                           std::numeric_limits<double>::quiet_NaN(),
                                           std::numeric_limits<double>::infinity(),
                                           -std::numeric_limits<double>::infinity(),
                                           std::numeric_limits<double>::denorm_min()};

template <typename T>
void put_if_inside(MapBytes& bytes, std::size_t place, T value) {
  if (place + sizeof(T) <= bytes.size()) put_at(bytes, place, value);
}

auto at(MapBytes& bytes, std::size_t place) {
  return bytes.begin() + static_cast<std::ptrdiff_t>(place);
}

MapBytes piece_of(const MapBytes& bytes, std::size_t place, std::size_t size) {
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(place);
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

}  // namespace

Mutant MapMutator::next() {
  Mutant mutant{originals_[below(originals_.size())], "", count_++ % 2 == 1};
  mutant.damage = damage(mutant.bytes);
  if (mutant.has_right_checksums) refresh_checksums(mutant.bytes);
  return mutant;
}

std::string MapMutator::damage(MapBytes& bytes) {
  struct Damage {
    const char* name;
    void (MapMutator::*do_it)(MapBytes& bytes);
  };
  // Numbers occur twice: parsers depend on them most.
  static constexpr std::array<Damage, 12> kDamages = {Damage{"flipped bits", &MapMutator::flip_bits},
                                                      {"other number", &MapMutator::write_number},
                                                      {"other number", &MapMutator::write_number},
                                                      {"other header", &MapMutator::change_header},
                                                      {"end cut off", &MapMutator::cut_end},
                                                      {"bytes appended", &MapMutator::append},
                                                      {"sections swapped", &MapMutator::swap_sections},
                                                      {"table entries swapped", &MapMutator::swap_table_entries},
                                                      {"section cut", &MapMutator::cut_from_section},
                                                      {"section grown", &MapMutator::grow_section},
                                                      {"piece copied", &MapMutator::copy_piece},
                                                      {"piece zeroed", &MapMutator::zero_piece}};
  const auto& [name, do_it] = kDamages[below(kDamages.size())];
  (this->*do_it)(bytes);
  return name;
}

// Chooses each section with equal probability, regardless of its size. The first is never empty.
std::size_t MapMutator::any_filled_section(const MapBytes& bytes) {
  std::size_t index = below(kSections);
  while (table_entry(bytes, index).size == 0) index = below(kSections);
  return index;
}

std::size_t MapMutator::place_in_any_section(const MapBytes& bytes) {
  const TableEntry section = table_entry(bytes, any_filled_section(bytes));
  // Prefers counts and first entries.
  const std::size_t size = below(2) == 0 ? std::min<std::size_t>(section.size, 64) : section.size;
  return section.offset + below(size);
}

void MapMutator::flip_bits(MapBytes& bytes) {
  std::vector<std::size_t> places(1 + below(4));  // all chosen before the section table may change
  for (std::size_t& place : places) place = below(4) == 0 ? below(bytes.size()) : place_in_any_section(bytes);
  for (const std::size_t place : places) bytes[place] ^= std::byte{1} << below(8);
}

void MapMutator::write_number(MapBytes& bytes) {
  const std::size_t place = place_in_any_section(bytes);
  const std::uint64_t integer = kIntegers[below(kIntegers.size())] + below(3) - 1;
  const double real = kReals[below(kReals.size())];
  switch (below(5)) {
    case 0:
      return put_if_inside(bytes, place, static_cast<std::uint8_t>(integer));
    case 1:
      return put_if_inside(bytes, place, static_cast<std::uint32_t>(integer));
    case 2:
      return put_if_inside(bytes, place, integer);
    case 3:
      return put_if_inside(bytes, place, static_cast<float>(real));
    default:
      return put_if_inside(bytes, place, real);
  }
}

void MapMutator::change_header(MapBytes& bytes) {
  const std::size_t place = below(kHeaderSize - sizeof(std::uint64_t));
  put_at(bytes, place, kIntegers[below(kIntegers.size())]);
}

void MapMutator::cut_end(MapBytes& bytes) {
  bytes.resize(below(bytes.size()));
  if (bytes.size() >= kHeaderSize && below(2) == 0) put_at(bytes, kFileSizeAt, std::uint64_t{bytes.size()});
}

void MapMutator::append(MapBytes& bytes) {
  bytes.resize(bytes.size() + 1 + below(100), std::byte{static_cast<unsigned char>(below(256))});
  if (below(2) == 0) put_at(bytes, kFileSizeAt, std::uint64_t{bytes.size()});
}

void MapMutator::swap_sections(MapBytes& bytes) {
  const std::size_t first = below(kSections);
  const std::size_t second = below(kSections);
  const auto content = [&bytes](std::size_t index) {
    const TableEntry entry = table_entry(bytes, index);
    return piece_of(bytes, entry.offset, entry.size);
  };
  const MapBytes content_of_first = content(first);
  const MapBytes content_of_second = content(second);
  replace_in_section(bytes, first, 0, content_of_first.size(), content_of_second);
  replace_in_section(bytes, second, 0, table_entry(bytes, second).size, content_of_first);
}

void MapMutator::swap_table_entries(MapBytes& bytes) {
  const std::size_t first = table_entry(bytes, below(kSections)).at;
  const std::size_t second = table_entry(bytes, below(kSections)).at;
  const std::size_t skipped = below(2) == 0 ? 0 : 16;  // section names
  if (first == second) return;
  std::swap_ranges(at(bytes, first + skipped), at(bytes, first + kTableEntrySize), at(bytes, second + skipped));
}

void MapMutator::cut_from_section(MapBytes& bytes) {
  const std::size_t index = any_filled_section(bytes);
  const std::size_t size = table_entry(bytes, index).size;
  const std::size_t begin = below(size);
  replace_in_section(bytes, index, begin, 1 + below(size - begin), {});
}

void MapMutator::grow_section(MapBytes& bytes) {
  const std::size_t index = any_filled_section(bytes);
  const TableEntry section = table_entry(bytes, index);
  const std::size_t begin = below(section.size);
  const std::size_t size = 1 + below(section.size - begin);
  const std::size_t repeats = 1 + below(8);
  MapBytes repeated;
  for (std::size_t i = 0; i < repeats; ++i) {
    const MapBytes piece = piece_of(bytes, section.offset + begin, size);
    repeated.insert(repeated.end(), piece.begin(), piece.end());
  }
  replace_in_section(bytes, index, begin, 0, repeated);
}

void MapMutator::copy_piece(MapBytes& bytes) {
  const std::size_t from = place_in_any_section(bytes);
  const std::size_t to = place_in_any_section(bytes);
  const std::size_t size = 1 + below(std::min<std::size_t>(300, bytes.size() - std::max(from, to)));
  std::ranges::copy(piece_of(bytes, from, size), at(bytes, to));
}

void MapMutator::zero_piece(MapBytes& bytes) {
  const std::size_t from = place_in_any_section(bytes);
  const std::size_t size = 1 + below(std::min<std::size_t>(300, bytes.size() - from));
  std::fill_n(at(bytes, from), size, std::byte{});
}

}  // namespace byre
