#include "byre/dataset/motion_files.h"

#include "byre/dataset/recording_index.h"
#include "byre/input/text_file.h"
#include "byre/input_error.h"
#include "byre/trajectory_file.h"

#include <array>

namespace byre {
namespace {

namespace fs = std::filesystem;

// "time_ns, w_x, w_y, w_z, a_x, a_y, a_z"
AngularRate parse_rate(const TextLine& line, const std::string& place) {
  constexpr std::size_t kLeastFields = 4;
  const std::vector<std::string_view> fields = split_fields(line.text);
  if (fields.size() < kLeastFields) {
    throw InputError(place, "has fewer than four fields", "a time in nanoseconds and three rates in rad/s are needed");
  }
  const std::optional<Timestamp> time = parse_nanoseconds(fields[0]);
  if (!time) throw InputError(place, "\"" + std::string(fields[0]) + "\" is not a time in nanoseconds");
  AngularRate rate{*time, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view field = fields[static_cast<std::size_t>(axis) + 1];
    const std::optional<double> number = parse_number(field);
    if (!number) throw InputError(place, "\"" + std::string(field) + "\" is not a number");
    rate.rate[axis] = *number;
  }
  return rate;
}

std::vector<AngularRate> read_rates(const fs::path& path) {
  std::vector<AngularRate> rates;
  for (const TextLine& line : read_lines(path)) {
    const std::string place = place_of(path, line);
    rates.push_back(parse_rate(line, place));
    if (rates.size() > 1 && rates.back().time <= rates[rates.size() - 2].time) {
      throw InputError(place, "the time stamp is not later than the one before it", "sort the lines by time");
    }
  }
  return rates;
}

fs::path rates_of(const fs::path& recording) {
  const auto folder = find_mav_folder(recording);
  const fs::path path = folder.value_or(recording) / "imu0" / "data.csv";
  if (fs::is_regular_file(path)) return path;
  throw InputError(path.string(), "is not there", "leave the gyroscope out, or put what it recorded there");
}

}  // namespace

MotionSamples read_motion(const fs::path& recording, const OpenOptions& options) {
  MotionSamples samples;
  const fs::path beside = recording / "wheel.txt";
  if (options.wheels) {
    samples.wheels = read_trajectory(*options.wheels);
  } else if (options.use_wheels && fs::is_regular_file(beside)) {
    samples.wheels = read_trajectory(beside);
  }
  if (options.use_gyroscope) samples.rates = read_rates(rates_of(recording));
  return samples;
}

}  // namespace byre
