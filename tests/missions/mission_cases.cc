// Missions that test the session's health: recordings, maps and disturbances.

#include "mission_case.h"

namespace byre {
namespace {

using Plan = std::function<MissionPlan(const std::vector<Timestamp>&)>;

constexpr double kHandCoverage = 0.7;
constexpr double kBlurPixels = 20.0;
constexpr double kExposureFactor = 4.0;
constexpr int kStepsPerExposure = 5;
constexpr double kToTheEnd = 1e6;  // seconds

RecordingName real(const char* name) {
  return {Source::real, name};
}

RecordingName twin(const char* name) {
  return {Source::twin, name};
}

FrameRange frames(int first, int last) {
  FrameRange range;
  range.first = first;
  range.last = last;
  return range;
}

FrameRange seconds(double start, double end) {
  FrameRange range;
  range.start_s = start;
  range.end_s = end;
  return range;
}

Plan degrade(const Span& span, const Degradation& degradation) {
  return [=](const std::vector<Timestamp>& times) { return degraded(times, span, degradation); };
}

Plan degrade_all(const Degradation& degradation) {
  return [=](const std::vector<Timestamp>& times) {
    MissionPlan plan = degraded(times, {0.0, kToTheEnd}, degradation);
    plan.undisturbed_from = times.front();
    return plan;
  };
}

Plan kidnap(const Span& before, const Span& after, double dark_seconds) {
  return [=](const std::vector<Timestamp>& times) { return kidnapped(times, before, after, dark_seconds); };
}

struct NamedPlan {
  const char* name;
  Plan plan;
};

// Disturbances during a span that apply to any recording.
std::vector<NamedPlan> passing_disturbances(const Span& span) {
  return {{"black", degrade(span, black_frames())},
          {"hand", degrade(span, hand_over_the_lens(kHandCoverage))},
          {"blur", degrade(span, motion_blur(kBlurPixels))},
          {"exposure", degrade(span, exposure_jumps(kExposureFactor, kStepsPerExposure))},
          {"blank_wall", degrade(span, blank_close_up())}};
}

// The hall's truth is late by about 7.5 ms.
const MapRecipe kHall{{Source::real, "euroc/MH_01_easy", std::chrono::microseconds(-7500)}, frames(0, 150)};
const MapRecipe kRealRoom{real("euroc/V1_01_easy_sparse"), {}, true};
const MapRecipe kTwinRoom{twin("V1_01_easy")};
const MapRecipe kTwinShed{twin("cowshed_m1"), frames(0, 1320)};  // the way out and the turn at its end

MissionCase in_hall(const char* name, const FrameRange& range, const Plan& plan) {
  return {std::string("hall_") + name, kHall.recording, range, {kHall}, plan};
}

MissionCase in_room(const char* name, const FrameRange& range, const Plan& plan) {
  return {std::string("room_") + name, twin("V1_02_medium"), range, {kTwinRoom}, plan};
}

MissionCase in_shed(const char* name, const FrameRange& range, const Plan& plan) {
  return {std::string("shed_") + name, twin("cowshed_m2"), range, {kTwinShed}, plan};
}

MissionCase with_map(MissionCase mission_case, const MapChoice& map) {
  mission_case.map = map;
  return mission_case;
}

MissionCase with_requirements(MissionCase mission_case, const Requirements& requirements) {
  mission_case.requirements = requirements;
  return mission_case;
}

MissionCase of_recording(MissionCase mission_case, const RecordingName& recording) {
  mission_case.recording = recording;
  return mission_case;
}

MissionCase only_in_long_runs(MissionCase mission_case) {
  mission_case.is_long_run = true;
  return mission_case;
}

MissionCase named(MissionCase mission_case, const char* name) {
  mission_case.name = name;
  return mission_case;
}

MapChoice wrong(const MapRecipe& recipe) {
  MapChoice choice{recipe};
  choice.is_of_another_place = true;
  return choice;
}

constexpr Requirements kHardlyDisturbed{true, 0.98};
constexpr Requirements kNeverWrongOnly{false, 0.0};

constexpr Imperfection kExact{CameraCondition::exact, 1};
constexpr Imperfection kOtherError{CameraCondition::good, 2};

// Cases in which map and mission do not share one good camera.
std::vector<MissionCase> calibrated_otherwise() {
  const MissionCase undisturbed =
      with_requirements(in_hall("undisturbed", frames(150, 300), as_recorded), kHardlyDisturbed);
  MissionCase recalibrated = named(undisturbed, "hall_recalibrated");
  recalibrated.imperfection = kOtherError;
  return {only_in_long_runs(named(with_imperfection(undisturbed, kExact), "hall_undisturbed_exact")), recalibrated};
}

}  // namespace

// Missions on the second half of the flight, or the necessary part of it, and on the map of the first half. The map
// covers all of the second half.
std::vector<MissionCase> real_mission_cases() {
  const FrameRange whole = frames(150, 300), six_seconds = frames(150, 270), four_seconds = frames(150, 230);
  std::vector<MissionCase> cases = {with_requirements(in_hall("undisturbed", whole, as_recorded), kHardlyDisturbed)};
  for (const NamedPlan& disturbance : passing_disturbances({1.5, 3.5})) {
    cases.push_back(in_hall(disturbance.name, six_seconds, disturbance.plan));
  }
  cases.push_back(in_hall("kidnapped", whole, kidnap({0.0, 2.5}, {4.5, 7.5}, 0.0)));
  cases.push_back(in_hall("kidnapped_in_the_dark", whole, kidnap({0.0, 3.0}, {4.5, 7.5}, 0.5)));
  cases.push_back(only_in_long_runs(in_hall("haze", four_seconds, degrade_all(haze(0.4)))));
  cases.push_back(in_hall("dirt", four_seconds, degrade_all(dirt(40))));
  cases.push_back(in_hall("contrast_loss", four_seconds, degrade_all(contrast_loss(0.3))));
  cases.push_back(with_map(in_hall("half_the_points", whole, as_recorded), {kHall, 0.5}));
  cases.push_back(
      with_requirements(with_map(in_hall("wrong_map", six_seconds, as_recorded), wrong(kRealRoom)), kNeverWrongOnly));
  for (const MissionCase& other : calibrated_otherwise()) cases.push_back(other);
  return cases;
}

namespace {

std::vector<MissionCase> room_cases() {
  const FrameRange eight_seconds = seconds(11.0, 19.0);
  std::vector<MissionCase> cases = {
      with_requirements(in_room("undisturbed", eight_seconds, as_recorded), kHardlyDisturbed)};
  for (const NamedPlan& disturbance : passing_disturbances({2.0, 4.0})) {
    cases.push_back(only_in_long_runs(in_room(disturbance.name, eight_seconds, disturbance.plan)));
  }
  // From one end of the room to the other.
  const FrameRange both_ends = seconds(15.0, 51.0);
  cases.push_back(only_in_long_runs(in_room("kidnapped", both_ends, kidnap({0.0, 4.0}, {32.0, 36.0}, 0.0))));
  cases.push_back(in_room("kidnapped_in_the_dark", both_ends, kidnap({0.0, 4.0}, {32.0, 36.0}, 1.0)));
  cases.push_back(
      only_in_long_runs(with_map(in_room("half_the_points", eight_seconds, as_recorded), {kTwinRoom, 0.5})));
  cases.push_back(
      with_requirements(with_map(in_room("wrong_map", eight_seconds, as_recorded), wrong(kTwinShed)), kNeverWrongOnly));
  cases.push_back(with_requirements(
      of_recording(in_room("fast_flight", seconds(5.0, 30.0), as_recorded), twin("V1_03_difficult")), kNeverWrongOnly));
  return cases;
}

// Drives beyond the turn of mission 1, outside the map; and through a stretch removed from the map.
std::vector<MissionCase> detours() {
  MissionCase beyond = in_shed("detour", seconds(50.0, 101.0), as_recorded);
  beyond.mapped_again_after = 46.0;
  MissionCase hole =
      with_map(in_shed("hole_in_the_map", seconds(17.0, 52.0), as_recorded), {kTwinShed, 0.0, Span{22.0, 42.0}});
  hole.mapped_again_after = 27.0;
  return {beyond, hole};
}

std::vector<MissionCase> shed_cases() {
  const FrameRange eight_seconds = seconds(21.0, 29.0);
  std::vector<MissionCase> cases = {
      only_in_long_runs(in_shed("black", eight_seconds, degrade({2.0, 4.0}, black_frames())))};
  // Along the fence, with strong perceptual aliasing.
  const FrameRange along_fence = seconds(6.0, 40.0);
  cases.push_back(in_shed("kidnapped", along_fence, kidnap({0.0, 4.0}, {28.0, 32.0}, 0.0)));
  cases.push_back(
      only_in_long_runs(in_shed("kidnapped_in_the_dark", along_fence, kidnap({0.0, 4.0}, {28.0, 32.0}, 1.0))));
  cases.push_back(
      with_requirements(with_map(in_shed("wrong_map", eight_seconds, as_recorded), wrong(kTwinRoom)), kNeverWrongOnly));
  for (const MissionCase& detour : detours()) cases.push_back(detour);
  for (const char* condition : {"dirt", "haze", "flat"}) {
    const std::string recording = std::string("cowshed_m2_") + condition;
    cases.push_back(of_recording(in_shed(condition, seconds(0.0, 10.0), as_recorded), twin(recording.c_str())));
  }
  return cases;
}

}  // namespace

std::vector<MissionCase> twin_mission_cases() {
  std::vector<MissionCase> cases = room_cases();
  for (const MissionCase& in_shed : shed_cases()) cases.push_back(in_shed);
  return cases;
}

namespace {

// A sensor fault and the doubt expected for it.
struct SensorFault {
  const char* name;
  Plan plan;
  std::optional<DistrustReason> doubt;
  double focal_factor = 1.0;
  bool is_variant = false;  // varies another fault of the list: only in the long suite
};

SensorFault variant(SensorFault fault) {
  fault.is_variant = true;
  return fault;
}

Plan stuttering(int times_each) {
  return [=](const std::vector<Timestamp>& times) { return repeated(times, times_each); };
}

Plan dropping(int kept_every) {
  return [=](const std::vector<Timestamp>& times) { return dropped(times, kept_every); };
}

Plan clock_jumping(const Span& span, double jump_seconds) {
  return [=](const std::vector<Timestamp>& times) { return late(times, span, jump_seconds); };
}

// frozen lasts for two seconds only, because recovery is tested as well.
std::vector<SensorFault> sensor_faults() {
  const auto always = [](const Degradation& degradation) { return degrade_all(degradation); };
  return {{"frozen", degrade({1.5, 3.5}, frozen()), DistrustReason::frozen},
          variant({"frozen_with_noise_1", degrade({1.5, 3.5}, frozen(1.0)), {}}),
          {"frozen_with_noise_2", degrade({1.5, 3.5}, frozen(2.0)), {}},
          variant({"frozen_with_noise_4", degrade({1.5, 3.5}, frozen(4.0)), {}}),
          {"right_dead", degrade({1.5, 3.5}, right_exposed(0.0)), DistrustReason::right_camera},
          variant({"right_half_as_bright", always(right_exposed(0.5)), {}}),
          {"right_third_as_bright", always(right_exposed(1.0 / 3.0)), {}},
          {"right_noisy", degrade({1.5, 3.5}, right_noisy(80.0)), {}},
          {"right_late", degrade({1.5, 3.5}, right_late(1)), {}},
          variant({"right_late_by_2", degrade({1.5, 3.5}, right_late(2)), {}}),
          {"left_late_by_1", degrade({1.5, 3.5}, left_late(1)), {}},
          variant({"left_late_by_2", degrade({1.5, 3.5}, left_late(2)), {}}),
          {"right_always_late", always(right_late(1)), {}},
          variant({"left_always_late", always(left_late(1)), {}}),
          {"swapped", always(swapped()), DistrustReason::cameras_disagree},
          {"mirrored", always(mirrored()), {}},
          {"upside_down", always(upside_down()), DistrustReason::cameras_disagree},
          {"frames_twice", stuttering(2), {}},
          {"frames_dropped", dropping(4), {}},
          {"clock_jump", clock_jumping({2.0, kToTheEnd}, 5.0), {}},
          variant({"focal_5_percent_long", as_recorded, DistrustReason::calibration, 1.05}),
          {"focal_10_percent_long", as_recorded, DistrustReason::calibration, 1.1},
          variant({"focal_20_percent_long", as_recorded, DistrustReason::calibration, 1.2}),
          {"focal_10_percent_short", as_recorded, DistrustReason::calibration, 0.9}};
}

MissionCase without_map(MissionCase mission_case) {
  mission_case.name += "plain_";
  mission_case.map.is_absent = true;
  return mission_case;
}

// Without map points a wrong focal length cannot be detected immediately. The default suite has each kind of fault in
// the hall, on its map, and without a map those with an expected doubt.
MissionCase with_fault(MissionCase mission_case, const SensorFault& fault) {
  mission_case.name += std::string("lie_") + fault.name;
  mission_case.plan = fault.plan;
  mission_case.imperfection.focal_factor = fault.focal_factor;
  const bool has_map = !mission_case.map.is_absent;
  mission_case.requirements = {.recovers = false, .is_never_wrong = has_map, .doubt = fault.doubt};
  if (!has_map && fault.doubt == DistrustReason::calibration) mission_case.requirements.doubt.reset();
  mission_case.is_long_run |= fault.is_variant || (!has_map && !mission_case.requirements.doubt);
  return mission_case;
}

}  // namespace

std::vector<MissionCase> sensor_fault_cases() {
  std::vector<MissionCase> cases;
  for (const SensorFault& fault : sensor_faults()) {
    for (const MissionCase& fault_free : {in_hall("", frames(150, 250), as_recorded),
                                          only_in_long_runs(in_room("", seconds(25.0, 33.0), as_recorded))}) {
      cases.push_back(with_fault(fault_free, fault));
      cases.push_back(with_fault(without_map(fault_free), fault));
    }
  }
  return cases;
}

}  // namespace byre
