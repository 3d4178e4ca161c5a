#include "byre/ros2/dds/ros_names.h"

#include <algorithm>
#include <cctype>

namespace byre {
namespace {

bool is_word_letter(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
}

}  // namespace

std::string dds_topic_name(std::string_view topic) {
  return "rt" + std::string(topic);
}

std::string dds_request_name(std::string_view service) {
  return "rq" + std::string(service) + "Request";
}

std::string dds_reply_name(std::string_view service) {
  return "rr" + std::string(service) + "Reply";
}

std::string dds_type_name(std::string_view type_name) {
  std::string name;
  const std::size_t last = type_name.rfind('/');
  for (std::size_t i = 0; i < type_name.size(); ++i) {
    if (type_name[i] != '/') name += type_name[i];
    if (type_name[i] == '/') name += i == last ? "::dds_::" : "::";
  }
  return name + "_";
}

std::string ros_type_name(std::string_view dds_type) {
  constexpr std::string_view kMark = "dds_::";
  const std::size_t mark = dds_type.find(kMark);
  if (mark == std::string_view::npos || !dds_type.ends_with('_')) return "";
  dds_type.remove_suffix(1);
  std::string name = std::string(dds_type.substr(0, mark)) + std::string(dds_type.substr(mark + kMark.size()));
  for (std::size_t at = 0; (at = name.find("::", at)) != std::string::npos;) name.replace(at, 2, "/");
  return name;
}

std::string fault_in_name(std::string_view name) {
  constexpr std::size_t kLongest = 240;  // characters; DDS accepts 256 including prefix and suffix
  if (name.size() > kLongest) return "is longer than 240 characters";
  if (!name.starts_with('/')) return "does not begin with a slash";
  if (name == "/") return "";
  bool is_word_begin = true;
  for (const char letter : name.substr(1)) {
    if (letter == '/' ? is_word_begin : !is_word_letter(letter)) {
      return letter == '/' ? "has two consecutive slashes"
                           : "contains characters other than letters, digits, underscores and slashes";
    }
    if (is_word_begin && std::isdigit(static_cast<unsigned char>(letter)) != 0)
      return "has a part that begins with a digit";
    is_word_begin = letter == '/';
  }
  return is_word_begin ? "ends with a slash" : "";
}

std::string resolve_name(std::string_view topic, std::string_view name_space) {
  if (topic.starts_with('/')) return std::string(topic);
  return std::string(name_space) + (name_space.ends_with('/') ? "" : "/") + std::string(topic);
}

}  // namespace byre
