#include "byre/playback/report/bag_report.h"

#include "byre/input_error.h"
#include "byre/io/recording/bag_topics.h"

#include <algorithm>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

// Topics of the images that a run would use.
Json images_json(const ImageTopics& topics, const BagContent& content) {
  return {{"left", content.topics[topics.left].name},
          {"right", topics.right ? Json(content.topics[*topics.right].name) : Json()}};
}

void add_topics(const BagContent& content, double seconds, Report& report) {
  std::size_t longest_name = 0, longest_type = 0;
  for (const BagTopic& topic : content.topics) {
    longest_name = std::max(longest_name, topic.name.size());
    longest_type = std::max(longest_type, topic.type.size());
  }
  for (const BagTopic& topic : content.topics) {
    Json figures = {
        {"name", topic.name}, {"type", topic.type}, {"encoding", topic.encoding}, {"messages", topic.messages}};
    report.figures["topics"].push_back(figures);
    figures["name"] = topic.name + std::string(longest_name + 2 - topic.name.size(), ' ');
    figures["type"] = topic.type + std::string(longest_type + 2 - topic.type.size(), ' ');
    if (topic.messages > 1 && seconds > 0.0) figures["hz"] = static_cast<double>(topic.messages - 1) / seconds;
    figures["is_readable"] = encoding_of(topic).has_value();
    report.row("topic",
               "{name}{type}{messages}[, {hz:.1f} Hz][{!is_readable}, encoded as {encoding}, not readable by byre]",
               figures);
  }
}

}  // namespace

Report bag_report(const BagContent& content, const std::string& bag) {
  const double seconds = content.first ? to_seconds(*content.last - *content.first) : 0.0;
  Report report{{{"program", "byre bag info"},
                 {"version", BYRE_VERSION},
                 {"bag", bag},
                 {"storage", content.storage},
                 {"compression", content.compression},
                 {"bytes", content.bytes},
                 {"duration_s", seconds},
                 {"first_ns", content.first ? Json(content.first->count()) : Json()},
                 {"last_ns", content.last ? Json(content.last->count()) : Json()},
                 {"messages", content.message_count},
                 {"topics", Json::array()},
                 {"images", nullptr},
                 {"damage", content.damage}}};
  std::string fault;
  try {
    report.figures["images"] = images_json(choose_image_topics(content, {}, bag), content);
  } catch (const InputError& error) {
    fault = error.reason();
  }
  report.row("bag", "{bag}");
  report.row("storage", "{storage}[{?compression}, {compression}], {bytes*1e-6:.1f} MB");
  report.row("duration", "{duration_s:.3f} s");
  if (content.first) report.row("from", "{first_s:.3f} s since 1970", {{"first_s", to_seconds(*content.first)}});
  report.row("messages", "{messages}");
  add_topics(content, seconds, report);
  report.row("images", "[left {images.left}, right {images.right}|{images.left}, one camera|{fault}]",
             {{"fault", fault}});
  for (const std::string& damage : content.damage) report.row("DAMAGE", "{damage}", {{"damage", damage}});
  return report;
}

}  // namespace byre
