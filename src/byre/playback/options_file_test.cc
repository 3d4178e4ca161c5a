#include "byre/playback/options_file.h"

#include "byre/io/recording/folder_scene.h"
#include "byre/slam/system/option_table.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

class OptionsFile : public TestFolder {
 protected:
  MethodOptions read(const std::string& text) const {
    write("options.yaml", text);
    MethodOptions options;
    read_options(folder_ / "options.yaml", options);
    return options;
  }
  std::string error(const std::string& text) const {
    return error_of([&] { read(text); });
  }
};

// All options at another value: the other end of the range, or another choice.
MethodOptions all_changed() {
  MethodOptions options;
  for (const MethodOption& option : option_table()) {
    const std::string before = option.get(options);
    std::string words = option.range;
    std::ranges::replace(words, '|', ' ');
    std::istringstream stream(words);
    for (std::string word; option.get(options) == before && stream >> word;) option.set(options, word);
    EXPECT_NE(option.get(options), before) << option.name;
  }
  return options;
}

TEST_F(OptionsFile, SetsOnlyItsOptions) {
  const MethodOptions options = read("pace: live\ntracking:\n  search_radius_px: 20.5\n");
  EXPECT_EQ(options.pace, Pace::live);
  EXPECT_EQ(options.session.track.search_radius, 20.5f);
  MethodOptions back = options;
  back.pace = MethodOptions{}.pace;
  back.session.track.search_radius = MethodOptions{}.session.track.search_radius;
  EXPECT_EQ(options_file(back), options_file({}));
}

TEST_F(OptionsFile, IsReadAsWritten) {
  const MethodOptions options = all_changed();
  EXPECT_NE(options_file(options), options_file({}));
  EXPECT_EQ(options_file(read(options_file(options))), options_file(options));
  EXPECT_EQ(options_file(read(options_file({}))), options_file({}));
}

TEST_F(OptionsFile, ReportsFaultsWithLineAndRemedy) {
  EXPECT_THAT(
      error("tracking:\n  serch_radius_px: 3\n"),
      HasSubstr(
          "options.yaml:2: unknown option 'tracking.serch_radius_px' (did you mean 'tracking.search_radius_px'?)"));
  EXPECT_THAT(
      error("health:\n  trusted_error_m: wide\n"),
      HasSubstr(
          "options.yaml:2: 'wide' is not a value of health.trusted_error_m (give from 0.000001 to 1000, in metres)"));
  EXPECT_THAT(error("pace: fast\n"),
              HasSubstr("options.yaml:1: 'fast' is not a value of pace (give inline|paced|live)"));
  EXPECT_THAT(error("tracking: 5\n"), HasSubstr("unknown option 'tracking'"));
  EXPECT_THAT(error("map_online:\n"), HasSubstr("'' is not a value of map_online (give true|false)"));
}

}  // namespace
}  // namespace byre
