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

// Writes the outputs of a command so that one that fails does not keep the others from being written.
class OutputWriter {
 public:
  void attempt(const std::function<void()>& write);
  // Where a file is asked for.
  void attempt(const std::optional<std::filesystem::path>& path, const Trajectory& trajectory, TrajectoryFormat format);
  void require_written() const;  // throws what the first that failed threw

 private:
  std::exception_ptr first_failure_;
};

// The files that are asked for, in this order.
std::vector<std::filesystem::path> asked_for(std::initializer_list<std::optional<std::filesystem::path>> files);

std::vector<std::string> names_of(const std::vector<std::filesystem::path>& files);

// With those above it. Throws InputError when that cannot be done.
void make_folder(const std::filesystem::path& folder);

}  // namespace byre::cli
