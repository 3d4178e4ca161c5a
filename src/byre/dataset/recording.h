#pragma once

#include "byre/features/image.h"
#include "byre/geometry/camera.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace byre {

enum class RecordingFormat : std::uint8_t { euroc, kitti };

// Which frames of a recording to read. Both limits apply.
struct FrameRange {
  std::optional<double> start_s{};  // seconds from the first frame of the recording
  std::optional<double> end_s{};    // exclusive
  int first = 0;                    // frame index, inclusive
  std::optional<int> last{};        // exclusive
  int stride = 1;                   // every n-th frame of those
};

// A recorded stereo sequence, read one pair at a time.
class Recording {
 public:
  virtual ~Recording() = default;

  virtual const Calibration& calibration() const = 0;
  // Time stamps of the frames in range, strictly increasing. A left image without a right partner is in it.
  virtual const std::vector<Timestamp>& times() const = 0;
  // The i-th frame, decoded. Empty, with a warning added, when the left image cannot be read or is of another size than
  // calibrated; without a right image, with a warning added, when that one is absent, unreadable or of another size.
  // May be called from any thread, but from one at a time.
  virtual std::optional<ImageFrame> read(int index) = 0;
  virtual const std::vector<std::string>& warnings() const = 0;

  int size() const { return static_cast<int>(times().size()); }
};

// Tells the format by what the folder holds; throws InputError saying what was looked for when it is none.
RecordingFormat guess_format(const std::filesystem::path& folder);

// An EuRoC folder (the one that holds mav0, or mav0 itself) or a KITTI odometry sequence; monocular where the folder
// of the right camera is missing. Throws InputError, naming the file and what is wrong with it: missing files, a
// calibration that does not parse or makes no sense, time stamps out of order, no frame in range.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& folder, const FrameRange& range);

// The ground truth that came with the recording, where there is one: inside an EuRoC folder, and beside the sequences
// of KITTI (../../poses/00.txt for sequences/00).
std::optional<std::filesystem::path> find_ground_truth(const std::filesystem::path& folder);

}  // namespace byre
