#include "byre/io/recording/timed_files.h"

#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

class InputFiles : public TestFolder {
 protected:
  // Paths relative to the folder.
  std::vector<std::string> names(const std::vector<fs::path>& files) const {
    std::vector<std::string> names;
    for (const fs::path& file : files) names.push_back(file.lexically_relative(folder_).lexically_normal().string());
    return names;
  }
};

TEST_F(InputFiles, IncludeEurocSensorsOnly) {
  for (const char* const name : {"mav0/cam0/data.csv", "mav0/cam0/sensor.yaml", "mav0/cam0/data/1.png",
                                 "mav0/imu0/data.csv", "mav0/state_groundtruth_estimate0/data.csv"}) {
    write(name, "x");
  }
  write("out.byre", "x");
  write("mav0/out.txt", "x");
  const std::vector<std::string> files = names(files_of_recording(folder_));
  EXPECT_THAT(files, Contains("mav0/cam0/data/1.png"));
  EXPECT_THAT(files, Contains("mav0/cam0/data.csv"));
  EXPECT_THAT(files, Contains("mav0/imu0/data.csv"));
  EXPECT_THAT(files, Contains("mav0/state_groundtruth_estimate0/data.csv"));
  EXPECT_THAT(files, Not(Contains("out.byre")));
  EXPECT_THAT(files, Not(Contains("mav0/out.txt")));
}

TEST_F(InputFiles, IncludeListsAndImagesOfOtherFormats) {
  write("kitti/sequences/00/calib.txt", "x");
  write("kitti/sequences/00/times.txt", "x");
  write("kitti/sequences/00/image_0/000000.png", "x");
  write("kitti/poses/00.txt", "x");
  EXPECT_THAT(names(files_of_recording(folder_ / "kitti/sequences/00")),
              UnorderedElementsAre("kitti/sequences/00/calib.txt", "kitti/sequences/00/times.txt",
                                   "kitti/sequences/00/image_0/000000.png", "kitti/poses/00.txt"));
  write("tum/rgb.txt", "1.0 elsewhere/a.png\n");
  write("tum/elsewhere/a.png", "x");
  write("tum/groundtruth.txt", "x");
  EXPECT_THAT(names(files_of_recording(folder_ / "tum")),
              UnorderedElementsAre("tum/rgb.txt", "tum/elsewhere/a.png", "tum/groundtruth.txt"));
  write("images/1.png", "x");
  write("images/camera.yaml", "x");
  write("images/out.byre", "x");
  EXPECT_THAT(names(files_of_recording(folder_ / "images")),
              UnorderedElementsAre("images/1.png", "images/camera.yaml"));
  write("walk.mp4", "x");
  write("calibration.yaml", "x");
  EXPECT_THAT(names(files_of_recording(folder_ / "walk.mp4")), UnorderedElementsAre("walk.mp4", "calibration.yaml"));
}

TEST_F(InputFiles, FollowCircularLinksSafely) {
  write("elsewhere/1.png", "x");
  write("rec/mav0/cam0/data.csv", "x");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "rec/mav0/cam0/data");
  fs::create_directory_symlink(folder_ / "rec/mav0", folder_ / "rec/mav0/cam0/round");
  fs::create_symlink("itself", folder_ / "rec/mav0/cam0/itself");
  EXPECT_THAT(names(files_of_recording(folder_ / "rec")), Contains("rec/mav0/cam0/data/1.png"));
}

TEST_F(InputFiles, IncludeImageAndWorldFileOfAPlan) {
  write("plan.yaml", "image: drawings/floor.png\n");
  write("drawings/floor.png", "x");
  EXPECT_THAT(names(files_of_floor_plan(folder_ / "plan.yaml")),
              UnorderedElementsAre("plan.yaml", "drawings/floor.png"));
  write("site.png", "x");
  write("site.pgw", "x");
  EXPECT_THAT(names(files_of_floor_plan(folder_ / "site.png")), UnorderedElementsAre("site.png", "site.pgw"));
  write("broken.yaml", "image: [");
  EXPECT_THAT(names(files_of_floor_plan(folder_ / "broken.yaml")), UnorderedElementsAre("broken.yaml"));
}

TEST_F(InputFiles, IncludeFilesOfAModelAndImagesBelowAFolder) {
  write("model/cameras.bin", "x");
  write("model/points3D.txt", "x");
  write("model/project.ini", "x");
  EXPECT_THAT(names(files_of_colmap_model(folder_ / "model")),
              UnorderedElementsAre("model/cameras.bin", "model/points3D.txt"));
  write("photos/a/b/1.jpg", "x");
  write("photos/notes.txt", "x");
  EXPECT_THAT(names(images_below(folder_ / "photos")), UnorderedElementsAre("photos/a/b/1.jpg"));
}

TEST_F(InputFiles, AreEmptyForMissingPaths) {
  EXPECT_THAT(names(files_of_colmap_model(folder_ / "absent")), IsEmpty());
  EXPECT_THAT(names(files_of_recording(folder_)), IsEmpty());
}

}  // namespace
}  // namespace byre
