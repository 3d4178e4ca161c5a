// Damaged map files: each is either read as a valid map or refused with an InputError. $BYRE_MUTANTS is the number of
// files, by default a few thousand.

#include "../allocations.h"
#include "mutate_map.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"
#include "byre/map/stored_map_scene.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;
using testing::StartsWith;

constexpr std::size_t kMegabyte = 1024 * 1024;
const std::filesystem::path kStoredFile = std::filesystem::path(BYRE_SOURCE_DIR) / "tests/robustness/format_7.byre";

std::size_t mutant_count() {
  const char* const wanted = std::getenv("BYRE_MUTANTS");
  return wanted ? std::strtoul(wanted, nullptr, 10) : 3000;
}

std::vector<MapBytes> originals() {
  return {write_map({}),
          write_map(StoredMapScene().stored()),
          write_map(StoredMapScene(2, 3, 2).stored()),
          write_map(StoredMapScene(9, 30, 3).stored()),
          write_map(StoredMapScene(2, 3, 4).stored_with_plan()),
          write_map(with_refined_calibration(StoredMapScene(2, 3, 5).stored())),
          read_file(kStoredFile)};
}

// Results of the mutants so far.
struct Tally {
  std::size_t read = 0;
  std::size_t read_with_right_checksums = 0;
  std::map<std::string, std::size_t> refusals;  // by section, of mutants with right checksums
  std::size_t most_allocated = 0;               // bytes beyond four times the file's size
  double slowest = 0.0;                         // seconds
};

std::string section_named_in(const InputError& error) {
  const std::string& place = error.place();
  const std::size_t begin = place.find("section ");
  if (begin == std::string::npos) return place.find("header") == std::string::npos ? "signature" : "header";
  return place.substr(begin + 8, place.find(" at byte") - begin - 8);
}

// The map; empty after counting the refusal.
std::optional<StoredMap> read_or_refuse(const Mutant& mutant, Tally& tally) {
  try {
    return read_map(mutant.bytes, "mutant.byre");
  } catch (const InputError& error) {
    EXPECT_THAT(error.place(), StartsWith("mutant.byre"));
    if (mutant.has_right_checksums) ++tally.refusals[section_named_in(error)];
    return std::nullopt;
  }
}

void expect_sound(const StoredMap& map, const Mutant& mutant) {
  EXPECT_THAT(find_faults(map), IsEmpty());
  EXPECT_EQ(write_map(map), mutant.bytes) << "a readable map is written again byte by byte";
}

void try_mutant(const Mutant& mutant, Tally& tally) {
  const std::size_t allocated_before = allocations_so_far().bytes;
  const auto start = std::chrono::steady_clock::now();
  const std::optional<StoredMap> map = read_or_refuse(mutant, tally);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const std::size_t allocated = allocations_so_far().bytes - allocated_before;

  tally.slowest = std::max(tally.slowest, seconds.count());
  const std::size_t justified = 4 * mutant.bytes.size();
  tally.most_allocated = std::max(tally.most_allocated, allocated - std::min(allocated, justified));
  EXPECT_LE(allocated, justified + 16 * kMegabyte);
  if (!map) return;
  ++tally.read;
  tally.read_with_right_checksums += mutant.has_right_checksums ? 1 : 0;
  expect_sound(*map, mutant);
}

void print(const Tally& tally, std::size_t count) {
  std::printf("%zu mutants, half of them with right checksums: %zu read as sound maps, %zu refused\n", count,
              tally.read, count - tally.read);
  for (const auto& [section, refusals] : tally.refusals) {
    std::printf("  %6zu with right checksums refused at %s\n", refusals, section.c_str());
  }
  std::printf("  at most %.3f MB allocated beyond 4 times the file, at most %.1f ms for a file\n",
              static_cast<double>(tally.most_allocated) / kMegabyte, 1e3 * tally.slowest);
}

TEST(DamagedMaps, AreReadAsValidMapsOrRejected) {
  MapMutator mutator(originals(), 1);
  Tally tally;
  const std::size_t count = mutant_count();
  for (std::size_t i = 0; i < count && !HasFailure(); ++i) {
    const Mutant mutant = mutator.next();
    SCOPED_TRACE("mutant " + std::to_string(i) + ": " + mutant.damage);
    try_mutant(mutant, tally);
  }
  print(tally, count);

  // Every section must have been refused, or the mutants do not reach its parser.
  for (const char* const section :
       {"summary", "notes", "provenance", "rigs", "keyframes", "features", "patches", "points", "observations", "words",
        "plan", "calibrations", "shutters", "descriptors", "observers", "lookup", "header"}) {
    EXPECT_GT(tally.refusals[section], 0u) << section << " was never rejected for more than its checksum";
  }
  EXPECT_GT(tally.read_with_right_checksums, count / 100);
}

// Do not regenerate the file: it guards the reader of its format against changes.
TEST(DamagedMaps, UndamagedFileIsReadAndWrittenUnchanged) {
  const StoredMap stored = load_map(kStoredFile);
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(stored.map.keyframe_count(), 5);
  EXPECT_EQ(stored.map.point_count(), 6);
  EXPECT_EQ(stored.plan.value().plan, "barn 3, ground floor");
  EXPECT_EQ(write_map(stored), read_file(kStoredFile));
  EXPECT_EQ(write_map(open_map(kStoredFile)), read_file(kStoredFile));
}

TEST(DamagedMaps, AllocationsAreCounted) {
  const std::size_t before = allocations_so_far().bytes;
  const std::vector<int> memory(1000);
  EXPECT_GE(allocations_so_far().bytes - before, memory.size() * sizeof(int));
}

}  // namespace
}  // namespace byre
