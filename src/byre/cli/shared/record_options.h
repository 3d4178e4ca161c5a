#pragma once

#include <filesystem>
#include <optional>

namespace CLI {
class App;
}

namespace byre::cli {

// --record and --record-images. The options must outlive the parsing of the command line.
void declare_recording(CLI::App& command, std::optional<std::filesystem::path>& record, bool& with_images);

}  // namespace byre::cli
