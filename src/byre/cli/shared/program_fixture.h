#pragma once

#include "byre/simulation/rendered_scene.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

namespace byre::cli {

// Quotes a path for the shell.
inline std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

inline std::string rendered_room() {
  return quoted(RenderedFixture::shared().folder());
}

// Curved path through the room without frame-filling walls, at twice the resolution of rendered_room(). Rendered once.
inline const RenderedFixture& bend_recording() {
  static const Calibration calibration = euroc_like_calibration(2);
  static const RenderedFixture recording("byre_cli_bend", calibration,
                                         circling_trajectory(40, 20.0, 2.0, 0.25, calibration.body_from_left));
  return recording;
}

inline std::string rendered_bend() {
  return quoted(bend_recording().folder());
}

struct Outcome {
  int exit_code = -1;
  std::string output;
  std::string errors;
};

// Runs the program in a folder of its own per test.
class ProgramTest : public testing::Test {
 protected:
  ProgramTest() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ProgramTest() override { std::filesystem::remove_all(folder_); }

  // Whether the folder has temporary files of outputs.
  bool has_unfinished_files() const {
    const auto is_unfinished = [](const auto& entry) { return entry.path().extension() == ".unfinished"; };
    return std::any_of(std::filesystem::directory_iterator(folder_), {}, is_unfinished);
  }

  void write(const std::string& name, const std::string& content) const { std::ofstream(folder_ / name) << content; }

  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }

  Outcome run(const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && '" + BYRE_PROGRAM + "' " + arguments + " >stdout.txt 2>stderr.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("stdout.txt"), read("stderr.txt")};
  }

  // Runs a command once per process. Later calls return the same outcome and restore the files that it wrote.
  // Precondition: it reads and replaces no files of the test.
  Outcome run_once(const std::string& arguments) const {
    static std::map<std::string, std::pair<Outcome, std::map<std::string, std::string>>> runs;
    auto known = runs.find(arguments);
    if (known == runs.end()) {
      const std::set<std::string> before = names_of_files();
      known = runs.emplace(arguments, std::pair(run(arguments), std::map<std::string, std::string>())).first;
      for (const std::string& name : names_of_files()) {
        if (!before.contains(name)) known->second.second.emplace(name, read(name));
      }
    } else {
      for (const auto& [name, content] : known->second.second) {
        std::filesystem::create_directories((folder_ / name).parent_path());
        write(name, content);
      }
    }
    return known->second.first;
  }

  // Maps the shared rendered room, by run_once.
  void map_room(const std::string& options, const std::string& file) const {
    const Outcome outcome = run_once("map " + rendered_room() + " " + options + " --quiet -o " + file);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  }

  // Starts the program with default handling of these signals, and a file as standard input.
  pid_t start(std::vector<std::string> arguments, const std::vector<int>& signals = {SIGINT, SIGTERM, SIGHUP},
              const char* input = "/dev/null") const {
    arguments.insert(arguments.begin(), BYRE_PROGRAM);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, input, O_RDONLY | O_NOCTTY, 0);
    const std::pair<int, std::filesystem::path> streams[] = {{1, folder_ / "stdout.txt"}, {2, folder_ / "stderr.txt"}};
    for (const auto& [stream, path] : streams) {
      posix_spawn_file_actions_addopen(&files, stream, path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    }
    sigset_t as_in_a_terminal;
    sigemptyset(&as_in_a_terminal);
    for (const int signal : signals) sigaddset(&as_in_a_terminal, signal);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigdefault(&attributes, &as_in_a_terminal);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    pid_t process = -1;
    EXPECT_EQ(posix_spawn(&process, BYRE_PROGRAM, &files, &attributes, pointers.data(), environ), 0);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return process;
  }

  bool appears(const std::string& text, const std::string& file,
               std::chrono::milliseconds patience = std::chrono::seconds(30)) const {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
      if (read(file).find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  static int exit_code_of(pid_t process) {
    int status = 0;
    EXPECT_EQ(waitpid(process, &status, 0), process);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  // Relative names of all files in the folder, recursively.
  std::set<std::string> names_of_files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
      if (entry.is_regular_file()) names.insert(std::filesystem::relative(entry.path(), folder_).string());
    }
    return names;
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("byre_program.") + testing::UnitTest::GetInstance()->current_test_info()->test_suite_name() + "." +
       testing::UnitTest::GetInstance()->current_test_info()->name());
};

}  // namespace byre::cli
