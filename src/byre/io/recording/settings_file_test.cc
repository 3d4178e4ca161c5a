#include "byre/io/recording/settings_file.h"

#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SettingsFile : public TestFolder {
 protected:
  std::vector<Setting> read(const std::string& text) const {
    write("options.yaml", text);
    return read_settings(folder_ / "options.yaml");
  }
  std::string error(const std::string& text) const {
    return error_of([&] { read(text); });
  }
};

TEST_F(SettingsFile, ReturnsNamesWithGroupsAndLines) {
  std::vector<std::string> read_as;
  for (const Setting& setting :
       read("pace: live  # as fast\n\ntracking:\n  near:\n    radius: 1.5\n  points: '7'\nempty:\n")) {
    read_as.push_back(std::to_string(setting.line) + " " + setting.name + "=" + setting.text);
  }
  EXPECT_THAT(read_as, ElementsAre("1 pace=live", "5 tracking.near.radius=1.5", "6 tracking.points=7", "7 empty="));
}

TEST_F(SettingsFile, AcceptsAnEmptyFile) {
  EXPECT_THAT(read(""), IsEmpty());
  EXPECT_THAT(read("# pace: live\n"), IsEmpty());
}

TEST_F(SettingsFile, ReportsErrorsWithTheirLine) {
  EXPECT_THAT(error("a: 1\nb: [1, 2]\n"), HasSubstr("options.yaml:2: b is a list (give one value)"));
  EXPECT_THAT(error("a:\n  b: 1\n  b: 2\n"), HasSubstr("options.yaml:3: a.b is given twice"));
  EXPECT_THAT(error("a.b: 1\na:\n  b: 2\n"), HasSubstr("options.yaml:3: a.b is given twice"));
  EXPECT_THAT(error("[a]: 1\n"), HasSubstr("options.yaml:1: has no name"));
  EXPECT_THAT(error("just words"), HasSubstr("is not a YAML mapping of named fields"));
  EXPECT_THAT(error("a: 1\nb: [1\n"), HasSubstr("(correct the YAML)"));
  EXPECT_THAT(error("a: &a\n  b: *a\n"), HasSubstr("is nested too deeply"));
  EXPECT_THAT(error_of([&] { read_settings(folder_); }), HasSubstr("is a folder (give a file)"));
  EXPECT_THAT(error_of([&] { read_settings(folder_ / "absent.yaml"); }), HasSubstr("absent.yaml: cannot be opened"));
}

}  // namespace
}  // namespace byre
