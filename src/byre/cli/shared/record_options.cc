#include "byre/cli/shared/record_options.h"

#include "byre/cli/shared/file_arguments.h"

namespace byre::cli {

void declare_recording(CLI::App& command, std::optional<std::filesystem::path>& record, bool& with_images) {
  CLI::Option* const file = add_output(command, Output::mcap, "--record", record,
                                       "MCAP file of poses, diagnostics, events and map as ROS 2 messages")
                                ->type_name("FILE");
  command
      .add_flag("--record-images", with_images, "Record images and camera info too, so that the file can be run again")
      ->needs(file);
}

}  // namespace byre::cli
