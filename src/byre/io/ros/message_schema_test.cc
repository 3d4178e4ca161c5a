#include "byre/io/ros/message_schema.h"

#include "byre/io/ros/message_matchers.h"
#include "byre/io/ros/messages.h"

#include <gmock/gmock.h>

namespace byre::ros {
namespace {

const std::string kLine(80, '=');
const std::string kHeader = "builtin_interfaces/Time stamp\nstring frame_id\n";
const std::string kTime = "int32 sec\nuint32 nanosec\n";

TEST(MessageSchema, NamesEachFieldWithItsType) {
  EXPECT_EQ(message_schema<String>(), "string data\n");
  EXPECT_EQ(message_schema<RegionOfInterest>(),
            "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n");
}

TEST(MessageSchema, AppendsTheDefinitionsOfParts) {
  EXPECT_EQ(message_schema<Image>(),
            "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
            "uint8[] data\n" +
                kLine + "\nMSG: std_msgs/Header\n" + kHeader + kLine + "\nMSG: builtin_interfaces/Time\n" + kTime);
}

TEST(MessageSchema, DefinesEachPartOnce) {
  const std::string pose = "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n";
  EXPECT_EQ(message_schema<Path>(),
            "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n" + kLine + "\nMSG: std_msgs/Header\n" +
                kHeader + kLine + "\nMSG: builtin_interfaces/Time\n" + kTime + kLine +
                "\nMSG: geometry_msgs/PoseStamped\nstd_msgs/Header header\ngeometry_msgs/Pose pose\n" + kLine +
                "\nMSG: geometry_msgs/Pose\n" + pose + kLine +
                "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + kLine +
                "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
}

TEST(MessageSchema, SeparatesArraysFromSequencesAndBytesFromNumbers) {
  EXPECT_THAT(message_schema<CameraInfo>(), testing::HasSubstr("\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n"));
  EXPECT_THAT(message_schema<OccupancyGrid>(), testing::HasSubstr("\nint8[] data\n"));
  EXPECT_THAT(message_schema<DiagnosticArray>(), testing::HasSubstr("\nbyte level\nstring name\n"));
  EXPECT_THAT(message_schema<PointCloud2>(), testing::HasSubstr("uint8 FLOAT64=8\nstring name\nuint32 offset\n"));
}

}  // namespace
}  // namespace byre::ros
