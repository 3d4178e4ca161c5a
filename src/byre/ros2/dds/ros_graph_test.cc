#include "byre/ros2/dds/ros_graph.h"

#include "byre/ros2/dds/ros_network.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

EntityId id_of(std::uint8_t first) {
  EntityId id{};
  for (std::size_t i = 0; i < id.size(); ++i) id[i] = static_cast<std::uint8_t>(first + i);
  return id;
}

std::vector<std::byte> graph_bytes(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

const NodeDescription kNode{"byre", "/", {id_of(32)}, {}};

// Bytes written by hand: encapsulation, id, one node, "/", "byre", one reader, no writer.
TEST(GraphMessage, HasIdsOf16BytesFromIronOn) {
  EXPECT_EQ(graph_message(id_of(1), kNode, RosDistribution::jazzy),
            graph_bytes({0,  1,  0,  0,                                                       // CDR, little-endian
                         1,  2,  3,  4,  5,   6,   7,   8,   9,  10, 11, 12, 13, 14, 15, 16,  // participant
                         1,  0,  0,  0,                                                       // nodes
                         2,  0,  0,  0,  '/', 0,   0,   0,                                    // padded to four
                         5,  0,  0,  0,  'b', 'y', 'r', 'e', 0,  0,  0,  0,                   // padded to four
                         1,  0,  0,  0,                                                       // readers
                         32, 33, 34, 35, 36,  37,  38,  39,  40, 41, 42, 43, 44, 45, 46, 47,  // reader
                         0,  0,  0,  0}));                                                    // writers
}

TEST(GraphMessage, HasIdsOf24BytesUpToHumble) {
  EXPECT_EQ(graph_message(id_of(1), kNode, RosDistribution::humble),
            graph_bytes({0,  1,  0,  0,                                                                               //
                         1,  2,  3,  4,  5,   6,   7,   8,   9,  10, 11, 12, 13, 14, 15, 16, 0, 0, 0, 0, 0, 0, 0, 0,  //
                         1,  0,  0,  0,                                                                               //
                         2,  0,  0,  0,  '/', 0,   0,   0,                                                            //
                         5,  0,  0,  0,  'b', 'y', 'r', 'e', 0,  0,  0,  0,                                           //
                         1,  0,  0,  0,                                                                               //
                         32, 33, 34, 35, 36,  37,  38,  39,  40, 41, 42, 43, 44, 45, 46, 47, 0, 0, 0, 0, 0, 0, 0, 0,  //
                         0,  0,  0,  0}));
}

TEST(TypeHash, ExistsForSentTypesOnly) {
  EXPECT_TRUE(type_hash("sensor_msgs/msg/Image").starts_with("RIHS01_d31d41a9"));
  EXPECT_EQ(type_hash("std_msgs/msg/String").size(), 7u + 64u);
  EXPECT_EQ(type_hash("geometry_msgs/msg/Point"), "");
}

}  // namespace
}  // namespace byre
