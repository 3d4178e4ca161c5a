#pragma once

#include "byre/playback/map_run.h"
#include "byre/viewer/frame_view.h"
#include "byre/viewer/plan_picture.h"
#include "byre/viewer/run_video.h"

#include <cstddef>
#include <filesystem>
#include <optional>

namespace byre {

// What of a mission is to be drawn beside its way.
struct MissionPainting {
  bool keeps_frame = false;    // whether a frame is kept for a picture of what the camera saw
  std::optional<double> at_s;  // moment of the frame kept, from the recording's first; empty: the last one
  std::optional<std::filesystem::path> video;
  double speed = 1.0;  // speed of the video over that of the recording
  HeightBand heights;
};

// What is kept of a mission to draw it.
struct PaintedMission {
  PlanPath way;                     // poses as published, with their verdicts
  std::optional<FrameScene> frame;  // empty when no frame could be read up to then
  std::optional<double> frame_s;    // time of the frame, from the recording's first
  std::optional<Rig> rig;           // rig that took the frame
  int video_frames = 0;
  bool plays_in_browsers = false;  // whether browsers play the video
};

// Looks at each frame of a run, and keeps and draws what was asked for.
class MissionPainter {
 public:
  // first: time of the recording's first frame, of which fewer may be run. background: the scene without the mission.
  MissionPainter(const MissionPainting& painting, const Recording& recording, Timestamp first,
                 const PlanScene& background);

  void look(const RunView& run);
  PaintedMission finish();

 private:
  void film(const FrameScene& frame, const Session& session);

  // Constant after construction.
  const MissionPainting painting_;
  const Timestamp first_;
  const FrameView view_;
  std::size_t offline_points_ = 0;
  PlanPictureOptions plan_options_;
  int every_ = 1;  // frames for each that is filmed
  double video_rate_ = 1.0;

  PlanScene scene_;  // as after the last frame
  int frames_ = 0;
  std::optional<RunVideo> video_;
  PaintedMission mission_;
};

}  // namespace byre
