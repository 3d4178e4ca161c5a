#include "byre/io/calibration/yaml_mapping.h"

#include "byre/base/regular_file.h"
#include "byre/input_error.h"

#include <string>

namespace byre {

YAML::Node load_yaml_mapping(const std::filesystem::path& path) {
  refuse_pipe(path);
  try {
    YAML::Node root = YAML::LoadFile(path.string());
    if (!root.IsMap()) throw InputError(path.string(), "is not a YAML mapping of named fields");
    return root;
  } catch (const YAML::BadFile&) {
    throw InputError(path.string(), "cannot be opened", "check that it exists and is readable");
  } catch (const YAML::Exception& error) {
    throw InputError(path.string() + ":" + std::to_string(error.mark.line + 1), error.msg, "correct the YAML");
  }
}

}  // namespace byre
