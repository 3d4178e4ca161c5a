#include "byre/map/map_file.h"

#include "byre/input/binary_file.h"
#include "byre/input/input_error.h"
#include "byre/map/stored_map_scene.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

TEST(MapFile, IsTheSameAfterASecondSave) {
  const std::vector<std::byte> bytes = write_map(StoredMapScene().stored());
  EXPECT_EQ(write_map(read_map(bytes, "file")), bytes);
}

TEST(MapFile, KeepsAnEmptyMap) {
  const StoredMap read = read_map(write_map({}), "file");
  EXPECT_EQ(read.map.keyframe_count(), 0);
  EXPECT_EQ(read.map.point_count(), 0);
  EXPECT_THAT(find_faults(read), IsEmpty());
}

TEST(MapFile, Sound) {
  const StoredMapScene scene;
  EXPECT_THAT(find_faults(scene.stored()), IsEmpty());
  EXPECT_THAT(find_faults(read_map(write_map(scene.stored()), "file")), IsEmpty());
}

}  // namespace
}  // namespace byre
