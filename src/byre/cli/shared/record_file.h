#pragma once

#include "byre/assessment/run_record.h"

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace byre::cli {

// --record and --record-images. The options must outlive the parsing of the command line.
void declare_recording(CLI::App& command, std::optional<std::filesystem::path>& record, bool& with_images);

// The file that a run is recorded in, where one is asked for. It is written as the run goes on, so that what is known
// of it is kept however it ends. That it cannot be written any more is told at once, and the run goes on.
class RecordFile {
 public:
  // Throws InputError when the file cannot be begun.
  RecordFile(const std::optional<std::filesystem::path>& path, const Calibration& calibration, bool with_images);

  bool is_wanted() const { return record_.has_value(); }
  void note(const RunView& view);              // after each frame whose images could be read
  void note_unread(const MappedFrame& frame);  // after each other one
  void finish(const MapRun& run);
  void require_written() const;  // throws when anything is missing

 private:
  template <typename Write>
  void attempt(Write write);

  std::optional<RunRecord> record_;  // empty: nothing is recorded
  std::optional<std::string> fault_;
};

}  // namespace byre::cli
