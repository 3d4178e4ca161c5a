#include "byre/playback/autosave.h"

#include <stdexcept>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

MapGraph map_of(int points) {
  MapGraph map(Origin::online);
  for (int i = 0; i < points; ++i) map.add_point({});
  return map;
}

StoredMap no_metadata() {
  return {};
}

TEST(Autosave, SavesTheMapAsOffered) {
  std::vector<int> saved;
  Autosave autosave(0.0, [&saved](const StoredMap& stored) { saved.push_back(stored.map.point_count()); });
  MapGraph map = map_of(1);
  autosave.update(map, no_metadata);
  map.add_point({});
  autosave.finish();
  autosave.update(map, no_metadata);
  autosave.finish();
  EXPECT_THAT(saved, ElementsAre(1, 2));
  EXPECT_EQ(autosave.saved(), 2);
}

TEST(Autosave, SavesTheMetadataOfItsFrame) {
  std::vector<std::string> saved;
  Autosave autosave(0.0, [&saved](const StoredMap& stored) { saved.push_back(stored.notes.at("site")); });
  StoredMap metadata;
  metadata.notes["site"] = "barn";
  autosave.update(map_of(1), [&metadata] { return metadata; });
  metadata.notes["site"] = "hall";
  autosave.finish();
  EXPECT_THAT(saved, ElementsAre("barn"));
}

TEST(Autosave, WaitsForItsInterval) {
  Autosave autosave(3600.0, [](const StoredMap&) { FAIL() << "an hour too early"; });
  autosave.update(map_of(1), no_metadata);
  autosave.finish();
  EXPECT_EQ(autosave.saved(), 0);
}

TEST(Autosave, SkipsMapsOfferedWhileSaving) {
  std::promise<void> disk;
  Autosave autosave(0.0, [done = disk.get_future().share()](const StoredMap&) { done.wait(); });
  for (int i = 0; i < 3; ++i) autosave.update(map_of(1), no_metadata);
  disk.set_value();
  autosave.finish();
  EXPECT_EQ(autosave.saved(), 1);
}

TEST(Autosave, ContinuesAfterAFailureAndReportsIt) {
  bool is_full = true;
  Autosave autosave(0.0, [&is_full](const StoredMap&) {
    if (is_full) throw std::runtime_error("the disk is full");
  });
  autosave.update(map_of(1), no_metadata);
  autosave.finish();
  EXPECT_THAT(autosave.failures(), ElementsAre("the disk is full"));
  is_full = false;
  autosave.update(map_of(1), no_metadata);
  autosave.finish();
  EXPECT_EQ(autosave.saved(), 1);
}

TEST(Autosave, WaitsForNothingBeforeTheFirstSave) {
  Autosave autosave(0.0, [](const StoredMap&) {});
  autosave.finish();
  EXPECT_THAT(autosave.failures(), IsEmpty());
}

}  // namespace
}  // namespace byre
