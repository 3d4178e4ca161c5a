#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// ROS messages used by byre. Each lists its fields once, in wire order, for reading, writing and its definition
// (message_schema.h). Frames, units and signs are those of REP-103 and REP-105.
namespace byre::ros {

// Usually since 1970.
struct Time {
  static constexpr std::string_view kType = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void fields(auto& self, auto& visit) {
    visit("sec", self.sec);
    visit("nanosec", self.nanosec);
  }
  bool operator==(const Time&) const = default;
};

std::chrono::nanoseconds to_nanoseconds(const Time& time);
Time to_time(std::chrono::nanoseconds time);  // seconds are truncated to 32 bits

struct Header {
  static constexpr std::string_view kType = "std_msgs/msg/Header";
  Time stamp{};
  std::string frame_id{};
  std::uint32_t seq = 0;  // message counter, ROS 1 only
  static void fields(auto& self, auto& visit) {
    visit.ros1_only(self.seq);
    visit("stamp", self.stamp);
    visit("frame_id", self.frame_id);
  }
  bool operator==(const Header&) const = default;
};

struct String {
  static constexpr std::string_view kType = "std_msgs/msg/String";
  std::string data{};
  static void fields(auto& self, auto& visit) { visit("data", self.data); }
  bool operator==(const String&) const = default;
};

struct Point {
  static constexpr std::string_view kType = "geometry_msgs/msg/Point";
  double x = 0.0, y = 0.0, z = 0.0;
  static void fields(auto& self, auto& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
  bool operator==(const Point&) const = default;
};

struct Vector3 {
  static constexpr std::string_view kType = "geometry_msgs/msg/Vector3";
  double x = 0.0, y = 0.0, z = 0.0;
  static void fields(auto& self, auto& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
  bool operator==(const Vector3&) const = default;
};

struct Quaternion {
  static constexpr std::string_view kType = "geometry_msgs/msg/Quaternion";
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
  static void fields(auto& self, auto& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
    visit("w", self.w);
  }
  bool operator==(const Quaternion&) const = default;
};

struct Pose {
  static constexpr std::string_view kType = "geometry_msgs/msg/Pose";
  Point position{};
  Quaternion orientation{};
  static void fields(auto& self, auto& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
  }
  bool operator==(const Pose&) const = default;
};

struct PoseStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseStamped";
  Header header{};
  Pose pose{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("pose", self.pose);
  }
  bool operator==(const PoseStamped&) const = default;
};

struct PoseWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose{};
  std::array<double, 36> covariance{};  // x, y, z, then rotations about the parent's fixed axes; row-major
  static void fields(auto& self, auto& visit) {
    visit("pose", self.pose);
    visit("covariance", self.covariance);
  }
  bool operator==(const PoseWithCovariance&) const = default;
};

struct PoseWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header{};
  PoseWithCovariance pose{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("pose", self.pose);
  }
  bool operator==(const PoseWithCovarianceStamped&) const = default;
};

struct Twist {
  static constexpr std::string_view kType = "geometry_msgs/msg/Twist";
  Vector3 linear{};   // m/s
  Vector3 angular{};  // rad/s
  static void fields(auto& self, auto& visit) {
    visit("linear", self.linear);
    visit("angular", self.angular);
  }
  bool operator==(const Twist&) const = default;
};

struct TwistWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist{};
  std::array<double, 36> covariance{};  // linear, then angular; row-major
  static void fields(auto& self, auto& visit) {
    visit("twist", self.twist);
    visit("covariance", self.covariance);
  }
  bool operator==(const TwistWithCovariance&) const = default;
};

struct TwistStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistStamped";
  Header header{};
  Twist twist{};  // motion of the header's frame, in its own axes
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("twist", self.twist);
  }
  bool operator==(const TwistStamped&) const = default;
};

struct TwistWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistWithCovarianceStamped";
  Header header{};
  TwistWithCovariance twist{};  // motion of the header's frame, in its own axes
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("twist", self.twist);
  }
  bool operator==(const TwistWithCovarianceStamped&) const = default;
};

struct Transform {
  static constexpr std::string_view kType = "geometry_msgs/msg/Transform";
  Vector3 translation{};
  Quaternion rotation{};
  static void fields(auto& self, auto& visit) {
    visit("translation", self.translation);
    visit("rotation", self.rotation);
  }
  bool operator==(const Transform&) const = default;
};

// Transform from the child frame to the header's frame.
struct TransformStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TransformStamped";
  Header header{};
  std::string child_frame_id{};
  Transform transform{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("child_frame_id", self.child_frame_id);
    visit("transform", self.transform);
  }
  bool operator==(const TransformStamped&) const = default;
};

struct TFMessage {
  static constexpr std::string_view kType = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms{};
  static void fields(auto& self, auto& visit) { visit("transforms", self.transforms); }
  bool operator==(const TFMessage&) const = default;
};

struct Odometry {
  static constexpr std::string_view kType = "nav_msgs/msg/Odometry";
  Header header{};
  std::string child_frame_id{};
  PoseWithCovariance pose{};    // pose of the child frame in the header's frame
  TwistWithCovariance twist{};  // motion in the child frame
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("child_frame_id", self.child_frame_id);
    visit("pose", self.pose);
    visit("twist", self.twist);
  }
  bool operator==(const Odometry&) const = default;
};

struct Path {
  static constexpr std::string_view kType = "nav_msgs/msg/Path";
  Header header{};
  std::vector<PoseStamped> poses{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("poses", self.poses);
  }
  bool operator==(const Path&) const = default;
};

struct MapMetaData {
  static constexpr std::string_view kType = "nav_msgs/msg/MapMetaData";
  Time map_load_time{};
  float resolution = 0.0f;   // m per cell
  std::uint32_t width = 0;   // cells
  std::uint32_t height = 0;  // cells
  Pose origin{};             // pose of the lower left corner of the first cell
  static void fields(auto& self, auto& visit) {
    visit("map_load_time", self.map_load_time);
    visit("resolution", self.resolution);
    visit("width", self.width);
    visit("height", self.height);
    visit("origin", self.origin);
  }
  bool operator==(const MapMetaData&) const = default;
};

struct OccupancyGrid {
  static constexpr std::string_view kType = "nav_msgs/msg/OccupancyGrid";
  Header header{};
  MapMetaData info{};
  std::vector<std::int8_t> data{};  // rows from the bottom up; 0 free to 100 occupied, -1 unknown
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("info", self.info);
    visit("data", self.data);
  }
  bool operator==(const OccupancyGrid&) const = default;
};

struct Image {
  static constexpr std::string_view kType = "sensor_msgs/msg/Image";
  Header header{};  // exposure time; optical frame of the camera: x right, y down, z forward
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding{};
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  // bytes from one row to the next
  std::vector<std::uint8_t> data{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("encoding", self.encoding);
    visit("is_bigendian", self.is_bigendian);
    visit("step", self.step);
    visit("data", self.data);
  }
  bool operator==(const Image&) const = default;
};

struct CompressedImage {
  static constexpr std::string_view kType = "sensor_msgs/msg/CompressedImage";
  Header header{};
  std::string format{};  // "jpeg", "png", or "bgr8; jpeg compressed bgr8"
  std::vector<std::uint8_t> data{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("format", self.format);
    visit("data", self.data);
  }
  bool operator==(const CompressedImage&) const = default;
};

struct RegionOfInterest {
  static constexpr std::string_view kType = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0, y_offset = 0;  // pixels
  std::uint32_t height = 0, width = 0;       // pixels; both zero: the whole image
  bool do_rectify = false;
  static void fields(auto& self, auto& visit) {
    visit("x_offset", self.x_offset);
    visit("y_offset", self.y_offset);
    visit("height", self.height);
    visit("width", self.width);
    visit("do_rectify", self.do_rectify);
  }
  bool operator==(const RegionOfInterest&) const = default;
};

struct CameraInfo {
  static constexpr std::string_view kType = "sensor_msgs/msg/CameraInfo";
  Header header{};
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model{};
  std::vector<double> d{};     // distortion
  std::array<double, 9> k{};   // intrinsics of the raw image, row-major; all zero: uncalibrated
  std::array<double, 9> r{};   // rotation into the rectified frame
  std::array<double, 12> p{};  // projection of the rectified image; p[3] = -fx * baseline
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("distortion_model", self.distortion_model);
    visit("d", self.d);
    visit("k", self.k);
    visit("r", self.r);
    visit("p", self.p);
    visit("binning_x", self.binning_x);
    visit("binning_y", self.binning_y);
    visit("roi", self.roi);
  }
  bool operator==(const CameraInfo&) const = default;
};

struct Imu {
  static constexpr std::string_view kType = "sensor_msgs/msg/Imu";
  Header header{};
  Quaternion orientation{};
  std::array<double, 9> orientation_covariance{};  // first element -1: no orientation
  Vector3 angular_velocity{};                      // rad/s
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration{};  // m/s^2, including gravity
  std::array<double, 9> linear_acceleration_covariance{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("orientation", self.orientation);
    visit("orientation_covariance", self.orientation_covariance);
    visit("angular_velocity", self.angular_velocity);
    visit("angular_velocity_covariance", self.angular_velocity_covariance);
    visit("linear_acceleration", self.linear_acceleration);
    visit("linear_acceleration_covariance", self.linear_acceleration_covariance);
  }
  bool operator==(const Imu&) const = default;
};

struct PointField {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointField";
  static constexpr std::string_view kConstants =
      "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\n"
      "uint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n";
  static constexpr std::uint8_t kUint8 = 2, kUint32 = 6, kFloat32 = 7;
  std::string name{};
  std::uint32_t offset = 0;  // bytes from the start of the point
  std::uint8_t datatype = kFloat32;
  std::uint32_t count = 1;
  static void fields(auto& self, auto& visit) {
    visit("name", self.name);
    visit("offset", self.offset);
    visit("datatype", self.datatype);
    visit("count", self.count);
  }
  bool operator==(const PointField&) const = default;
};

struct PointCloud2 {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointCloud2";
  Header header{};
  std::uint32_t height = 0;  // 1 for unordered points
  std::uint32_t width = 0;
  std::vector<PointField> point_fields{};  // named "fields" in the definition
  bool is_bigendian = false;
  std::uint32_t point_step = 0;  // bytes
  std::uint32_t row_step = 0;    // bytes
  std::vector<std::uint8_t> data{};
  bool is_dense = false;  // all points are valid
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("fields", self.point_fields);
    visit("is_bigendian", self.is_bigendian);
    visit("point_step", self.point_step);
    visit("row_step", self.row_step);
    visit("data", self.data);
    visit("is_dense", self.is_dense);
  }
  bool operator==(const PointCloud2&) const = default;
};

struct KeyValue {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/KeyValue";
  std::string key{};
  std::string value{};
  static void fields(auto& self, auto& visit) {
    visit("key", self.key);
    visit("value", self.value);
  }
  bool operator==(const KeyValue&) const = default;
};

struct DiagnosticStatus {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::string_view kConstants = "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n";
  static constexpr std::byte kOk{0}, kWarn{1}, kError{2}, kStale{3};
  std::byte level = kOk;
  std::string name{};
  std::string message{};
  std::string hardware_id{};
  std::vector<KeyValue> values{};
  static void fields(auto& self, auto& visit) {
    visit("level", self.level);
    visit("name", self.name);
    visit("message", self.message);
    visit("hardware_id", self.hardware_id);
    visit("values", self.values);
  }
  bool operator==(const DiagnosticStatus&) const = default;
};

struct DiagnosticArray {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
  Header header{};
  std::vector<DiagnosticStatus> status{};
  static void fields(auto& self, auto& visit) {
    visit("header", self.header);
    visit("status", self.status);
  }
  bool operator==(const DiagnosticArray&) const = default;
};

}  // namespace byre::ros
