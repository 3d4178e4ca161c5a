// "byre export-colmap" and "byre import-colmap".

#include "byre/cli/shared/program_fixture.h"
#include "byre/io/colmap/colmap_model.h"
#include "byre/playback/archive/colmap_scene.h"

#include <fmt/core.h>
#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class ColmapCommands : public ProgramTest {
 protected:
  ColmapCommands() { save_map(rendered_map(), folder_ / "room.byre"); }

  static std::string recording() { return fmt::format("'{}'", RenderedFixture::shared().folder().string()); }
  static std::string images() { return recording() + "/mav0/cam0/data"; }
};

TEST_F(ColmapCommands, ExportAndImportAMap) {
  const Outcome exported = run("export-colmap room.byre -o model/of/room --text --images-of " + recording());
  EXPECT_EQ(exported.exit_code, 0) << exported.errors;
  EXPECT_THAT(exported.output, HasSubstr("1 cameras, 8 images"));
  EXPECT_EQ(read_colmap_model(folder_ / "model/of/room").images.size(), 8u);

  const Outcome imported = run("import-colmap model/of/room " + images() + " -o back.byre --site Barn --quiet");
  EXPECT_EQ(imported.exit_code, 0) << imported.errors;
  EXPECT_THAT(imported.errors, IsEmpty());
  EXPECT_THAT(imported.output,
              AllOf(HasSubstr("keyframes          8"), HasSubstr("of the model (metric with --scale)")));
  const StoredMap stored = load_map(folder_ / "back.byre");
  EXPECT_EQ(stored.scale, MapScale::unknown);
  EXPECT_EQ(stored.pose_source, PoseSource::imported);
  EXPECT_EQ(stored.notes.at("site"), "Barn");
  EXPECT_NE(stored.vocabulary_checksum, 0u);

  const Outcome model_only =
      run("import-colmap model/of/room " + images() + " -o model_only.byre --model-points-only --quiet");
  EXPECT_THAT(model_only.output, HasSubstr(", 0 added by byre"));
  EXPECT_LT(load_map(folder_ / "model_only.byre").map.point_count(), stored.map.point_count());
}

TEST_F(ColmapCommands, ReportBadInputWithItsOwnExitCode) {
  const Outcome no_model = run("import-colmap nowhere " + images() + " -o back.byre");
  EXPECT_EQ(no_model.exit_code, 3);
  EXPECT_THAT(no_model.errors, HasSubstr("nowhere: contains no COLMAP model"));
  run("export-colmap room.byre -o model");
  const Outcome no_images = run("import-colmap model . -o back.byre --quiet");
  EXPECT_EQ(no_images.exit_code, 3);
  EXPECT_THAT(no_images.errors, HasSubstr("contains none of the model's images"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "back.byre"));
  EXPECT_EQ(run("export-colmap nowhere.byre -o model").exit_code, 3);
  write("file", "no folder");
  EXPECT_EQ(run("export-colmap room.byre -o file").exit_code, 3);
}

TEST_F(ColmapCommands, RejectContradictingOptions) {
  EXPECT_EQ(run("export-colmap room.byre -o model --text --binary").exit_code, 2);
  EXPECT_EQ(run("import-colmap model images -o back.byre --scale 0").exit_code, 2);
  EXPECT_EQ(run("import-colmap model images -o back.byre --body-of room").exit_code, 2);
}

}  // namespace
}  // namespace byre::cli
