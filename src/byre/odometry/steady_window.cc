#include "byre/odometry/steady_window.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kKept = 5s;
constexpr double kUsualGravity = 9.81;  // m/s^2

template <typename Sample>
void keep(const Sample& sample, std::deque<Sample>& samples) {
  if (!samples.empty() && sample.time + kKept < samples.back().time) samples.clear();  // the clock was set back
  if (!samples.empty() && sample.time <= samples.back().time) return;
  samples.push_back(sample);
  while (samples.front().time + kKept < sample.time) samples.pop_front();
}

struct Mean {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double deviation = 0.0;  // root mean square from the mean, all axes together
  double change = 0.0;     // largest distance between the means of the window's thirds
};

// Over the window that ends at a time; empty if samples do not cover it.
template <typename Sample, typename Value>
std::optional<Mean> mean_until(const std::deque<Sample>& samples, Timestamp time, const Value& value) {
  constexpr std::size_t kLeastSamples = 30;
  constexpr Timestamp kLate = 100ms;  // largest age of the last sample
  const auto is_before = [](const Sample& sample, Timestamp when) { return sample.time < when; };
  const auto begin = std::lower_bound(samples.begin(), samples.end(), time - SteadyWindow::kWindow, is_before);
  const auto end = std::lower_bound(begin, samples.end(), time + Timestamp(1), is_before);
  const auto count = static_cast<std::size_t>(end - begin);
  if (begin == samples.begin() || count < kLeastSamples || std::prev(end)->time + kLate < time) return {};
  std::array<Eigen::Vector3d, 3> thirds;
  thirds.fill(Eigen::Vector3d::Zero());
  std::array<double, 3> counts{};
  double squares = 0.0;
  Mean result;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d now = value(*(begin + static_cast<std::ptrdiff_t>(i)));
    thirds[3 * i / count] += now;
    counts[3 * i / count] += 1.0;
    result.mean += now / static_cast<double>(count);
    squares += now.squaredNorm() / static_cast<double>(count);
  }
  for (std::size_t i = 0; i < thirds.size(); ++i) thirds[i] /= counts[i];
  result.deviation = std::sqrt(std::max(0.0, squares - result.mean.squaredNorm()));
  result.change =
      std::max({(thirds[0] - thirds[1]).norm(), (thirds[1] - thirds[2]).norm(), (thirds[0] - thirds[2]).norm()});
  return result;
}

}  // namespace

void SteadyWindow::add(const AngularRate& rate) {
  keep(rate, rates_);
}

void SteadyWindow::add(const Acceleration& acceleration) {
  keep(acceleration, accelerations_);
}

std::optional<SteadyWindow::Steady> SteadyWindow::until(Timestamp time) const {
  constexpr double kMostVibration = 1.0;     // m/s^2
  constexpr double kMostChange = 0.1;        // m/s^2
  constexpr double kMostUnlike = 0.5;        // m/s^2, difference from gravity by scale and bias
  constexpr double kBias = 0.05;             // m/s^2, of a consumer sensor
  constexpr double kMostRateNoise = 0.1;     // radians per second
  constexpr double kMostRateChange = 0.015;  // radians per second
  constexpr double kMostRate = 0.15;         // radians per second, with the bias
  const auto rate = mean_until(rates_, time, [](const AngularRate& sample) { return sample.rate; });
  if (!rate || rate->deviation > kMostRateNoise || rate->change > kMostRateChange || rate->mean.norm() > kMostRate) {
    return {};
  }
  const auto measured =
      mean_until(accelerations_, time, [](const Acceleration& sample) { return sample.acceleration; });
  if (!measured || measured->deviation > kMostVibration || measured->change > kMostChange ||
      std::abs(measured->mean.norm() - kUsualGravity) > kMostUnlike) {
    return {};
  }
  return Steady{measured->mean.normalized(), std::hypot(kBias, measured->change) / kUsualGravity, rate->mean};
}

}  // namespace byre
