#pragma once

#include "byre/io/ros/message_bytes.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre::ros {

// Collects the .msg text of a message and of its parts, each once.
class SchemaWriter {
 public:
  template <Message T>
  void add() {
    const std::string type = short_type(T::kType);
    if (std::ranges::find(definitions_, type, &Definition::type) != definitions_.end()) return;
    const std::size_t index = definitions_.size();
    definitions_.push_back({type, ""});
    if constexpr (requires { T::kConstants; }) definitions_[index].text = T::kConstants;
    std::swap(current_, definitions_[index].text);
    const T message;
    T::fields(message, *this);
    std::swap(current_, definitions_[index].text);
  }

  template <typename... T>
  void operator()(std::string_view names, const T&... /*values*/) {
    (add_field<T>(names), ...);
  }
  void ros1_only(const std::uint32_t& /*value*/) {}

  // Text of the first message, then of the others, each after a line of 80 "=" and a line with its name.
  std::string text() const {
    std::string text;
    for (const Definition& definition : definitions_) {
      if (!text.empty()) text += std::string(80, '=') + "\nMSG: " + definition.type + "\n";
      text += definition.text;
    }
    return text;
  }

 private:
  struct Definition {
    std::string type;
    std::string text;
  };

  // Field of the first name, which is removed.
  template <typename T>
  void add_field(std::string_view& names) {
    const std::string_view name = names.substr(0, names.find(' '));
    names.remove_prefix(std::min(name.size() + 1, names.size()));
    current_.append(type_name<T>()).append(" ").append(name).append("\n");
    add_parts<T>();
  }
  template <typename T>
  static std::string type_name() {
    if constexpr (Message<T>) {
      return short_type(T::kType);
    } else if constexpr (std::same_as<T, std::string>) {
      return "string";
    } else if constexpr (requires { std::tuple_size<T>::value; }) {
      return type_name<typename T::value_type>() + "[" + std::to_string(std::tuple_size<T>::value) + "]";
    } else if constexpr (!Number<T>) {
      return type_name<typename T::value_type>() + "[]";
    } else {
      return number_name<T>();
    }
  }
  template <Number T>
  static std::string number_name() {
    if constexpr (std::same_as<T, std::byte>) return "byte";
    if constexpr (std::same_as<T, bool>) return "bool";
    const std::string bits = std::to_string(8 * sizeof(T));
    if constexpr (std::floating_point<T>) return "float" + bits;
    return (std::is_unsigned_v<T> ? "uint" : "int") + bits;
  }
  template <typename T>
  void add_parts() {
    if constexpr (Message<T>) {
      add<T>();
    } else if constexpr (requires { requires Message<typename T::value_type>; }) {
      add<typename T::value_type>();
    }
  }

  std::vector<Definition> definitions_;
  std::string current_;  // text of the current message
};

// Message definition in the format "ros2msg" of recordings: .msg text without comments, including all parts.
template <Message T>
std::string message_schema() {
  SchemaWriter writer;
  writer.add<T>();
  return writer.text();
}

}  // namespace byre::ros
