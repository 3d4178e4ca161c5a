#include "byre/io/ros/message_schema.h"

namespace byre::ros {

std::string SchemaWriter::text() const {
  std::string text;
  for (const Definition& definition : definitions_) {
    if (!text.empty()) text += std::string(80, '=') + "\nMSG: " + definition.type + "\n";
    text += definition.text;
  }
  return text;
}

}  // namespace byre::ros
