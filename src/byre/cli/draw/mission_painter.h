#pragma once

#include "byre/playback/play.h"
#include "byre/viewer/frame_view.h"
#include "byre/viewer/plan_picture.h"
#include "byre/viewer/run_video.h"

#include <cstddef>
#include <filesystem>
#include <optional>

namespace byre {

// Outputs to draw of a mission besides its path.
struct MissionPainting {
  bool keep_frame = false;     // whether to keep a frame for a camera picture
  std::optional<double> at_s;  // time of that frame since the start of the recording, seconds; empty: the last frame
  std::optional<std::filesystem::path> video;
  double speed = 1.0;  // playback speed of the video
  HeightBand heights;
};

// Data for pictures of a mission.
struct PaintedMission {
  PlanPath path;                    // poses as published, with verdicts
  std::optional<FrameScene> frame;  // empty if no frame was readable up to that time
  std::optional<double> frame_s;    // time of the frame since the start of the recording, seconds
  std::optional<Rig> rig;           // rig of the frame
  int video_frames = 0;
  bool plays_in_browsers = false;  // whether browsers can play the video
};

// Collects picture data and writes the video while a mission runs.
class MissionPainter {
 public:
  // first: time of the first frame of the whole recording. background: scene without the mission.
  MissionPainter(const MissionPainting& painting, const Recording& recording, Timestamp first,
                 const PlanScene& background);

  void add(const RunView& run);
  PaintedMission finish();

 private:
  void add_to_video(const FrameScene& frame, const Session& session);

  // Constant after construction.
  const MissionPainting painting_;
  const Timestamp first_;
  const FrameView view_;
  std::size_t offline_points_ = 0;
  PlanPictureOptions plan_options_;
  int every_ = 1;  // every n-th frame is filmed
  double video_rate_ = 1.0;

  PlanScene scene_;  // state after the last frame
  int frames_ = 0;
  std::optional<RunVideo> video_;
  PaintedMission mission_;
};

}  // namespace byre
