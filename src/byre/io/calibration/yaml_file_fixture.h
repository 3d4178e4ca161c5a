#pragma once

// A YAML file that tests write, and its reader.

#include "byre/input_error.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace byre {

template <auto kReader>
class YamlFileTest : public testing::Test {
 protected:
  YamlFileTest()
      : path_(std::filesystem::path(testing::TempDir()) / ("byre_test." + std::to_string(getpid()) + ".yaml")) {}
  ~YamlFileTest() override { std::filesystem::remove(path_); }

  auto read(const std::string& text) {
    std::ofstream(path_) << text;
    return kReader(path_);
  }
  std::string fault_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path path_;
};

}  // namespace byre
