#include "byre/input_error.h"
#include "byre/place/vocabulary.h"

#include <cstdlib>
#include <optional>
#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

// Unsets $BYRE_VOCABULARY and restores it afterwards.
class DefaultVocabulary : public testing::Test {
 protected:
  DefaultVocabulary() {
    if (const char* const value = std::getenv(kVariable)) before_ = value;
    unsetenv(kVariable);
  }
  ~DefaultVocabulary() override {
    unsetenv(kVariable);
    if (before_) setenv(kVariable, before_->c_str(), 1);
  }

  static constexpr const char* kVariable = "BYRE_VOCABULARY";
  std::optional<std::string> before_;
};

TEST_F(DefaultVocabulary, IsInstalled) {
  const Vocabulary vocabulary = Vocabulary::load(default_vocabulary_path());
  EXPECT_GT(vocabulary.word_count(), 10'000);
  EXPECT_LE(std::filesystem::file_size(default_vocabulary_path()), 10'000'000u);
}

TEST_F(DefaultVocabulary, IsReadFromTheEnvironmentVariable) {
  const std::string shipped = std::string(BYRE_SOURCE_DIR) + "/share/byre/default.vocabulary";
  const std::string chosen = std::string(BYRE_SOURCE_DIR) + "/share/../share/byre/default.vocabulary";
  setenv(kVariable, chosen.c_str(), 1);
  EXPECT_EQ(default_vocabulary_path(), chosen);
  setenv(kVariable, "", 1);
  EXPECT_NE(default_vocabulary_path(), "") << "an empty variable counts as unset";
  EXPECT_EQ(Vocabulary::load(shipped).checksum(), Vocabulary::load(chosen).checksum());
}

TEST_F(DefaultVocabulary, HasNoFallbackForAWrongEnvironmentVariable) {
  setenv(kVariable, "/absent/my.vocabulary", 1);
  try {
    default_vocabulary_path();
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("/absent/my.vocabulary"));
    EXPECT_THAT(error.what(), testing::HasSubstr("$BYRE_VOCABULARY"));
  }
}

}  // namespace
}  // namespace byre
