// Maps large enough to be read by several threads.

#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/stored_map_scene.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kManyKeyframes = 300;
constexpr int kFeaturesEach = 9;

// Error on reading; empty if there is none.
std::string fault_of(MapBytes bytes) {
  refresh_checksums(bytes);
  try {
    read_map(bytes, "file");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

MapBytes with_other_byte(MapBytes bytes, std::size_t place, std::mt19937_64& random) {
  bytes[place] ^= std::byte{static_cast<unsigned char>(1 + random() % 255)};
  return bytes;
}

TEST(LargeMapFile, IsUnchangedByASecondSave) {
  for (const std::uint64_t seed : {1, 2}) {
    const StoredMap stored = StoredMapScene(kManyKeyframes, kFeaturesEach, seed).stored();
    const MapBytes bytes = write_map(stored);
    const StoredMap read = read_map(bytes, "file");
    EXPECT_THAT(find_faults(read), IsEmpty());
    EXPECT_EQ(read.map.keyframe_count(), stored.map.keyframe_count());
    EXPECT_EQ(write_map(read), bytes);
  }
}

TEST(LargeMapFile, IsRejectedOrPreservedIfDamaged) {
  const MapBytes sound = write_map(StoredMapScene(kManyKeyframes, kFeaturesEach).stored());
  std::mt19937_64 random(1);
  int refused = 0;
  for (const char* const name : {"features", "patches", "points", "observations", "descriptors"}) {
    const TableEntry section = section_of(sound, name);
    for (int i = 0; i < 40; ++i) {
      MapBytes bytes = with_other_byte(sound, section.offset + random() % section.size, random);
      refresh_checksums(bytes);
      try {
        EXPECT_EQ(write_map(read_map(bytes, "file")), bytes);
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("section"));
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 20);
}

// Byte offset of the error in the file.
std::size_t place_in(const std::string& fault) {
  const std::size_t found = fault.find("at byte ");
  return found == std::string::npos ? 0 : std::stoul(fault.substr(found + 8));
}

// Faults that only a whole section shows are excluded; they are reported at its beginning.
TEST(LargeMapFile, ReportsTheFirstOfTwoFaults) {
  const MapBytes sound = write_map(StoredMapScene(kManyKeyframes, kFeaturesEach).stored());
  std::mt19937_64 random(2);
  for (const char* const name : {"features", "observations", "descriptors"}) {
    const TableEntry section = section_of(sound, name);
    int told = 0;
    for (int i = 0; i < 40; ++i) {
      const MapBytes once = with_other_byte(sound, section.offset + random() % (section.size / 2), random);
      const std::size_t later = section.offset + section.size - 1 - random() % (section.size / 20);
      const std::string fault = fault_of(once);
      if (fault.find(name) == std::string::npos || place_in(fault) == section.offset || place_in(fault) >= later) {
        continue;
      }
      EXPECT_EQ(fault_of(with_other_byte(once, later, random)), fault);
      ++told;
    }
    EXPECT_GT(told, 0) << name;
  }
}

}  // namespace
}  // namespace byre
