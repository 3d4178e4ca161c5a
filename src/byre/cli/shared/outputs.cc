#include "byre/cli/shared/outputs.h"

#include "byre/input_error.h"

#include <system_error>

namespace byre::cli {

namespace fs = std::filesystem;

void OutputWriter::attempt(const std::function<void()>& write) {
  try {
    write();
  } catch (const std::exception&) {
    if (!first_failure_) first_failure_ = std::current_exception();
  }
}

void OutputWriter::attempt(const std::optional<fs::path>& path, const Trajectory& trajectory, TrajectoryFormat format) {
  if (path) attempt([&] { write_trajectory(trajectory, *path, format); });
}

void OutputWriter::require_written() const {
  if (first_failure_) std::rethrow_exception(first_failure_);
}

std::vector<std::filesystem::path> given_paths(std::initializer_list<std::optional<std::filesystem::path>> files) {
  std::vector<std::filesystem::path> asked;
  for (const auto& file : files) {
    if (file) asked.push_back(*file);
  }
  return asked;
}

std::vector<std::string> names_of(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.string());
  return names;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw InputError(folder.string(), "cannot be created as a folder", "give another folder with -o");
  }
}

}  // namespace byre::cli
