#include "byre/playback/report/recording_report.h"

#include "byre/input_error.h"
#include "byre/io/recording/bag_topics.h"

#include <algorithm>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

Json camera_json(const CameraCheck& camera) {
  Json faults;
  for (std::size_t i = 1; i < camera.by_fault.size(); ++i) {
    faults[std::string(to_string(static_cast<ImageFault>(i)))] = camera.by_fault[i];
  }
  return {{"images", camera.images},
          {"brightness", camera.brightness},
          {"contrast", camera.contrast},
          {"sharpness", camera.sharpness},
          {"of_no_use", faults}};
}

void add_camera(const char* label, const CameraCheck& camera, Report& report) {
  Json figures = camera_json(camera);
  figures["unusable"] = camera.unusable();
  report.row(label,
             "brightness {brightness:.0f} and contrast {contrast:.0f} grey values, sharpness {sharpness:.2f}; "
             "{unusable} of {images} images unusable",
             figures);
}

Json pair_json(const PairCheck& pair) {
  return {{"pairs", pair.pairs},
          {"matched_percent", 100.0 * pair.matched},
          {"row_error_px", pair.row_error},
          {"calibration_error_px", pair.calibration_error}};
}

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

std::string summary_of(const RecordingCheck& check) {
  return expand(
             "{rate_hz:.1f} Hz, {gaps} gaps; {features:.0f} features"
             "[{?features}, {pair.matched_percent:.0f} % matched in both images, "
             "row error {pair.row_error_px:.2f} px]",
             check_report(check, {}, "").figures)
      .value();
}

Report check_report(const RecordingCheck& check, const std::vector<Finding>& findings, const std::string& recording) {
  Report report{{{"program", "byre check"},
                 {"version", BYRE_VERSION},
                 {"recording", recording},
                 {"frames", check.frames},
                 {"rate_hz", check.rate_hz},
                 {"gaps", check.gaps},
                 {"longest_gap_s", check.longest_gap_s},
                 {"looked_at", check.sampled},
                 {"unreadable", check.unreadable},
                 {"without_right", check.without_right},
                 {"repeated", check.repeated},
                 {"features", check.features},
                 {"field_of_view_deg", check.field_of_view_deg},
                 {"baseline_m", check.baseline_m},
                 {"times", times_json(check.times)},
                 {"left", camera_json(check.left)},
                 {"right", check.right ? camera_json(*check.right) : Json()},
                 {"pair", check.pair ? pair_json(*check.pair) : Json()},
                 {"findings", Json::array()}}};
  report.row("frames", "{frames} at {rate_hz:.1f} Hz, {gaps} gaps, the longest {longest_gap_s:.2f} s");
  report.row("sampled",
             "{looked_at} frames; {unreadable} unreadable, {without_right} without a right image, {repeated} repeated");
  add_camera("left", check.left, report);
  if (check.right) add_camera("right", *check.right, report);
  // Without features in at least half of the left images, the medians of pairs are meaningless.
  report.row("pair",
             "{?features}{pair.matched_percent:.0f} % of the features matched in the right image, "
             "row error {pair.row_error_px:.2f} px");
  report.row("calibration", "{?features}error about {pair.calibration_error_px:.2f} px (row differences of the pair)");
  report.row("features", "{features:.0f} per image");
  report.row("view", "{field_of_view_deg:.0f} degrees wide");
  report.row("baseline", "{?baseline_m}{baseline_m:.4f} m");
  for (const Finding& finding : findings) {
    report.figures["findings"].push_back(
        {{"grave", finding.is_critical}, {"what", finding.what}, {"remedy", finding.remedy}});
    report.row(finding.is_critical ? "PROBLEM" : "warning", "{what}", {{"what", finding.what}});
    report.row("", "{remedy}", {{"remedy", finding.remedy}});
  }
  report.row("found", "{!findings}no problems");
  report.conclude(
      "[{?critical}Serious problems: {critical}. Solve them first, then check again."
      "|[{?findings}Usable, with warnings: {#findings}.|Fit for mapping.] Next: byre map {recording} -o MAP.byre]",
      {{"critical", std::ranges::count_if(findings, &Finding::is_critical)}});
  return report;
}

Json times_json(const TimeCorrections& times) {
  Json steps = Json::array();
  for (const ClockStep& step : times.clock_steps)
    steps.push_back({{"frame", step.frame}, {"by_s", to_seconds(step.by)}});
  return {{"source", to_string(times.source)},
          {"clock_steps", steps},
          {"late", times.late},
          {"repeated", times.repeated},
          {"unstamped", times.unstamped}};
}

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
