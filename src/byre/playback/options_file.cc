#include "byre/playback/options_file.h"

#include "byre/input_error.h"
#include "byre/io/recording/settings_file.h"
#include "byre/slam/system/option_table.h"

namespace byre {

void read_options(const std::filesystem::path& path, MethodOptions& options) {
  for (const Setting& setting : read_settings(path)) {
    if (const auto fault = set_option(options, setting.name, setting.text)) {
      throw InputError(path.string() + ":" + std::to_string(setting.line), fault->reason, fault->remedy);
    }
  }
}

// Precondition: at most one level of groups, options of a group adjacent.
std::string options_file(const MethodOptions& options) {
  std::string text;
  std::string group;
  for (const MethodOption& option : option_table()) {
    const std::size_t dot = option.name.find('.');
    const std::string its_group = dot == std::string::npos ? "" : option.name.substr(0, dot);
    if (its_group != group && !its_group.empty()) text += its_group + ":\n";
    group = its_group;
    const std::string word = group.empty() ? option.name : "  " + option.name.substr(dot + 1);
    const std::string unit = option.unit.empty() ? "" : option.unit + ", ";
    text += word + ": " + option.get(options) + "  # " + option.meaning + " (" + unit + option.range + ")\n";
  }
  return text;
}

}  // namespace byre
