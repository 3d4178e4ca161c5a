#include "byre/tag.h"

#include "byre/base/enum_names.h"

namespace byre {

std::string_view to_string(TagFamily family) {
  return name_among<TagFamily::tag_standard41h12>({"tag36h11", "tag25h9", "tagStandard41h12"}, family);
}

std::string to_string(const TagId& id) {
  return std::string(to_string(id.family)) + " " + std::to_string(id.number);
}

}  // namespace byre
