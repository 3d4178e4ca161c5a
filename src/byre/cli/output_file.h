#pragma once

#include "byre/trajectory.h"

#include <exception>
#include <filesystem>
#include <functional>
#include <string>

namespace byre::cli {

// Throws InputError when no file can be written there, so that it is known before the work and not after it.
void require_writable(const std::filesystem::path& path);

// Has write(other_path) write a file beside path, then gives it the name path: what is there is whole, whenever the
// program ends. A path that is no regular file, such as /dev/stdout, is written to directly. Hands on what write
// throws.
void write_whole(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

// The same for a text, and for a trajectory as a TUM file. Throw InputError when it cannot be written.
void write_whole(const std::filesystem::path& path, const std::string& text);
void write_whole(const std::filesystem::path& path, const Trajectory& trajectory);

// Writes the outputs of a command so that one that fails does not keep the others from being written.
class OutputWriter {
 public:
  void attempt(const std::function<void()>& write);
  void require_written() const;  // throws what the first that failed threw

 private:
  std::exception_ptr first_failure_;
};

}  // namespace byre::cli
