#pragma once

#include "byre/image.h"
#include "byre/input_error.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {

// Temporary folder of one test, removed after it.
class TestFolder : public testing::Test {
 protected:
  TestFolder() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~TestFolder() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

  // Writes a uniformly grey image with a black top left pixel.
  void write_image(const std::string& name, int width, int height, int grey) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    cv::Mat image(height, width, CV_8U, cv::Scalar(grey));
    image.at<std::uint8_t>(0, 0) = 0;
    cv::imwrite((folder_ / name).string(), image);
  }

  void cut_in_half(const std::string& name) const {
    std::filesystem::resize_file(folder_ / name, std::filesystem::file_size(folder_ / name) / 2);
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string(testing::UnitTest::GetInstance()->current_test_info()->test_suite_name()) + "." +
       testing::UnitTest::GetInstance()->current_test_info()->name());
};

inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

}  // namespace byre
