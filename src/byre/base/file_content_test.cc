#include "byre/base/file_content.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

std::optional<FileContent> content_of_bytes(const std::string& bytes) {
  const fs::path file = fs::path(testing::TempDir()) / ("byre_content." + std::to_string(getpid()));
  std::ofstream(file, std::ios::binary) << bytes;
  const std::optional<FileContent> content = content_of(file);
  fs::remove(file);
  return content;
}

TEST(ContentOf, RecognisesByreFiles) {
  EXPECT_EQ(content_of_bytes("\x89"
                             "BYRE\r\n\x1a"),
            FileContent::map);
  EXPECT_EQ(content_of_bytes("byrevoc\n"), FileContent::vocabulary);
  EXPECT_EQ(content_of_bytes("\x89PNG\r\n\x1a\n"), FileContent::png);
  EXPECT_EQ(content_of_bytes(std::string("\0\0\0 ftypisom", 12)), FileContent::video);
  EXPECT_EQ(content_of_bytes("\x89MCAP0\r\n\x01"), FileContent::mcap);
  EXPECT_EQ(content_of_bytes("P5\n3 2\n255\n"), FileContent::pgm);
  EXPECT_EQ(content_of_bytes("ply\nformat binary_little_endian 1.0\n"), FileContent::point_cloud);
  EXPECT_EQ(content_of_bytes("<?xml version=\"1.0\"?>\n<svg width=\"1\">"), FileContent::svg);
  EXPECT_EQ(content_of_bytes("{\"time_s\": 1}\n{}"), FileContent::json);
  EXPECT_EQ(content_of_bytes("# timestamp tx ty tz qx qy qz qw\n1.5 0 0 0 0 0 0 1\n"), FileContent::trajectory);
  EXPECT_EQ(content_of_bytes("# timestamp tx ty tz qx qy qz qw\n"), FileContent::trajectory);
  EXPECT_EQ(content_of_bytes("cam0:\n  rostopic: /a\n"), FileContent::yaml);
  EXPECT_EQ(content_of_bytes("name,point,plan_x_m,plan_y_m\n"), FileContent::table);
  EXPECT_EQ(content_of_bytes(""), FileContent::nothing);
}

TEST(ContentOf, RecognisesOtherText) {
  EXPECT_EQ(content_of_bytes("Dear reader\nthis: is a letter\n"), FileContent::text);
  EXPECT_EQ(content_of_bytes("#!/bin/sh\nrm file\n"), FileContent::text);
  EXPECT_EQ(content_of_bytes("1 2 3 4\n"), FileContent::text);
  EXPECT_EQ(content_of_bytes("\n\n"), FileContent::text);
  EXPECT_EQ(content_of_bytes("#timestamp [ns],filename\n1403636579763555584,1.png\n"), FileContent::table);
  EXPECT_EQ(content_of_bytes(std::string("\0\1\2", 3)), FileContent::other);
}

TEST(ContentOf, RecognisesColmapFilesAndPages) {
  const auto content = [](std::string_view bytes, const char* name) {
    return content_of(std::as_bytes(std::span(bytes)), name);
  };
  EXPECT_EQ(content("# Camera list with one line of data per camera:\n1 PINHOLE 4 4 1 1 2 2\n", "cameras.txt"),
            FileContent::colmap_model);
  EXPECT_EQ(content("# POINT3D_ID X Y Z R G B ERROR, then\n", "points3D.txt"), FileContent::colmap_model);
  const std::string one_camera = std::string("\1\0\0\0\0\0\0\0", 8) + std::string(48, '\2');
  EXPECT_EQ(content(one_camera, "cameras.bin"), FileContent::colmap_model);
  EXPECT_EQ(content(one_camera, "cameras"), FileContent::other);
  EXPECT_EQ(content(std::string("\x7f"
                                "ELF\2\1\1\0\0\0\0",
                                11),
                    "cameras.bin"),
            FileContent::other);
  EXPECT_EQ(content(std::string("\xff\xd8\xff\xe0\0\x10JFIF", 10), "cameras.bin"), FileContent::photograph);
  EXPECT_EQ(content("<!doctype html>\n<svg>", "index.html"), FileContent::page);
  EXPECT_EQ(content("# Title\nname: text, more\n", "report.md"), FileContent::page);
}

TEST(MayReplace, RequiresTheSameKindOrAnEmptyFile) {
  EXPECT_TRUE(may_replace(FileContent::map, FileContent::map));
  EXPECT_TRUE(may_replace(FileContent::nothing, FileContent::map));
  EXPECT_FALSE(may_replace(FileContent::text, FileContent::map));
  EXPECT_FALSE(may_replace(FileContent::map, FileContent::nothing));
  EXPECT_FALSE(may_replace(FileContent::other, FileContent::other));
}

TEST(ContentOf, IsEmptyForOtherThanRegularFiles) {
  EXPECT_FALSE(content_of(testing::TempDir()));
  EXPECT_FALSE(content_of("/dev/null"));
  EXPECT_FALSE(content_of("absent"));
}

}  // namespace
}  // namespace byre
