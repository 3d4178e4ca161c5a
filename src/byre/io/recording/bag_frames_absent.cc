#include "byre/io/calibration/frame_tree.h"

namespace byre {

std::optional<FrameTree> read_bag_frames(const std::filesystem::path& /*path*/) {
  return std::nullopt;
}

}  // namespace byre
