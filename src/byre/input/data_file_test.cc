#include "byre/input/data_file.h"

#include "byre/input_error.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

TEST(DataFile, IsFoundInTheSourceTree) {
  EXPECT_TRUE(std::filesystem::is_regular_file(find_data_file("default.vocabulary", "")));
  EXPECT_TRUE(std::filesystem::is_regular_file(find_data_file("protocols/euroc.yaml", "")));
}

TEST(DataFile, SaysWhatToDoWithoutIt) {
  try {
    find_data_file("protocols/absent.yaml", "name a protocol that is there");
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("protocols/absent.yaml: is neither in"));
    EXPECT_EQ(error.remedy(), "name a protocol that is there");
  }
}

}  // namespace
}  // namespace byre
