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
  bool keeps_frame = false;    // for a picture of what the camera saw
  std::optional<double> at_s;  // moment of that frame, from the recording's first; else the last one
  std::optional<std::filesystem::path> video;
  double speed = 1.0;  // of the video, in times of the recording's own
  HeightBand heights;
};

// What is kept of a mission to draw it.
struct PaintedMission {
  PlanPath way;                     // poses as published, with their verdicts
  std::optional<FrameScene> frame;  // empty when no frame could be read up to then
  std::optional<double> frame_s;    // its time, from the recording's first frame
  std::optional<Rig> rig;           // that took it
  int video_frames = 0;
  bool plays_in_browsers = false;  // the video
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
  int every_ = 1;  // of so many frames one is filmed
  double video_rate_ = 1.0;

  PlanScene scene_;  // as after the last frame
  int frames_ = 0;
  std::optional<RunVideo> video_;
  PaintedMission mission_;
};

}  // namespace byre
