#include "byre/io/colmap/colmap_model.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/colmap/colmap_scene.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

// Positions, pixels and parameters bit by bit; quaternions up to rounding.
void expect_equal(const ColmapModel& read, const ColmapModel& written) {
  ASSERT_EQ(read.cameras.size(), written.cameras.size());
  for (const auto& [id, camera] : written.cameras) {
    EXPECT_EQ(read.cameras.at(id).model, camera.model);
    EXPECT_EQ(read.cameras.at(id).width, camera.width);
    EXPECT_EQ(read.cameras.at(id).height, camera.height);
    EXPECT_EQ(read.cameras.at(id).parameters, camera.parameters);
  }
  ASSERT_EQ(read.images.size(), written.images.size());
  for (const auto& [id, image] : written.images) {
    const ColmapImage& other = read.images.at(id);
    EXPECT_EQ(other.name, image.name);
    EXPECT_EQ(other.camera_id, image.camera_id);
    EXPECT_EQ(other.camera_from_world.translation, image.camera_from_world.translation);
    EXPECT_THAT(other.camera_from_world, PoseNear(image.camera_from_world, 1e-15, 1e-15));
    ASSERT_EQ(other.keypoints.size(), image.keypoints.size());
    for (std::size_t i = 0; i < image.keypoints.size(); ++i) {
      EXPECT_EQ(other.keypoints[i].pixel, image.keypoints[i].pixel);
      EXPECT_EQ(other.keypoints[i].point_id, image.keypoints[i].point_id);
    }
  }
  ASSERT_EQ(read.points.size(), written.points.size());
  for (const auto& [id, point] : written.points) {
    const ColmapPoint& other = read.points.at(id);
    EXPECT_EQ(other.position_in_world, point.position_in_world);
    EXPECT_EQ(other.colour, point.colour);
    EXPECT_EQ(other.error, point.error);
    ASSERT_EQ(other.track.size(), point.track.size());
    for (std::size_t i = 0; i < point.track.size(); ++i) {
      EXPECT_EQ(other.track[i].image_id, point.track[i].image_id);
      EXPECT_EQ(other.track[i].keypoint, point.track[i].keypoint);
    }
  }
}

class ColmapModelFiles : public TestFolder {
 protected:
  // The error of reading a text model with one file replaced.
  std::string error_with(const std::string& file, const std::string& content) const {
    for (const char* const part : {"cameras.txt", "images.txt", "points3D.txt"}) {
      std::filesystem::remove(std::filesystem::path(folder_) / part);
    }
    write_colmap_model(small_colmap_model(), folder_, ColmapFormat::text);
    write(file, content);
    return error_of([this] { read_colmap_model(folder_); });
  }

  std::string error_after(const std::function<void(ColmapModel&)>& spoil) const {
    ColmapModel model = small_colmap_model();
    spoil(model);
    write_colmap_model(model, folder_, ColmapFormat::binary);
    return error_of([this] { read_colmap_model(folder_); });
  }
};

TEST_F(ColmapModelFiles, AreReadBackInBothFormats) {
  for (const ColmapFormat format : {ColmapFormat::text, ColmapFormat::binary}) {
    write_colmap_model(small_colmap_model(), folder_, format);
    expect_equal(read_colmap_model(folder_), small_colmap_model());
    std::filesystem::remove(folder_ / "cameras.txt");
  }
}

TEST_F(ColmapModelFiles, ArePreferredInBinary) {
  ColmapModel other = small_colmap_model();
  other.points.at(9).position_in_world.x() = 7.0;
  write_colmap_model(small_colmap_model(), folder_, ColmapFormat::text);
  write_colmap_model(other, folder_, ColmapFormat::binary);
  EXPECT_EQ(read_colmap_model(folder_).points.at(9).position_in_world.x(), 7.0);
}

TEST_F(ColmapModelFiles, AcceptAnEmptyModel) {
  write_colmap_model({}, folder_, ColmapFormat::binary);
  EXPECT_TRUE(read_colmap_model(folder_).points.empty());
}

TEST_F(ColmapModelFiles, AreReadFromTextOfColmap) {
  write("cameras.txt", "# Camera list\n# Number of cameras: 1\n1 SIMPLE_PINHOLE 640 480 500 320 240\r\n");
  write("images.txt",
        "# Image list\n1 1 0 0 0 0.5 0 0 1 left,1.jpg\n320.5 240.25 3 1 2 -1\n2 1 0 0 0 1 0 0 1 right.jpg\n\n"
        "3 1 0 0 0 1 0 0 1 last.jpg\n");
  write("points3D.txt", "3 0 0 4 10 20 30 0.25 1 0\n");
  const ColmapModel model = read_colmap_model(folder_);
  EXPECT_EQ(model.images.at(1).name, "left,1.jpg");
  EXPECT_EQ(model.images.at(1).keypoints.front().point_id, 3u);
  EXPECT_FALSE(model.images.at(1).keypoints.back().point_id);
  EXPECT_TRUE(model.images.at(2).keypoints.empty());
  EXPECT_EQ(model.images.at(3).name, "last.jpg");
  EXPECT_EQ(model.points.at(3).colour[2], 30);
}

TEST_F(ColmapModelFiles, ReportFileAndLineOfErrors) {
  EXPECT_THAT(error_with("cameras.txt", "1 SPHERE 640 480 500\n"), HasSubstr("cameras.txt:1: \"SPHERE\""));
  EXPECT_THAT(error_with("cameras.txt", "\n1 PINHOLE 640 480 500\n"), HasSubstr("cameras.txt:2: ends before"));
  EXPECT_THAT(error_with("cameras.txt", "1 PINHOLE 640 480 5 5 5 5 5\n"),
              HasSubstr("cameras.txt:1: contains extra text"));
  EXPECT_THAT(error_with("cameras.txt", "1 PINHOLE 640 -480 5 5 5 5\n"), HasSubstr("\"-480\" is not a valid height"));
  EXPECT_THAT(error_with("cameras.txt", "1 PINHOLE 6 4 5 5 5 5\n1 PINHOLE 6 4 5 5 5 5\n"), HasSubstr("twice"));
  EXPECT_THAT(error_with("images.txt", "1 2 0 0 0 0 0 0 1 a.png\n\n"), HasSubstr("images.txt:1"));
  EXPECT_THAT(error_with("images.txt", "1 1 0 0 0 0 0 0 1 a.png\n1 2\n"), HasSubstr("images.txt:2: ends before"));
  EXPECT_THAT(error_with("images.txt", "1 1 0 0 0 0 nan 0 1 a.png\n\n"),
              HasSubstr("\"nan\" is not a valid translation"));
  EXPECT_THAT(error_with("points3D.txt", "5 0 0 1 0 0 256 1\n"), HasSubstr("\"256\" is not a valid colour"));
  EXPECT_THAT(error_with("points3D.txt", "5 0 0 1 0 0 0 1 2\n"), HasSubstr("points3D.txt:1: ends before"));
}

TEST_F(ColmapModelFiles, RejectInconsistentReferences) {
  EXPECT_THAT(error_after([](ColmapModel& model) { model.cameras.erase(7); }), HasSubstr("camera 7"));
  EXPECT_THAT(error_after([](ColmapModel& model) { model.points.erase(5); }), HasSubstr("refers to point 5"));
  EXPECT_THAT(error_after([](ColmapModel& model) { model.points.at(5).track[0].image_id = 99; }),
              HasSubstr("refers to image 99"));
  EXPECT_THAT(error_after([](ColmapModel& model) { model.points.at(5).track[0].keypoint = 1000; }),
              HasSubstr("keypoint 1000"));
  EXPECT_THAT(error_after([](ColmapModel& model) { model.points.at(5).track[0].keypoint = 2; }),
              HasSubstr("keypoint 2 of image 2"));
}

TEST_F(ColmapModelFiles, ReportAMissingModel) {
  EXPECT_THAT(error_of([this] { read_colmap_model(folder_); }), HasSubstr("contains no COLMAP model"));
}

TEST_F(ColmapModelFiles, KeepNamesWithBlanksInBinaryOnly) {
  ColmapModel model = small_colmap_model();
  model.images.at(8).name = "with blank.jpg";
  write_colmap_model(model, folder_, ColmapFormat::binary);
  EXPECT_EQ(read_colmap_model(folder_).images.at(8).name, "with blank.jpg");
  EXPECT_THROW(write_colmap_model(model, folder_, ColmapFormat::text), InputError);
}

class DamagedBinaryFile : public TestFolder, public testing::WithParamInterface<const char*> {
 protected:
  DamagedBinaryFile() { write_colmap_model(small_colmap_model(), folder_, ColmapFormat::binary); }
};

TEST_P(DamagedBinaryFile, IsRejectedAtEveryTruncation) {
  const auto path = folder_ / GetParam();
  for (std::uintmax_t size = std::filesystem::file_size(path); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    EXPECT_THROW(read_colmap_model(folder_), InputError) << size;
  }
}

TEST_P(DamagedBinaryFile, IsReadOrRejectedForEveryWrongByte) {
  const auto path = folder_ / GetParam();
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(path));
  int refused = 0;
  for (std::streamoff i = 0; i < size; ++i) {
    const char right = static_cast<char>(file.seekg(i).get());
    file.seekp(i).put(static_cast<char>(~right)).flush();
    refused += error_of([this] { read_colmap_model(folder_); }) == "no InputError" ? 0 : 1;
    file.seekp(i).put(right).flush();
  }
  EXPECT_GT(refused, 0);
  EXPECT_NO_THROW(read_colmap_model(folder_));
}

INSTANTIATE_TEST_SUITE_P(Each, DamagedBinaryFile, testing::Values("cameras.bin", "images.bin", "points3D.bin"),
                         [](const auto& file) { return std::string(file.param, std::string(file.param).find('.')); });

TEST_F(ColmapModelFiles, RejectImageNamesOutsideTheFolder) {
  for (const char* const name : {"/etc/passwd", "../1.png", "a/../../1.png", "a/..", ".."}) {
    const auto rename = [name](ColmapModel& model) { model.images.at(3).name = name; };
    EXPECT_THAT(error_after(rename), HasSubstr("images: image 3: has the name \"" + std::string(name) +
                                               "\", which is outside the image folder"));
  }
  EXPECT_EQ(error_after([](ColmapModel& model) { model.images.at(3).name = "a/..b/...png"; }), "no InputError");
}

}  // namespace
}  // namespace byre
