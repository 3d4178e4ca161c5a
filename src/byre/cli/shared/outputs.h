#pragma once

#include "byre/trajectory_file.h"

#include <exception>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace byre::cli {

// Writes the outputs of a command; a failure does not prevent the other outputs.
class OutputWriter {
 public:
  void attempt(const std::function<void()>& write);
  // Writes the file if a path is given.
  void attempt(const std::optional<std::filesystem::path>& path, const Trajectory& trajectory, TrajectoryFormat format);
  void require_written() const;  // rethrows the first failure

 private:
  std::exception_ptr first_failure_;
};

// Files with a given path, in order.
std::vector<std::filesystem::path> given_paths(std::initializer_list<std::optional<std::filesystem::path>> files);

std::vector<std::string> names_of(const std::vector<std::filesystem::path>& files);

// Creates a folder with its parents. Throws InputError on failure.
void make_folder(const std::filesystem::path& folder);

}  // namespace byre::cli
