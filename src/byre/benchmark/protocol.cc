#include "byre/benchmark/protocol.h"

#include "byre/base/data_file.h"
#include "byre/base/enum_names.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/yaml_mapping.h"
#include "byre/io/recording/frame_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::array kArms = {Arm::no_map, Arm::localise_only, Arm::hybrid};
constexpr double kLargestOffset = 1e6;  // seconds

template <typename Range, typename NameOf>
std::string listed(const Range& range, NameOf name) {
  std::string text;
  for (const auto& entry : range) text += (text.empty() ? "" : ", ") + std::string(name(entry));
  return text;
}

Arm read_arm(const YamlValue& value) {
  const std::string text = value.text();
  const auto* const arm = std::ranges::find(kArms, text, [](Arm candidate) { return name_of(candidate); });
  if (arm != kArms.end()) return *arm;
  value.fail("\"" + text + "\" is not an arm", "use " + listed(kArms, [](Arm known) { return name_of(known); }));
}

FrameRange read_frames(const YamlValue& value) {
  const std::optional<FrameRange> range = parse_frames(value.text());
  if (!range)
    value.fail("\"" + value.text() + "\" is not a range of frames", "write it as \"0:150\", the end exclusive");
  return *range;
}

CameraChoice read_camera(const YamlValue& value) {
  const std::optional<CameraChoice> camera = parse_camera(value.text());
  if (!camera) value.fail("\"" + value.text() + "\" is not a choice of cameras", "use stereo, left, right or rgbd");
  return *camera;
}

OpenOptions read_open_options(const YamlValue& recording) {
  OpenOptions options;
  if (const auto camera = recording.find("camera")) options.camera = read_camera(*camera);
  if (const auto calibration = recording.find("calibration")) options.calibration = calibration->text();
  if (const auto topic = recording.find("left")) options.left_topic = topic->text();
  if (const auto topic = recording.find("right")) options.right_topic = topic->text();
  if (const auto rate = recording.find("fps")) {
    options.frame_rate_hz = rate->number(kLowestFrameRate, kHighestFrameRate);
  }
  return options;
}

BenchmarkRecording read_recording(const YamlValue& value) {
  value.require_fields(
      {"name", "folder", "frames", "camera", "calibration", "fps", "left", "right", "truth", "truth_offset_s"});
  BenchmarkRecording recording;
  recording.name = value["name"].text();
  recording.folder = value["folder"].text();
  if (const auto frames = value.find("frames")) recording.range = read_frames(*frames);
  recording.open = read_open_options(value);
  if (const auto truth = value.find("truth")) recording.truth = truth->text();
  if (const auto offset = value.find("truth_offset_s")) {
    recording.truth_offset = from_seconds(offset->number(-kLargestOffset, kLargestOffset));
  }
  return recording;
}

std::vector<Arm> read_arms(const YamlValue& value) {
  std::vector<Arm> arms;
  for (const YamlValue& entry : value.entries()) {
    const Arm arm = read_arm(entry);
    if (std::ranges::count(arms, arm) > 0) entry.fail("the arm is given twice", "give it once");
    arms.push_back(arm);
  }
  return arms;
}

void require_map_for(const BenchmarkCase& benchmark_case, const YamlValue& value) {
  const bool needs_map = std::ranges::any_of(benchmark_case.arms, [](Arm arm) { return arm != Arm::no_map; });
  if (needs_map && !benchmark_case.map) {
    value.fail("localise_only and hybrid need a map", "give the recording for the map (map: mh_01)");
  }
}

BenchmarkCase read_case(const YamlValue& value, const BenchmarkProtocol& protocol) {
  value.require_fields({"name", "recording", "map", "arms"});
  const auto declared = [&protocol](const YamlValue& name) {
    if (std::ranges::count(protocol.recordings, name.text(), &BenchmarkRecording::name) > 0) return name.text();
    name.fail("the recording \"" + name.text() + "\" is not declared",
              "the protocol has " + listed(protocol.recordings, [](const auto& recording) { return recording.name; }));
  };
  BenchmarkCase result;
  result.name = value["name"].text();
  result.recording = declared(value["recording"]);
  if (const auto map = value.find("map")) result.map = declared(*map);
  result.arms = result.map ? std::vector<Arm>(kArms.begin(), kArms.end()) : std::vector<Arm>{Arm::no_map};
  if (const auto arms = value.find("arms")) result.arms = read_arms(*arms);
  require_map_for(result, value);
  return result;
}

TrajectoryMeasures read_figures(const YamlValue& value) {
  using Known = Measure<TrajectoryMeasures>;
  constexpr double kLargestFigure = 1e6;
  TrajectoryMeasures figures;
  for (const auto& [key, figure] : value.fields()) {
    const auto known = std::ranges::find(trajectory_measures(), key.text(), &Known::key);
    if (known == trajectory_measures().end()) {
      key.fail("\"" + key.text() + "\" is not a figure",
               "use " + listed(trajectory_measures(), [](const Known& measure) { return measure.key; }));
    }
    figures.*known->figure = figure.number(0.0, kLargestFigure);
  }
  return figures;
}

PublishedFigures read_published(const YamlValue& value, const BenchmarkProtocol& protocol) {
  value.require_fields({"name", "note", "cases"});
  PublishedFigures published;
  published.name = value["name"].text();
  if (const auto note = value.find("note")) published.note = note->text();
  for (const auto& [name, figures] : value["cases"].fields()) {
    if (std::ranges::count(protocol.cases, name.text(), &BenchmarkCase::name) == 0) {
      name.fail("unknown case \"" + name.text() + "\"", "declare it under cases, or remove its figures");
    }
    published.of_case[name.text()] = read_figures(figures);
  }
  return published;
}

// Reads each entry of a list by read(entry); names must differ.
template <typename Read>
auto read_named(const YamlValue& list, Read read) {
  std::vector<decltype(read(list))> result;
  std::set<std::string> names;
  for (const YamlValue& entry : list.entries()) {
    result.push_back(read(entry));
    if (!names.insert(result.back().name).second) entry.fail("the name is used twice", "choose another");
  }
  return result;
}

void read_runs(const YamlValue& root, BenchmarkProtocol& protocol) {
  constexpr int kMaxRuns = 1000, kLargestSeed = 1'000'000'000;
  if (const auto runs = root.find("runs")) protocol.runs = runs->whole_number(1, kMaxRuns);
  const auto seeds = root.find("seeds");
  if (!seeds) return;
  for (const YamlValue& seed : seeds->entries()) {
    protocol.seeds.push_back(static_cast<std::uint64_t>(seed.whole_number(0, kLargestSeed)));
  }
}

}  // namespace

namespace fs = std::filesystem;

YamlValue YamlValue::load(const fs::path& path) {
  return {path, load_yaml_mapping(path)};
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty()) fail("is not a text", "give a word or a quoted text");
  return node_.Scalar();
}

double YamlValue::number(double min_value, double max_value) const {
  const std::optional<double> value = node_.IsScalar() ? parse_number(node_.Scalar()) : std::nullopt;
  if (value && *value >= min_value && *value <= max_value) return *value;
  fail(fmt::format("is not a number from {:g} to {:g}", min_value, max_value), "give a number in this range");
}

int YamlValue::whole_number(int min_value, int max_value) const {
  const double value = number(min_value, max_value);
  if (value != std::floor(value)) fail("is not an integer", "give a number without fraction");
  return static_cast<int>(value);
}

std::vector<YamlValue> YamlValue::entries() const {
  if (!node_.IsSequence() || node_.size() == 0) fail("is not a list, or is empty", "give at least one entry");
  std::vector<YamlValue> entries;
  for (const YAML::Node& entry : node_) entries.push_back({path_, entry});
  return entries;
}

std::vector<std::pair<YamlValue, YamlValue>> YamlValue::fields() const {
  if (!node_.IsMap()) fail("is not a mapping", "give fields as \"name: value\"");
  std::vector<std::pair<YamlValue, YamlValue>> fields;
  for (const auto& field : node_) fields.push_back({YamlValue(path_, field.first), YamlValue(path_, field.second)});
  return fields;
}

YamlValue YamlValue::operator[](const std::string& name) const {
  const std::optional<YamlValue> value = find(name);
  if (!value) fail("\"" + name + "\" is missing", "add it");
  return *value;
}

std::optional<YamlValue> YamlValue::find(const std::string& name) const {
  const YAML::Node value = node_[name];
  if (!value) return std::nullopt;
  return YamlValue(path_, value);
}

void YamlValue::require_fields(std::initializer_list<std::string_view> names) const {
  std::set<std::string> seen;
  for (const auto& [name, value] : fields()) {
    const std::string text = name.text();
    if (std::ranges::find(names, text) == names.end()) {
      std::string known;
      for (const std::string_view candidate : names) known += (known.empty() ? "" : ", ") + std::string(candidate);
      name.fail("unknown field \"" + text + "\"", "fields: " + known);
    }
    if (!seen.insert(text).second) name.fail("\"" + text + "\" is given twice", "give it once");
  }
}

void YamlValue::fail(const std::string& reason, const std::string& remedy) const {
  throw InputError(path_.string() + ":" + std::to_string(node_.Mark().line + 1), reason, remedy);
}

std::string_view name_of(Arm arm) {
  return name_among<Arm::hybrid>({"no_map", "localise_only", "hybrid"}, arm);
}

const BenchmarkRecording& BenchmarkProtocol::recording(const std::string& recording_name) const {
  return *std::ranges::find(recordings, recording_name, &BenchmarkRecording::name);
}

std::uint64_t BenchmarkProtocol::seed_of_run(int run) const {
  const auto index = static_cast<std::size_t>(run);
  if (seeds.empty()) return index;
  return index < seeds.size() ? seeds[index] : seeds.back() + (index - seeds.size() + 1);
}

fs::path find_benchmark_protocol(const std::string& file_or_name) {
  const fs::path path = file_or_name;
  if (path.has_extension() || path.has_parent_path() || fs::is_regular_file(path)) return path;
  return find_data_file(fs::path("protocols") / (file_or_name + ".yaml"),
                        "give a file or a built-in protocol: euroc, twin or mh_short");
}

BenchmarkProtocol read_benchmark_protocol(const fs::path& path) {
  const YamlValue root = YamlValue::load(path);
  root.require_fields({"title", "about", "runs", "seeds", "recordings", "cases", "published"});
  BenchmarkProtocol protocol;
  protocol.name = path.stem().string();
  protocol.title = protocol.name;
  if (const auto title = root.find("title")) protocol.title = title->text();
  if (const auto about = root.find("about")) protocol.about = about->text();
  read_runs(root, protocol);
  protocol.recordings = read_named(root["recordings"], read_recording);
  protocol.cases =
      read_named(root["cases"], [&protocol](const YamlValue& entry) { return read_case(entry, protocol); });
  if (const auto published = root.find("published")) {
    protocol.published =
        read_named(*published, [&protocol](const YamlValue& entry) { return read_published(entry, protocol); });
  }
  return protocol;
}

}  // namespace byre
