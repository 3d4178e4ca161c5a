// "byre inspect" and "byre validate".

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class InspectProgram : public ProgramTest {
 protected:
  InspectProgram() {
    const StoredMap stored = StoredMapScene(4, 9).stored();
    save_map(stored, folder_ / "barn.byre");
    MapBytes bytes = write_map(stored);
    bytes[section_of(bytes, "points").offset + 9] ^= std::byte{1};
    write("damaged.byre", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    write("text.byre", "not a map");
  }
};

TEST_F(InspectProgram, PrintsAReport) {
  const Outcome outcome = run("inspect barn.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("map            barn.byre\n"));
  EXPECT_THAT(outcome.output, HasSubstr("points         16, with 32 observations\n"));
  EXPECT_THAT(outcome.errors, IsEmpty());
}

TEST_F(InspectProgram, PrintsJsonAndWritesThePoints) {
  const Outcome outcome = run("inspect barn.byre --json --points points.ply");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("{\n  \"file\": {"));
  EXPECT_THAT(read("points.ply"), HasSubstr("element vertex 16\n"));
}

TEST_F(InspectProgram, RejectsOtherFiles) {
  for (const char* const command : {"inspect", "validate"}) {
    const Outcome damaged = run(std::string(command) + " damaged.byre");
    EXPECT_EQ(damaged.exit_code, 3);
    EXPECT_THAT(damaged.errors, StartsWith("byre: error: damaged.byre: section points at byte "));
    EXPECT_THAT(damaged.output, IsEmpty());
    EXPECT_EQ(run(std::string(command) + " text.byre").exit_code, 3);
    EXPECT_EQ(run(std::string(command) + " absent.byre").exit_code, 3);
    EXPECT_EQ(run(command).exit_code, 2);
  }
}

TEST_F(InspectProgram, ValidatesASoundMap) {
  const Outcome outcome = run("validate barn.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.output, "barn.byre: sound, 5 keyframes, 16 points\n");
}

}  // namespace
}  // namespace byre::cli
