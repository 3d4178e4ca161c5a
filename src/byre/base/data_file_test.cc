#include "byre/base/data_file.h"

#include "byre/input_error.h"

#include <cstdlib>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::HasSubstr;

TEST(DataFile, IsFoundInTheSourceTree) {
  EXPECT_TRUE(std::filesystem::is_regular_file(find_data_file("default.vocabulary", "")));
  EXPECT_TRUE(std::filesystem::is_regular_file(find_data_file("protocols/euroc.yaml", "")));
}

TEST(DataFile, IsSearchedInTheEnvironmentVariableFirst) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("byre_data." + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "default.vocabulary") << "another";
  setenv("BYRE_DATA", folder.c_str(), 1);
  EXPECT_EQ(find_data_file("default.vocabulary", ""), folder / "default.vocabulary");
  EXPECT_NE(find_data_file("protocols/euroc.yaml", "").parent_path(), folder)
      << "the search continues for missing files";
  unsetenv("BYRE_DATA");
  std::filesystem::remove_all(folder);
}

TEST(DataFile, ReportsARemedyIfMissing) {
  try {
    find_data_file("protocols/absent.yaml", "give an existing protocol");
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("protocols/absent.yaml: is not found in"));
    EXPECT_EQ(error.remedy(), "give an existing protocol");
  }
}

}  // namespace
}  // namespace byre
