#include "byre/cli/shared/record_file.h"

#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/warnings.h"
#include "byre/input_error.h"

#include <iostream>
#include <stdexcept>

namespace byre::cli {

void declare_recording(CLI::App& command, std::optional<std::filesystem::path>& record, bool& with_images) {
  CLI::Option* const file = add_output(command, Output::mcap, "--record", record,
                                       "Poses, diagnostics, events and map as messages of ROS 2, in an MCAP file")
                                ->type_name("FILE");
  command.add_flag("--record-images", with_images, "Images and camera info too, so that the file can be run again")
      ->needs(file);
}

RecordFile::RecordFile(const std::optional<std::filesystem::path>& path, const Calibration& calibration,
                       bool with_images) {
  if (path) record_.emplace(McapWriter(*path), calibration, with_images);
}

template <typename Write>
void RecordFile::attempt(Write write) {
  if (!record_ || fault_) return;
  try {
    write();
  } catch (const InputError& error) {
    fault_ = error.what();
    show_warnings(std::cerr, {*fault_});
  }
}

void RecordFile::note(const RunView& view) {
  attempt([&] { record_->note(view); });
}

void RecordFile::note_unread(const MappedFrame& frame) {
  attempt([&] { record_->note_unread(frame); });
}

void RecordFile::finish(const MapRun& run) {
  attempt([&] { record_->finish(run); });
}

void RecordFile::require_written() const {
  if (fault_) throw std::runtime_error(*fault_);
}

}  // namespace byre::cli
