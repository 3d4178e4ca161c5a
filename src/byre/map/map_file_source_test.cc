// Maps that are read from their files on access.

#include "byre/base/binary_file.h"
#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/stored_map_scene.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kHundreds = 300;

// Counts the bytes read from a file.
struct WatchedFile {
  explicit WatchedFile(MapBytes of) : bytes(std::move(of)) {}

  StoredMap open() {
    return open_map(
        [this](std::size_t offset, std::span<std::byte> into) {
          read += into.size();
          std::ranges::copy(std::span(bytes).subspan(offset, into.size()), into.begin());
        },
        bytes.size(), "barn.byre");
  }

  MapBytes bytes;
  std::atomic<std::size_t> read = 0;
};

MapBytes scene_of_size(int keyframes, int features = 9) {
  return write_map(StoredMapScene(keyframes, features).stored_with_plan());
}

// Accesses all data. The sum is meaningless, but forces the access.
double look_at_all(const MapGraph& map) {
  double sum = 0.0;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    for (const Sighting& sighting : keyframe.sightings) {
      if (sighting.point) sum += map.find_point(*sighting.point)->position_in_world.x();
    }
    for (const Covisible& covisible : map.covisible_keyframes(id, 1000)) {
      sum += map.keyframe_header(covisible.keyframe)->camera_from_world.translation.x();
    }
  }
  for (const PointId id : map.point_ids()) {
    for (const Observation& seen : map.observations(id)) {
      const Keyframe& keyframe = *map.find_keyframe(seen.keyframe);
      sum += keyframe.sightings[static_cast<std::size_t>(seen.feature)].pixel.x();
      sum += keyframe.frame.features->keypoint(seen.feature).pixel.x();
    }
  }
  map.visit_words([&](KeyframeId, std::span<const Word> words) { sum += static_cast<double>(words.size()); });
  return sum;
}

// Error on opening or on access to all data; empty if there is none.
std::string fault_when_looked_at(MapBytes bytes) {
  try {
    WatchedFile file(std::move(bytes));
    const StoredMap opened = file.open();
    look_at_all(opened.map);
    return opened.map.damage() != nullptr ? opened.map.damage()->what() : "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(MapFileSource, EqualsReadingTheWholeMap) {
  for (const int keyframes : {1, 7, kHundreds}) {
    WatchedFile file(scene_of_size(keyframes));
    const StoredMap opened = file.open();
    EXPECT_THAT(find_faults(opened), IsEmpty());
    EXPECT_EQ(write_map(opened), file.bytes);
    EXPECT_EQ(look_at_all(opened.map), look_at_all(read_map(file.bytes, "").map));
  }
}

TEST(MapFileSource, ReturnsTheSameWords) {
  WatchedFile file(scene_of_size(7));
  const StoredMap opened = file.open();
  std::size_t visited = 0;
  opened.map.visit_words([&](KeyframeId id, std::span<const Word> words) {
    EXPECT_EQ(id.number, visited++);
    EXPECT_THAT(words, testing::ElementsAreArray(opened.map.find_keyframe(id)->words));
  });
  EXPECT_EQ(visited, opened.map.keyframe_ids().size());
}

TEST(MapFileSource, OpensAnEmptyMap) {
  WatchedFile file(write_map({}));
  EXPECT_THAT(find_faults(file.open()), IsEmpty());
}

TEST(MapFileSource, ReadsOnlyAccessedPartsAndOnlyOnce) {
  WatchedFile file(scene_of_size(kHundreds, 100));
  const StoredMap opened = file.open();
  EXPECT_LT(file.read, file.bytes.size() / 5);
  const KeyframeId looked_at{Origin::offline, 150};
  const std::size_t before = file.read;
  const Keyframe* const keyframe = opened.map.find_keyframe(looked_at);
  EXPECT_GT(file.read, before);
  EXPECT_LT(file.read - before, file.bytes.size() / 50);
  const std::size_t after = file.read;
  EXPECT_EQ(opened.map.find_keyframe(looked_at), keyframe);
  for (const Sighting& sighting : keyframe->sightings) {
    EXPECT_TRUE(!sighting.point || !opened.map.observations(*sighting.point).empty());
  }
  EXPECT_EQ(file.read, after);
}

TEST(MapFileSource, ReturnsKeyframePosesWithoutReadingThem) {
  WatchedFile file(scene_of_size(7));
  const StoredMap opened = file.open();
  const std::size_t before = file.read;
  for (const KeyframeId id : opened.map.keyframe_ids()) {
    const Keyframe& header = *opened.map.keyframe_header(id);
    EXPECT_THAT(header.sightings, IsEmpty());
    EXPECT_EQ(opened.map.camera_from_world(id).translation, header.camera_from_world.translation);
  }
  EXPECT_EQ(file.read, before);
  EXPECT_EQ(opened.map.keyframe_header({Origin::offline, 99}), nullptr);
  EXPECT_EQ(opened.map.find_keyframe({Origin::online, 0}), nullptr);
  EXPECT_EQ(opened.map.find_point({Origin::offline, 1u << 20}), nullptr);
  EXPECT_EQ(opened.map.find_point({Origin::online, 0}), nullptr);
}

TEST(MapFileSource, IsReadCompletelyByTheFirstChange) {
  WatchedFile file(scene_of_size(7));
  const auto change = [](StoredMap& stored) {
    stored.map.remove_point({Origin::offline, 3});
    stored.map.move_keyframe({Origin::offline, 2}, {}, Matrix6::Identity());
    stored.map.remove_observation(stored.map.observations({Origin::offline, 5}).front());
    stored.map.remove_keyframe({Origin::offline, 1});
    stored.map = offline_copy(stored.map);
  };
  const StoredMap opened = file.open();
  StoredMap changed = opened, expected = read_map(file.bytes, "");
  change(changed);
  change(expected);
  EXPECT_THAT(find_faults(changed.map), IsEmpty());
  EXPECT_EQ(write_map(changed), write_map(expected));
  EXPECT_EQ(write_map(opened), file.bytes) << "the original";
}

TEST(MapFileSource, DetectsEveryFlippedBitOnAccess) {
  MapBytes bytes = scene_of_size(5);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte bit{static_cast<unsigned char>(1u << (i % 8))};
    bytes[i] ^= bit;
    EXPECT_THAT(fault_when_looked_at(bytes), StartsWith("barn.byre")) << "byte " << i;
    bytes[i] ^= bit;
  }
}

TEST(MapFileSource, ReportsThePositionOfADamagedPart) {
  MapBytes bytes = scene_of_size(5);
  const TableEntry section = section_of(bytes, "patches");
  bytes[section.offset + section.size - 1] ^= std::byte{1};
  WatchedFile file(bytes);
  const StoredMap opened = file.open();
  EXPECT_TRUE(opened.map.find_keyframe({Origin::offline, 0}));
  EXPECT_THAT(fault_when_looked_at(bytes),
              AllOf(StartsWith("barn.byre: section features at byte "), HasSubstr("wrong checksum")));
}

TEST(MapFileSource, ReplacesADamagedKeyframeByAnEmptyOne) {
  MapBytes bytes = scene_of_size(5);
  const StoredMap sound = read_map(bytes, "");
  const TableEntry section = section_of(bytes, "patches");
  bytes[section.offset + section.size - 1] ^= std::byte{1};
  WatchedFile file(bytes);
  const StoredMap opened = file.open();
  const auto sees_points = [](const Keyframe& keyframe) {
    return std::ranges::any_of(keyframe.sightings, [](const Sighting& sighting) { return sighting.point.has_value(); });
  };
  EXPECT_EQ(opened.map.damage(), nullptr) << "not accessed yet";
  for (const KeyframeId id : opened.map.keyframe_ids()) {
    const bool was_met = opened.map.damage() != nullptr;
    const Keyframe& keyframe = *opened.map.find_keyframe(id);
    const bool is_damaged = !was_met && opened.map.damage() != nullptr;
    EXPECT_EQ(sees_points(keyframe), sees_points(*sound.map.find_keyframe(id)) && !is_damaged) << id.number;
    EXPECT_EQ(keyframe.frame.features->size(), static_cast<int>(keyframe.sightings.size()));
  }
  ASSERT_NE(opened.map.damage(), nullptr);
  MapGraph changed = opened.map;
  EXPECT_THROW(changed.remove_keyframe(opened.map.keyframe_ids().back()), InputError) << "a change reads all of it";
}

TEST(MapFileSource, RejectsEveryTruncatedFile) {
  const MapBytes bytes = scene_of_size(3);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(size);
    EXPECT_NE(fault_when_looked_at(MapBytes(bytes.begin(), end)), "") << size << " bytes";
  }
}

// Arbitrary values with correct checksums cause either no error or one that names the location.
TEST(MapFileSource, SurvivesInvalidValues) {
  const MapBytes sound = scene_of_size(12);
  std::mt19937_64 random(1);
  int refused = 0;
  for (std::size_t i = 0; i < kSections; ++i) {
    const TableEntry section = table_entry(sound, i);
    for (int round = 0; section.size > 0 && round < 100; ++round) {
      MapBytes bytes = sound;
      bytes[section.offset + random() % section.size] ^= std::byte{static_cast<unsigned char>(1 + random() % 255)};
      refresh_checksums(bytes);
      const std::string fault = fault_when_looked_at(bytes);
      if (fault.empty()) continue;
      EXPECT_THAT(fault, HasSubstr("section"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 200);
}

// Bytes of section observers: number of observations of the first point, then keyframe and feature of each.
TEST(MapFileSource, RejectsInvalidObservers) {
  const auto fault_with = [](std::size_t place, int value) {
    MapBytes bytes = scene_of_size(5);
    bytes[section_of(bytes, "observers").offset + place] = static_cast<std::byte>(value);
    refresh_checksums(bytes);
    return fault_when_looked_at(bytes);
  };
  EXPECT_THAT(fault_with(0, 0), HasSubstr("section observers"));
  EXPECT_THAT(fault_with(0, 127), HasSubstr("section observers"));
  EXPECT_THAT(fault_with(1, 100), HasSubstr("refers to a keyframe beyond the last of 6"));
  EXPECT_THAT(fault_with(2, 100), HasSubstr("refers to a feature that its keyframe does not have"));
  EXPECT_THAT(fault_with(2, 5), HasSubstr("point 0 does not list a keyframe that observes it"));
}

TEST(MapFileSource, ReturnsTheSameToAllThreads) {
  WatchedFile file(scene_of_size(kHundreds));
  const StoredMap opened = file.open();
  constexpr std::size_t kThreads = 4;
  std::vector<std::vector<const void*>> seen(kThreads);
  std::vector<double> sums(kThreads);
  {
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        for (const KeyframeId id : opened.map.keyframe_ids()) seen[thread].push_back(opened.map.find_keyframe(id));
        for (const PointId id : opened.map.point_ids()) seen[thread].push_back(opened.map.find_point(id));
        sums[thread] = look_at_all(opened.map);
      });
    }
  }
  EXPECT_THAT(seen, Each(testing::Eq(seen.front())));
  EXPECT_THAT(sums, Each(look_at_all(read_map(file.bytes, "").map)));
}

TEST(MapFileSource, RejectsADamagedSmallFileOnOpening) {
  const fs::path path = fs::path(testing::TempDir()) / ("damaged_source_" + std::to_string(getpid()) + ".byre");
  MapBytes bytes = scene_of_size(7);
  const std::vector<SectionSize> sizes = section_sizes(bytes, "");
  std::size_t begin = 0;
  for (const SectionSize& section : sizes) {
    if (section.name == "descriptors") break;
    begin += section.bytes;
  }
  bytes[begin + 5] ^= std::byte{1};
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  try {
    open_map(path);
    ADD_FAILURE() << "opened";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("section descriptors"));
    EXPECT_THAT(error.what(), testing::HasSubstr("wrong checksum"));
  }
  fs::remove(path);
}

TEST(MapFileSource, OutlivesItsNameAndReportsTruncation) {
  const fs::path path = fs::path(testing::TempDir()) / ("map_source_" + std::to_string(getpid()) + ".byre");
  const MapBytes bytes = scene_of_size(7);
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  const StoredMap opened = open_map(path), untouched = open_map(path);
  fs::remove(path);
  EXPECT_EQ(write_map(opened), bytes);

  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  const StoredMap cut = open_map(path);
  fs::resize_file(path, bytes.size() / 3);
  EXPECT_THROW(look_at_all(cut.map), InputError) << "of words";
  ASSERT_NE(cut.map.damage(), nullptr);
  EXPECT_THAT(cut.map.damage()->what(), HasSubstr("was truncated after it was opened"));
  EXPECT_THROW(write_map(cut), InputError) << "a damaged map is not saved as a valid one";
  EXPECT_EQ(untouched.map.damage(), nullptr);
  EXPECT_EQ(write_map(untouched), bytes) << "another file of the same name";
  fs::remove(path);
}

}  // namespace
}  // namespace byre
