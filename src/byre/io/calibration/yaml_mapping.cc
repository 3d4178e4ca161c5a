#include "byre/io/calibration/yaml_mapping.h"

#include "byre/base/printable.h"
#include "byre/base/regular_file.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

namespace byre {

YAML::Node load_yaml(const std::filesystem::path& path) {
  refuse_pipe(path);
  if (std::filesystem::is_directory(path)) throw InputError(path.string(), "is a folder", "give a file");
  try {
    return YAML::LoadFile(path.string());
  } catch (const YAML::BadFile&) {
    throw InputError(path.string(), "cannot be opened", "check that it exists and is readable");
  } catch (const YAML::Exception& error) {
    throw InputError(path.string() + ":" + std::to_string(error.mark.line + 1), error.msg, "correct the YAML");
  }
}

YAML::Node load_yaml_mapping(const std::filesystem::path& path) {
  const YAML::Node root = load_yaml(path);
  if (!root.IsMap()) throw InputError(path.string(), "is not a YAML mapping of named fields");
  return root;
}

void require_known_fields(const YAML::Node& fields, std::span<const char* const> known, const std::string& place,
                          const char* of) {
  if (!fields.IsMap()) throw InputError(place, "is not a YAML mapping of named fields");
  for (const auto& field : fields) {
    const std::string_view name = field.first.IsScalar() ? std::string_view(field.first.Scalar()) : "";
    if (std::ranges::find(known, name) == known.end()) {
      throw InputError(place + ": " + printable(name), std::string("is not a field of ") + of,
                       fmt::format("fields: {}", fmt::join(known, ", ")));
    }
  }
}

double checked_number(const YAML::Node& node, const std::string& place, double low, double high) {
  const std::optional<double> value = node && node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
  if (!value) throw InputError(place, node ? "is not a number" : "is missing");
  if (*value >= low && *value <= high) return *value;
  throw InputError(place, fmt::format("is {:g}, outside {:g} to {:g}", *value, low, high));
}

}  // namespace byre
