#pragma once

// Shared by soak_test.cc and kill_test.cc: visits to a room, and peer programs of a robot's node.

#include "byre/calibration_file.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_trajectory_scene.h"
#include "byre/slam.h"
#include "node_fixture.h"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace byre::testing_ros2 {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Clock = std::chrono::steady_clock;

inline constexpr Timestamp kFrameTime = 50ms;

inline double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

inline int number_from_environment(const char* name, int default_value) {
  const char* const text = std::getenv(name);
  return text == nullptr ? default_value : std::stoi(text);
}

// Visits to a rendered room, and maps of it, with the smallest images that track well: 188 x 120 pixels.
class Visits {
 public:
  static const Visits& shared() {
    static const Visits visits;
    return visits;
  }

  fs::path calibration() const { return folder_ / "camchain.yaml"; }
  fs::path whole_map() const { return folder_ / "whole.byre"; }  // covers all visits
  fs::path half_map() const { return folder_ / "half.byre"; }    // covers the first half of the visits' course
  std::size_t count() const { return visits_.size(); }
  const std::vector<ImageFrame>& operator[](std::size_t number) const { return visits_[number]; }

 private:
  static constexpr int kFrames = 60;

  Visits() {
    fs::create_directories(folder_);
    std::ofstream(calibration()) << write_calibration(euroc_like_calibration(4));
    const RenderedCameras cameras(euroc_like_calibration(4));
    const std::vector<ImageFrame> seen = visit(cameras, 3.0, 0);
    keep_map(seen, whole_map());
    keep_map({seen.begin(), seen.begin() + kFrames / 2}, half_map());
    for (const double length : {3.0, 2.9, 3.1}) visits_.push_back(visit(cameras, length, 1 + std::ssize(visits_)));
  }
  ~Visits() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  // length: of the figure of eight, metres. Each visit has different noise.
  static std::vector<ImageFrame> visit(const RenderedCameras& cameras, double length, std::ptrdiff_t number) {
    const RenderedRoom room({});
    std::vector<ImageFrame> frames;
    for (const StampedPose& pose :
         figure_eight_trajectory(kFrames, 20.0, length, 0.6, cameras.calibration.body_from_left)) {
      frames.push_back(room.render(cameras, pose.world_from_body, pose.time + number * 1h));
    }
    return frames;
  }

  void keep_map(const std::vector<ImageFrame>& frames, const fs::path& file) const {
    SlamOptions options;
    options.workers = Workers::repeatable;
    Slam slam = Slam::mapping(read_calibration(calibration()), options);
    for (const ImageFrame& frame : frames) slam.process(view_of(frame));
    slam.finish();
    slam.save(file);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node_visits." + std::to_string(getpid()));
  std::vector<std::vector<ImageFrame>> visits_;
};

// Plays a visit forth and back, without jumps, until it cuts to another visit.
class Player {
 public:
  explicit Player(std::uint64_t seed) : random_(seed) {}

  const ImageFrame& next() {
    if (left_-- <= 0) cut();
    const auto& frames = Visits::shared()[visit_];
    if (at_ == 0) step_ = 1;
    if (at_ + 1 == std::ssize(frames)) step_ = -1;
    at_ += step_;
    return frames[static_cast<std::size_t>(at_)];
  }
  int cuts() const { return cuts_; }

 private:
  void cut() {
    const Visits& visits = Visits::shared();
    left_ = std::uniform_int_distribution<int>(300, 1500)(random_);
    visit_ = (visit_ + 1) % visits.count();
    at_ = std::uniform_int_distribution<std::ptrdiff_t>(0, std::ssize(visits[visit_]) - 1)(random_);
    ++cuts_;
  }

  std::mt19937_64 random_;
  std::size_t visit_ = 0;
  std::ptrdiff_t at_ = 0;  // index of the last frame
  std::ptrdiff_t step_ = 1;
  int left_ = 0;  // frames until the next cut
  int cuts_ = 0;
};

// Peer programs of a robot's node.
class NodePeers {
 public:
  explicit NodePeers(int domain) : peer_(domain) {}

  bool is_connected() { return have_discovered_each_other(feed_, events_, command_); }
  void command(const std::string& text) { send_text(command_, text); }
  // The node's answer to a command: done, or failed.
  std::optional<nlohmann::json> answer(const std::string& command, std::chrono::seconds patience = 20s) {
    const std::string part = "\"command\":\"" + command + "\"";
    const auto told =
        events_.find([&](const auto& event) { return event.data().find(part) != std::string::npos; }, patience);
    return told ? std::optional(nlohmann::json::parse(told->data())) : std::nullopt;
  }

  // The node's answer to a frame: its health and, if it has a map pose, its odometry.
  struct Answer {
    bool has_pose = false;
  };
  std::optional<Answer> answer_to(const ImageFrame& frame, Timestamp time) {
    health_.clear();
    odometry_.clear();
    feed_.send(frame, time - frame.time);
    const std::string stamp = "\"time_ns\":" + std::to_string(time.count()) + ",";
    const auto health = health_.find([&](const auto& text) { return text.data().find(stamp) != std::string::npos; });
    if (!health) return std::nullopt;
    const Answer answer{!nlohmann::json::parse(health->data()).at("pose").is_null()};
    if (answer.has_pose &&
        !odometry_.find([&](const auto& odometry) { return time_of(odometry.header().stamp()) == time; })) {
      return std::nullopt;
    }
    return answer;
  }
  void send(const ImageFrame& frame, Timestamp time) { feed_.send(frame, time - frame.time); }
  // Frees the memory of received messages.
  void clear() { events_.clear(); }

 private:
  FastPeer peer_;
  Odometry odometry_{peer_, "rt/byre/odometry", kVolatile};
  Texts health_{peer_, "rt/byre/health", kVolatile};
  Texts events_{peer_, "rt/byre/events", kVolatile};
  CameraFeed feed_{peer_};
  eprosima::fastdds::dds::DataWriter* command_ =
      peer_.writer("rt/byre/command", TypeSupport(new std_msgs::msg::StringPubSubType), kVolatile);
};

inline std::string config(const std::string& slam) {
  return "slam:\n" + slam + "images:\n  reliable: true\n  pair_wait: 0.2\ncalibration:\n  file: " +
         Visits::shared().calibration().string() + "\n";
}

class ByreNodeStaysUp : public testing::Test {
 protected:
  ByreNodeStaysUp() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ByreNodeStaysUp() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node_soak." + std::to_string(getpid()));
  int domain_ = some_domain();
};

}  // namespace byre::testing_ros2
