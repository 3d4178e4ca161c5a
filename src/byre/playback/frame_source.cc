#include "byre/playback/frame_source.h"

#include <exception>
#include <utility>

namespace byre {

const MotionSamples& FrameSource::motion() const {
  static const MotionSamples none;
  return none;
}

std::optional<FrameSource::SourceFrame> RecordingFrames::next(const std::function<bool()>& should_stop) {
  auto decoded = decoder_->next();
  if (!decoded) return std::nullopt;
  SourceFrame frame{std::move(*decoded)};
  if (is_live_) frame.late_s = clock_.wait_until_due(frame.decoded.time, should_stop);
  return frame;
}

std::optional<ImageFrame> RecordingFrames::read_again(int number) {
  decoder_.reset();  // only one thread may read
  try {
    return recording_.read(number);
  } catch (const std::exception&) {
    return std::nullopt;  // such as a disk that was removed: the map must not be lost
  }
}

}  // namespace byre
