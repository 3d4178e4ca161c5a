#include "mission_case.h"

#include "byre/features/image_threads.h"
#include "byre/slam/system/slam_impl.h"

#include <filesystem>
#include <map>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

// Images of a frame. Caches those of the last recording, because many missions use the same frames.
std::optional<ImageFrame> read_once(const std::filesystem::path& folder, Recording& recording, int frame) {
  constexpr std::size_t kMaxCached = 200;  // pairs; 145 MB at 752x480 pixels
  static std::filesystem::path kept_folder;
  static std::map<Timestamp, std::optional<ImageFrame>> kept;
  if (folder != kept_folder) kept.clear();
  kept_folder = folder;
  const Timestamp time = recording.times()[static_cast<std::size_t>(frame)];
  if (const auto found = kept.find(time); found != kept.end()) return found->second;
  std::optional<ImageFrame> images = recording.read(frame);
  if (kept.size() < kMaxCached) kept.emplace(time, images);
  return images;
}

// Like "byre run": uses the map's refined calibration if the map was made with the calibration given here.
std::vector<MissionFrame> run(const MissionPlan& plan, const MissionCase& mission_case, Recording& recording,
                              std::shared_ptr<const OfflineMap> map) {
  const Imperfection& imperfection = mission_case.imperfection;
  const std::filesystem::path folder = find(mission_case.recording).value();
  const Trajectory truth = truth_of(mission_case.recording);
  limit_image_threads(1);
  const Degradation cameras = imperfect_cameras(imperfection);
  MethodOptions options;
  options.pace = Pace::same_thread;
  SlamImpl slam(nominal_calibration(recording.calibration(), imperfection), options,
                {.vocabulary = mission_vocabulary(), .offline = std::move(map)});
  std::vector<MissionFrame> frames;
  for (const MissionStep& step : plan.steps) {
    const std::optional<ImageFrame> recorded = read_once(folder, recording, step.frame);
    if (!recorded) continue;
    ImageFrame images = cameras(step.disturb ? step.disturb(*recorded) : *recorded, step.frame);
    images.time = step.time;
    frames.push_back({slam.process(images), pose_at(truth, recorded->time, std::chrono::milliseconds(60))});
  }
  return frames;
}

// Alignment by the first pose.
std::optional<Similarity> truth_from_own_map(const std::vector<MissionFrame>& frames) {
  for (const MissionFrame& frame : frames) {
    if (!frame.report.map_from_body || !frame.true_world_from_body) continue;
    return Similarity{1.0, *frame.true_world_from_body * inverse(*frame.report.map_from_body)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<RecordingName> missing_recording(const MissionCase& mission_case) {
  if (!find(mission_case.recording)) return mission_case.recording;
  if (!mission_case.map.is_absent && !find(mission_case.map.recipe.recording)) return mission_case.map.recipe.recording;
  return std::nullopt;
}

MissionCase with_imperfection(MissionCase mission_case, const Imperfection& imperfection) {
  Imperfection& of_map = mission_case.map.recipe.imperfection;
  const std::uint64_t apart = mission_case.imperfection.calibration_seed - of_map.calibration_seed;
  of_map = imperfection;
  mission_case.imperfection.condition = imperfection.condition;
  mission_case.imperfection.calibration_seed = imperfection.calibration_seed + apart;
  return mission_case;
}

AlignedMap MapCache::get(const MapChoice& choice) {
  constexpr std::uint64_t kSeed = 1;
  const std::string name = name_of(choice.recipe);
  if (!maps_.contains(name)) maps_.emplace(name, make_aligned_map(choice.recipe));
  AlignedMap aligned = maps_.at(name);
  if (choice.share_deleted > 0.0) aligned = without_points(aligned, choice.share_deleted, kSeed);
  if (choice.hole) aligned = without_stretch(aligned, from_seconds(choice.hole->start), from_seconds(choice.hole->end));
  return aligned;
}

MissionRun run_mission(const MissionCase& mission_case, MapCache& maps) {
  const bool has_map = !mission_case.map.is_absent;
  const AlignedMap aligned = has_map ? maps.get(mission_case.map) : AlignedMap{};
  const auto recording = open_recording(find(mission_case.recording).value(), mission_case.range);
  MissionPlan plan = mission_case.plan(recording->times());
  if (mission_case.mapped_again_after) {
    plan.undisturbed_from = plan.steps.front().time + from_seconds(*mission_case.mapped_again_after);
  }
  MissionRun mission_run;
  mission_run.frames = run(plan, mission_case, *recording, aligned.map);
  if (!has_map) mission_run.truth_from_map = truth_from_own_map(mission_run.frames);
  if (has_map && !mission_case.map.is_of_another_place) mission_run.truth_from_map = aligned.truth_from_map;
  mission_run.score = score(mission_run.frames, mission_run.truth_from_map, plan.undisturbed_from);
  if (const auto doubt = mission_case.requirements.doubt) {
    mission_run.score.time_to_doubt = time_to_doubt(mission_run.frames, *doubt, plan.disturbed_from());
  }
  return mission_run;
}

std::vector<std::string> unmet_requirements(const MissionCase& mission_case, const MissionScore& score) {
  std::vector<std::string> broken;
  if (mission_case.map.is_of_another_place && score.trusted > 0.0) {
    broken.push_back(
        fmt::format("{:.1f} % of the frames are trusted on the map of another place", 100.0 * score.trusted));
  }
  if (score.longest_wrong_trust > kMaxWrongTrust) {
    broken.push_back(fmt::format("poses with errors above 0.2 m are trusted for {:.2f} s", score.longest_wrong_trust) +
                     fmt::format(", largest error {:.2f} m", score.worst_trusted_error));
  }
  if (mission_case.requirements.is_never_wrong && score.wrongly_trusted > 0) {
    broken.push_back(fmt::format("{} frames with errors above 0.2 m are trusted", score.wrongly_trusted) +
                     fmt::format(", largest error {:.2f} m", score.worst_trusted_error));
  }
  if (mission_case.requirements.doubt && score.time_to_doubt.value_or(1e9) > kMaxTimeToDoubt) {
    broken.push_back("\"" + std::string(to_string(*mission_case.requirements.doubt)) + "\" is reported " +
                     (score.time_to_doubt ? fmt::format("only after {:.2f} s", *score.time_to_doubt) : "never"));
  }
  if (mission_case.requirements.recovers && !score.recovery) broken.emplace_back("trust is never regained");
  if (mission_case.requirements.recovers && score.recovery.value_or(0.0) > kMaxRecovery) {
    broken.push_back(fmt::format("trust is regained only after {:.2f} s", *score.recovery));
  }
  if (score.trusted < mission_case.requirements.min_trusted_share) {
    broken.push_back(fmt::format("only {:.1f} % of the frames are trusted", 100.0 * score.trusted));
  }
  return broken;
}

}  // namespace byre
