#pragma once

#include "byre/base/byte_stream.h"
#include "byre/pose.h"

#include <string>
#include <string_view>

namespace byre {

// Compound values in a map file.

template <typename Number, int Size>
void write_vector(const Eigen::Matrix<Number, Size, 1>& vector, ByteWriter& writer) {
  writer.write_all<Number>({vector.data(), Size});
}
template <typename Vector>
Vector read_vector(ByteReader& reader) {
  Vector vector;
  reader.read_all<typename Vector::Scalar>({vector.data(), static_cast<std::size_t>(vector.size())});
  return vector;
}

// Upper triangle, row by row.
template <int Size>
void write_symmetric(const Eigen::Matrix<double, Size, Size>& matrix, ByteWriter& writer) {
  for (int row = 0; row < Size; ++row) {
    for (int column = row; column < Size; ++column) writer.write(matrix(row, column));
  }
}
template <int Size>
Eigen::Matrix<double, Size, Size> read_symmetric(ByteReader& reader) {
  Eigen::Matrix<double, Size, Size> matrix;
  for (int row = 0; row < Size; ++row) {
    for (int column = row; column < Size; ++column) matrix(row, column) = matrix(column, row) = reader.read<double>();
  }
  return matrix;
}

// Rotation as w, x, y, z, then translation.
inline void write_pose(const Pose& pose, ByteWriter& writer) {
  for (const double value : {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z()}) {
    writer.write(value);
  }
  write_vector(pose.translation, writer);
}
inline Pose read_pose(ByteReader& reader) {
  Pose pose;
  pose.rotation.w() = reader.read<double>();
  pose.rotation.vec() = read_vector<Eigen::Vector3d>(reader);
  pose.translation = read_vector<Eigen::Vector3d>(reader);
  return pose;
}

inline constexpr std::size_t kPoseBytes = 7 * sizeof(double);
template <std::size_t Size>
inline constexpr std::size_t kSymmetricBytes = Size*(Size + 1) / 2 * sizeof(double);

// Value of an enumeration with `count` values, or of bool.
template <typename Enum>
Enum read_enum(ByteReader& reader, int count) {
  const auto value = reader.read<std::uint8_t>();
  if (value >= count) reader.fail("has the invalid value " + std::to_string(value));
  return static_cast<Enum>(value);
}
inline bool read_bool(ByteReader& reader) {
  return read_enum<bool>(reader, 2);
}

inline std::uint32_t read_index(ByteReader& reader, std::size_t size, std::string_view what) {
  const auto index = reader.read<std::uint32_t>();
  if (index >= size) {
    reader.fail("refers to " + std::string(what) + " " + std::to_string(index) + " of " + std::to_string(size));
  }
  return index;
}

// Fails if the value read last has a fault; an empty fault means none.
inline void require_no_fault(const ByteReader& reader, std::string_view fault, std::string_view thing,
                             std::size_t number) {
  if (!fault.empty()) reader.fail(std::string(thing) + " " + std::to_string(number) + " " + std::string(fault));
}

}  // namespace byre
