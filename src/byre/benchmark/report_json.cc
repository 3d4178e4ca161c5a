#include "byre/benchmark/report.h"
#include "byre/playback/report/report.h"

#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

template <typename Measures>
Json figures_json(const Measures& figures, std::span<const Measure<Measures>> measures) {
  Json json;
  for (const Measure<Measures>& measure : measures) {
    const Figure figure = figures.*measure.figure;
    json[measure.key] = figure ? Json(*figure) : Json();
  }
  return json;
}

template <typename Measures>
Json summaries_json(const std::vector<RunMeasures>& runs, Measures RunMeasures::*part,
                    std::span<const Measure<Measures>> measures) {
  std::vector<Measures> parts;
  for (const RunMeasures& run : runs) parts.push_back(run.*part);
  Json json;
  for (const Measure<Measures>& measure : measures) {
    const std::optional<RunSummary> summary = summarise_runs(parts, measure);
    json[measure.key] = summary ? Json{{"mean", summary->mean},
                                       {"median", summary->median},
                                       {"worst", summary->worst},
                                       {"runs", summary->runs}}
                                : Json();
  }
  return json;
}

Json run_json(const BenchmarkRunResult& run) {
  const RunMeasures& measures = run.measures;
  return {{"seed", run.seed},
          {"final", figures_json(measures.final_poses, trajectory_measures())},
          {"causal", figures_json(measures.causal_poses, trajectory_measures())},
          {"behaviour", figures_json(measures.behaviour, behaviour_measures())},
          {"cost", figures_json(measures.cost, cost_measures())},
          {"warnings", run.warnings}};
}

Json arm_json(const ArmResult& arm) {
  const std::vector<RunMeasures> runs = arm.measures();
  Json json = {{"arm", name_of(arm.arm)},
               {"summary",
                {{"final", summaries_json(runs, &RunMeasures::final_poses, trajectory_measures())},
                 {"causal", summaries_json(runs, &RunMeasures::causal_poses, trajectory_measures())},
                 {"behaviour", summaries_json(runs, &RunMeasures::behaviour, behaviour_measures())},
                 {"cost", summaries_json(runs, &RunMeasures::cost, cost_measures())}}}};
  json["runs"] = Json::array();
  for (const BenchmarkRunResult& run : arm.runs) json["runs"].push_back(run_json(run));
  return json;
}

Json published_json(const std::string& case_name, const BenchmarkProtocol& protocol) {
  Json json = Json::array();
  for (const PublishedFigures& published : protocol.published) {
    const auto found = published.of_case.find(case_name);
    if (found == published.of_case.end()) continue;
    json.push_back({{"name", published.name},
                    {"note", published.note},
                    {"final", figures_json(found->second, trajectory_measures())}});
  }
  return json;
}

Json case_json(const CaseResult& result, const BenchmarkProtocol& protocol) {
  Json json = {{"name", result.what.name},
               {"recording", result.what.recording},
               {"camera", to_string(result.camera)},
               {"map", result.what.map ? Json(*result.what.map) : Json()}};
  json["arms"] = Json::array();
  for (const ArmResult& arm : result.arms) json["arms"].push_back(arm_json(arm));
  json["published"] = published_json(result.what.name, protocol);
  return json;
}

Json map_json(const BuiltMap& map) {
  const Pose& truth_from_map = map.alignment.truth_from_map.target_from_source;
  return {{"recording", map.recording},
          {"file", map.file.string()},
          {"keyframes", map.keyframes},
          {"points", map.points},
          {"alignment_poses", map.alignment.poses},
          {"truth_from_map_translation_m", list_json(truth_from_map.translation)},
          {"truth_from_map_quaternion_xyzw", list_json(truth_from_map.rotation.coeffs())},
          {"wall_s", map.wall_seconds}};
}

Json protocol_json(const BenchmarkProtocol& protocol, const BenchmarkSetting& setting) {
  Json changed = Json::object();
  for (const auto& [name, value] : setting.changed_options) changed[name] = value;
  Json seeds = Json::array();
  for (int i = 0; i < protocol.runs; ++i) seeds.push_back(protocol.seed_of_run(i));
  return {{"program", "byre benchmark"},
          {"version", BYRE_VERSION},
          {"file", setting.protocol_file},
          {"title", protocol.title},
          {"data", setting.data},
          {"pace", name_of(setting.pace)},
          {"cores", setting.cores},
          {"changed_options", changed},
          {"runs", protocol.runs},
          {"seeds", seeds},
          {"ate_alignment", "SE(3) of each run (Umeyama)"},
          {"map_error_alignment", "none of the run; the map once, by its own keyframes"}};
}

}  // namespace

std::string to_json(const BenchmarkResult& result, const BenchmarkProtocol& protocol, const BenchmarkSetting& setting) {
  Json json = {{"protocol", protocol_json(protocol, setting)}, {"stopped_early", result.stopped}};
  json["maps"] = Json::array();
  for (const BuiltMap& map : result.maps) json["maps"].push_back(map_json(map));
  json["cases"] = Json::array();
  for (const CaseResult& one : result.cases) json["cases"].push_back(case_json(one, protocol));
  json["skipped"] = Json::array();
  for (const SkippedCase& skipped : result.skipped) {
    json["skipped"].push_back({{"name", skipped.name}, {"reason", skipped.reason}});
  }
  return dump_json(json, 2) + "\n";
}

}  // namespace byre
