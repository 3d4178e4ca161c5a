#include "byre/io/ros/messages.h"

#include "byre/io/ros/message_bytes.h"

namespace byre::ros {

std::chrono::nanoseconds to_nanoseconds(const Time& time) {
  return std::chrono::seconds(time.sec) + std::chrono::nanoseconds(time.nanosec);
}

Time to_time(std::chrono::nanoseconds time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  return {static_cast<std::int32_t>(seconds.count()), static_cast<std::uint32_t>((time - seconds).count())};
}

std::string short_type(std::string_view type) {
  constexpr std::string_view kFolder = "/msg/";
  const std::size_t folder = type.find(kFolder);
  if (folder == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, folder + 1)).append(type.substr(folder + kFolder.size()));
}

}  // namespace byre::ros
