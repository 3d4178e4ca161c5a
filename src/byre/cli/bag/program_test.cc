// "byre bag", and bags as recordings of other commands.

#include "byre/cli/shared/program_fixture.h"
#include "byre/io/bag/bag_scene.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

class BagProgram : public ProgramTest {
 protected:
  void write_scene(const std::string& name, std::size_t left_out = 0) const {
    BagBytes bytes = mcap_bytes(scene_messages(), "-");
    bytes.resize(bytes.size() - left_out);
    write(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
};

TEST_F(BagProgram, PrintsTheContentsOfABag) {
  write_scene("walk.mcap");
  const Outcome outcome = run("bag info walk.mcap");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("storage      mcap, "));
  EXPECT_THAT(outcome.output, HasSubstr("messages     18\n"));
  EXPECT_THAT(outcome.output, HasSubstr("topic        /left/image_raw   sensor_msgs/msg/Image  6, 20.0 Hz\n"));
  EXPECT_THAT(outcome.output, HasSubstr("images       left /left/image_raw, right /right/image_raw\n"));
}

TEST_F(BagProgram, PrintsTheContentsAsJson) {
  write_scene("walk.mcap");
  const json report = json::parse(run("bag info walk.mcap --json").output);
  EXPECT_EQ(report.at("program"), "byre bag info");
  EXPECT_EQ(report.at("topics").size(), 3u);
  EXPECT_EQ(report.at("topics")[0].at("messages"), 6);
  EXPECT_EQ(report.at("images").at("left"), "/left/image_raw");
  EXPECT_EQ(report.at("first_ns"), 1'003'000'000);
  EXPECT_THAT(report.at("damage"), IsEmpty());
}

TEST_F(BagProgram, ReportsDamageWithExitCodeOne) {
  write_scene("cut.mcap", 200);
  const Outcome outcome = run("bag info cut.mcap");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("DAMAGE       cut.mcap: is truncated or damaged from byte"));
  EXPECT_EQ(run("bag info absent.mcap").exit_code, 3);
  EXPECT_EQ(run("bag").exit_code, 2);
}

TEST_F(BagProgram, ListsTopicsForAnUnknownName) {
  write_scene("walk.mcap");
  const Outcome outcome = run("check walk.mcap --left /front");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("has no images on topic /front; available image topics: /left/image_raw (6)"));
}

TEST_F(BagProgram, MapsTheRecordOfAMappingRun) {
  const Outcome mapped = run("map " + rendered_room() +
                             " --frames :6 --no-loops --pace inline --quiet --trajectory walk.txt "
                             "--record walk.mcap --record-images");
  ASSERT_EQ(mapped.exit_code, 0) << mapped.errors;
  EXPECT_EQ(run("bag info walk.mcap").exit_code, 0);
  const Outcome again = run("map walk.mcap --no-loops --pace inline --quiet --trajectory again.txt");
  EXPECT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_EQ(std::ranges::count(read("again.txt"), '\n'), std::ranges::count(read("walk.txt"), '\n'));
}

TEST_F(BagProgram, DoesNotOverwriteInputsOrOtherFileTypes) {
  write_scene("walk.mcap");
  EXPECT_THAT(run("map walk.mcap -o walk.byre --record walk.mcap").errors, HasSubstr("is also an input (RECORDING)"));
  write("notes.txt", "bring hay\n");
  EXPECT_THAT(run("map walk.mcap -o walk.byre --record notes.txt").errors,
              HasSubstr("is not the expected kind of file (MCAP file)"));
  EXPECT_EQ(run("map walk.mcap -o walk.byre --record-images").exit_code, 2);
}

}  // namespace
}  // namespace byre::cli
