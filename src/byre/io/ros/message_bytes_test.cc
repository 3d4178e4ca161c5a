#include "byre/io/ros/message_bytes.h"
#include "byre/input_error.h"
#include "byre/io/ros/message_matchers.h"
#include "byre/io/ros/messages.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre::ros {
namespace {

using Bytes = std::vector<std::byte>;

// Bytes of hexadecimal text with spaces between them.
Bytes bytes_of(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i < hex.size(); i += 3) bytes.push_back(std::byte(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

Header header() {
  return {.stamp = {1, 2}, .frame_id = "map", .seq = 7};
}

Pose pose() {
  return {{1.0, 2.0, 3.0}, {0.1, 0.2, 0.3, 0.9}};
}

template <std::size_t n>
std::array<double, n> counted() {
  std::array<double, n> values{};
  for (std::size_t i = 0; i < n; ++i) values[i] = 0.5 * static_cast<double>(i);
  return values;
}

Odometry odometry() {
  return {header(), "base_link", {pose(), counted<36>()}, {{{1.0, 0.0, 0.0}, {0.0, 0.0, 0.5}}, counted<36>()}};
}

CameraInfo camera_info() {
  return {header(),     480,           752, "plumb_bob", {0.1, 0.2, 0.3, 0.4, 0.5}, counted<9>(),
          counted<9>(), counted<12>(), 1,   2,           {1, 2, 3, 4, true}};
}

DiagnosticArray diagnostics() {
  return {header(), {{DiagnosticStatus::kWarn, "byre", "few points", "camera", {{"points", "12"}, {"fps", "20"}}}, {}}};
}

PointCloud2 cloud() {
  return {header(), 1, 1, {{"x", 0, PointField::kFloat32, 1}, {"y", 4}}, false, 8, 8, {1, 2, 3, 4, 5, 6, 7, 8}, true};
}

OccupancyGrid grid() {
  return {header(), {{5, 6}, 0.05f, 2, 1, pose()}, {-1, 100}};
}

// Calls check with a filled message of each independent type.
template <typename Check>
void for_each_message(Check check) {
  check(String{"hello"});
  check(Image{header(), 2, 3, "mono8", 0, 3, {1, 2, 3, 4, 5, 6}});
  check(CompressedImage{header(), "jpeg", {1, 2, 3}});
  check(camera_info());
  check(Imu{header(), {0.0, 0.0, 0.0, 1.0}, counted<9>(), {1.0, 2.0, 3.0}, counted<9>(), {4.0, 5.0, 6.0}, {}});
  check(cloud());
  check(PoseStamped{header(), pose()});
  check(PoseWithCovarianceStamped{header(), {pose(), counted<36>()}});
  check(TFMessage{{{header(), "odom", {{1.0, 2.0, 3.0}, {}}}, {header(), "base_link", {}}}});
  check(odometry());
  check(Path{header(), {{header(), pose()}, {header(), {}}}});
  check(grid());
  check(diagnostics());
}

TEST(MessageBytes, HaveAByteOrderAndTerminatedStringsInCdr) {
  EXPECT_EQ(write_message(String{"hi"}, Encoding::cdr), bytes_of("00 01 00 00 03 00 00 00 68 69 00"));
  EXPECT_EQ(write_message(String{}, Encoding::cdr), bytes_of("00 01 00 00 01 00 00 00 00"));
}

TEST(MessageBytes, HaveNoTerminatorsAndPaddingInRos1) {
  EXPECT_EQ(write_message(String{"hi"}, Encoding::ros1), bytes_of("02 00 00 00 68 69"));
  EXPECT_EQ(write_message(PointField{"x", 4, 7, 1}, Encoding::ros1),
            bytes_of("01 00 00 00 78 04 00 00 00 07 01 00 00 00"));
}

TEST(MessageBytes, AreAlignedAfterTheCdrHeader) {
  EXPECT_EQ(write_message(PointField{"x", 4, 7, 1}, Encoding::cdr),
            bytes_of("00 01 00 00 02 00 00 00 78 00 00 00 04 00 00 00 07 00 00 00 01 00 00 00"));
  // Time, "m", then a double at offset 16, a multiple of eight.
  const Bytes bytes = write_message(PoseStamped{{{1, 2}, "m"}, {{1.0, 0.0, 0.0}, {}}}, Encoding::cdr);
  const std::string begin = "00 01 00 00 01 00 00 00 02 00 00 00 02 00 00 00 6d 00 00 00 00 00 00 00 00 00 f0 3f";
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 28), bytes_of(begin));
  EXPECT_EQ(bytes.size(), 4u + 16 + 7 * 8);
}

TEST(MessageBytes, ContainTheSequenceNumberInRos1Only) {
  EXPECT_EQ(write_message(header(), Encoding::ros1),
            bytes_of("07 00 00 00 01 00 00 00 02 00 00 00 03 00 00 00 6d 61 70"));
  EXPECT_EQ(write_message(header(), Encoding::cdr),
            bytes_of("00 01 00 00 01 00 00 00 02 00 00 00 04 00 00 00 6d 61 70 00"));
}

TEST(MessageBytes, AreReadInBigEndianOrder) {
  const auto field = read_message<PointField>(
      bytes_of("00 00 00 00 00 00 00 02 78 00 00 00 00 00 00 04 07 00 00 00 00 00 00 09"), Encoding::cdr, "test");
  EXPECT_EQ(field, (PointField{"x", 4, 7, 9}));
  const auto point = read_message<Point>(
      bytes_of("00 00 00 00 3f f0 00 00 00 00 00 00 40 00 00 00 00 00 00 00 bf f0 00 00 00 00 00 00"), Encoding::cdr,
      "test");
  EXPECT_EQ(point, (Point{1.0, 2.0, -1.0}));
}

TEST(MessageBytes, MayLackStringTerminators) {
  EXPECT_EQ(read_message<String>(bytes_of("00 01 00 00 00 00 00 00"), Encoding::cdr, "test").data, "");
  EXPECT_EQ(read_message<String>(bytes_of("00 01 00 00 02 00 00 00 68 69"), Encoding::cdr, "test").data, "hi");
}

TEST(MessageBytes, AreReadAsWritten) {
  for_each_message([]<typename M>(const M& message) {
    EXPECT_EQ(read_message<M>(write_message(message, Encoding::ros1), Encoding::ros1, "test"), message) << M::kType;
    const M from_cdr = read_message<M>(write_message(message, Encoding::cdr), Encoding::cdr, "test");
    EXPECT_EQ(write_message(from_cdr, Encoding::cdr), write_message(message, Encoding::cdr)) << M::kType;
  });
}

TEST(MessageBytes, AreRejectedWhenTruncatedAnywhere) {
  for_each_message([]<typename M>(const M& message) {
    for (const Encoding encoding : {Encoding::cdr, Encoding::ros1}) {
      const Bytes whole = write_message(message, encoding);
      for (std::size_t size = 0; size < whole.size(); ++size) {
        // Exact size, so that sanitizers detect reads beyond.
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_THROW(read_message<M>(cut, encoding, "test"), InputError) << M::kType << " cut to " << size;
      }
    }
  });
}

TEST(MessageBytes, AreRejectedWithLengthsBeyondTheEnd) {
  for_each_message([]<typename M>(const M& message) {
    const Bytes whole = write_message(message, Encoding::ros1);
    for (std::size_t place = 0; place + 4 <= whole.size(); ++place) {  // includes lengths
      Bytes changed = whole;
      std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(place), 4, std::byte{0xFF});
      try {
        read_message<M>(changed, Encoding::ros1, "test");
      } catch (const InputError&) {
      }
    }
  });
  EXPECT_THROW(read_message<TFMessage>(bytes_of("00 01 00 00 ff ff ff ff"), Encoding::cdr, "test"), InputError);
  // A transform takes at least 72 bytes, so these cannot hold two.
  EXPECT_THROW(
      {
        Bytes bytes = bytes_of("02 00 00 00");
        bytes.resize(4 + 2 * 72 - 1);
        read_message<TFMessage>(bytes, Encoding::ros1, "test");
      },
      InputError);
}

TEST(MessageBytes, AreRejectedUnlessPlainCdr) {
  try {
    read_message<String>(bytes_of("00 07 00 00 01 00 00 00 00"), Encoding::cdr, "barn.mcap: /events, message 3");
    FAIL() << "read a later CDR";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("barn.mcap: /events, message 3 at byte 4: is in representation 7"));
  }
}

TEST(MessageBytes, MayBePaddedAtTheirEnd) {
  EXPECT_EQ(read_message<String>(bytes_of("00 01 00 00 03 00 00 00 68 69 00 00"), Encoding::cdr, "test").data, "hi");
}

TEST(MessageTime, ConvertsToNanosecondsAndBack) {
  EXPECT_EQ(to_nanoseconds({1403636579, 763555584}), std::chrono::nanoseconds(1403636579763555584));
  EXPECT_EQ(to_time(std::chrono::nanoseconds(1403636579763555584)), (Time{1403636579, 763555584}));
  EXPECT_EQ(to_time(std::chrono::nanoseconds(-1)), (Time{-1, 999999999}));
  EXPECT_EQ(to_nanoseconds({-1, 999999999}), std::chrono::nanoseconds(-1));
}

TEST(MessageType, IsShorterInRos1) {
  EXPECT_EQ(short_type("sensor_msgs/msg/Image"), "sensor_msgs/Image");
  EXPECT_EQ(short_type("sensor_msgs/Image"), "sensor_msgs/Image");
}

}  // namespace
}  // namespace byre::ros
