#include "byre/playback/report/bag_report.h"

#include "byre/base/report_row.h"
#include "byre/input_error.h"
#include "byre/io/recording/bag_topics.h"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

double duration_s(const BagContent& content) {
  return content.first ? to_seconds(*content.last - *content.first) : 0.0;
}

// Topics that a run would use, or the reason for none.
struct Choice {
  std::optional<ImageTopics> topics;
  std::string reason;
};

Choice choice_of(const BagContent& content, const std::string& bag) {
  try {
    return {choose_image_topics(content, {}, bag), ""};
  } catch (const InputError& error) {
    return {std::nullopt, error.reason()};
  }
}

std::string describe(const Choice& choice, const BagContent& content) {
  if (!choice.topics) return choice.reason;
  const std::string& left = content.topics[choice.topics->left].name;
  if (!choice.topics->right) return left + ", one camera";
  return "left " + left + ", right " + content.topics[*choice.topics->right].name;
}

std::string storage_of(const BagContent& content) {
  std::string text = content.storage;
  for (const std::string& compression : content.compression) text += ", " + compression;
  return text + fmt::format(", {:.1f} MB", 1e-6 * static_cast<double>(content.bytes));
}

std::string describe(const BagTopic& topic, double seconds, std::size_t longest_name, std::size_t longest_type) {
  std::string text = topic.name + std::string(longest_name + 2 - topic.name.size(), ' ') + topic.type +
                     std::string(longest_type + 2 - topic.type.size(), ' ') + std::to_string(topic.messages);
  if (topic.messages > 1 && seconds > 0.0) {
    text += fmt::format(", {:.1f} Hz", static_cast<double>(topic.messages - 1) / seconds);
  }
  return encoding_of(topic) ? text : text + ", encoded as " + topic.encoding + ", not readable by byre";
}

}  // namespace

std::string describe(const BagContent& content, const std::string& bag) {
  std::size_t longest_name = 0, longest_type = 0;
  for (const BagTopic& topic : content.topics) {
    longest_name = std::max(longest_name, topic.name.size());
    longest_type = std::max(longest_type, topic.type.size());
  }
  const double seconds = duration_s(content);
  std::string text = row("bag", bag) + row("storage", storage_of(content));
  text += row("duration", fmt::format("{:.3f} s", seconds));
  if (content.first) text += row("from", fmt::format("{:.3f} s since 1970", to_seconds(*content.first)));
  text += row("messages", std::to_string(content.message_count));
  for (const BagTopic& topic : content.topics) {
    text += row("topic", describe(topic, seconds, longest_name, longest_type));
  }
  text += row("images", describe(choice_of(content, bag), content));
  for (const std::string& damage : content.damage) text += row("DAMAGE", damage);
  return text;
}

Json bag_json(const BagContent& content, const std::string& bag) {
  Json json = {{"program", "byre bag info"},
               {"version", BYRE_VERSION},
               {"bag", bag},
               {"storage", content.storage},
               {"compression", content.compression},
               {"bytes", content.bytes},
               {"duration_s", duration_s(content)},
               {"first_ns", nullptr},
               {"last_ns", nullptr},
               {"messages", content.message_count},
               {"topics", Json::array()},
               {"images", nullptr},
               {"damage", content.damage}};
  if (content.first) json["first_ns"] = content.first->count();
  if (content.last) json["last_ns"] = content.last->count();
  for (const BagTopic& topic : content.topics) {
    json["topics"].push_back(
        {{"name", topic.name}, {"type", topic.type}, {"encoding", topic.encoding}, {"messages", topic.messages}});
  }
  const std::optional<ImageTopics> images = choice_of(content, bag).topics;
  if (!images) return json;
  json["images"] = {{"left", content.topics[images->left].name}, {"right", nullptr}};
  if (images->right) json["images"]["right"] = content.topics[*images->right].name;
  return json;
}

}  // namespace byre
