#include "byre/base/output_file.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/colmap/colmap_camera.h"
#include "byre/io/colmap/colmap_files.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWhiteSpace = " \t\r";

// All lines of a file, including blank ones: an image without keypoints has one.
class Lines {
 public:
  explicit Lines(const fs::path& path) : path_(path) {
    const std::vector<std::byte> bytes = read_file(path);
    text_.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  std::optional<std::string_view> next() {
    if (position_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', position_), text_.size());
    const std::string_view line = std::string_view(text_).substr(position_, end - position_);
    position_ = end + 1;
    ++number_;
    return line;
  }

  // The next line that is neither blank nor a comment.
  std::optional<std::string_view> next_entry() {
    while (const std::optional<std::string_view> line = next()) {
      const std::size_t begin = line->find_first_not_of(kWhiteSpace);
      if (begin != std::string_view::npos && (*line)[begin] != '#') return line;
    }
    return std::nullopt;
  }

  std::string place() const { return path_.string() + ":" + std::to_string(number_); }

 private:
  fs::path path_;
  std::string text_;
  std::size_t position_ = 0;
  int number_ = 0;
};

// Consecutive values of a line.
class Fields {
 public:
  Fields(std::string_view line, const Lines& lines) : rest_(line), lines_(lines) { skip_white_space(); }

  bool at_end() const { return rest_.empty(); }

  std::string_view word(const char* what) {
    if (at_end()) throw InputError(lines_.place(), std::string("ends before the ") + what);
    const std::size_t end = std::min(rest_.find_first_of(kWhiteSpace), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    skip_white_space();
    return word;
  }

  double number(const char* what) {
    const std::string_view text = word(what);
    const std::optional<double> value = parse_number(text);
    if (!value) fail(what, text);
    return *value;
  }

  template <typename Whole>
  Whole whole(const char* what) {
    const std::string_view text = word(what);
    const auto value = parse_whole<Whole>(text);
    if (!value) fail(what, text);
    return *value;
  }

  Eigen::Vector3d vector(const char* what) {
    const double x = number(what), y = number(what), z = number(what);
    return {x, y, z};
  }

  void require_end() const {
    if (!at_end()) throw InputError(lines_.place(), "contains extra text after the entry");
  }

  [[noreturn]] void fail(const char* what, std::string_view text) const {
    throw InputError(lines_.place(), "\"" + std::string(text) + "\" is not a valid " + what);
  }

 private:
  void skip_white_space() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kWhiteSpace), rest_.size())); }

  std::string_view rest_;
  const Lines& lines_;
};

ColmapCamera read_camera(Fields& fields) {
  ColmapCamera camera;
  camera.model = fields.word("camera model");
  const ColmapCameraModel* const kind = find_colmap_camera_model(camera.model);
  if (kind == nullptr) fields.fail("camera model of COLMAP", camera.model);
  camera.width = fields.whole<std::uint64_t>("width");
  camera.height = fields.whole<std::uint64_t>("height");
  for (std::size_t i = 0; i < kind->parameters; ++i) {
    camera.parameters.push_back(fields.number("parameter of the camera"));
  }
  fields.require_end();
  return camera;
}

ColmapImage read_colmap_image(Fields& fields) {
  ColmapImage image;
  const char* const kRotation = "quaternion";
  const double w = fields.number(kRotation), x = fields.number(kRotation), y = fields.number(kRotation),
               z = fields.number(kRotation);
  const std::optional<Eigen::Quaterniond> rotation = colmap_rotation(w, x, y, z);
  if (!rotation) fields.fail("quaternion of unit length", "QW QX QY QZ");
  image.camera_from_world = {*rotation, fields.vector("translation")};
  image.camera_id = fields.whole<std::uint32_t>("camera id");
  image.name = fields.word("name of the image");
  fields.require_end();
  return image;
}

std::vector<ColmapKeypoint> read_keypoints(Fields& fields) {
  std::vector<ColmapKeypoint> keypoints;
  while (!fields.at_end()) {
    ColmapKeypoint keypoint;
    const double u = fields.number("column of a keypoint"), v = fields.number("row of a keypoint");
    const auto point_id = fields.whole<std::int64_t>("point id");
    keypoint.pixel = {u, v};
    if (point_id >= 0) keypoint.point_id = static_cast<std::uint64_t>(point_id);
    keypoints.push_back(keypoint);
  }
  return keypoints;
}

ColmapPoint read_point(Fields& fields) {
  ColmapPoint point;
  point.position_in_world = fields.vector("position");
  for (std::uint8_t& channel : point.colour) channel = fields.whole<std::uint8_t>("colour from 0 to 255");
  point.error = fields.number("reprojection error");
  while (!fields.at_end()) {
    const auto image_id = fields.whole<std::uint32_t>("image id of the track");
    point.track.push_back({image_id, fields.whole<std::uint32_t>("keypoint of the track")});
  }
  return point;
}

template <typename Id, typename Entry>
void insert(std::map<Id, Entry>& entries, Id id, Entry entry, const std::string& place) {
  if (entries.emplace(id, std::move(entry)).second) return;
  throw InputError(place, "contains the id " + std::to_string(id) + " twice");
}

// The shortest text that parses to the same number.
template <typename Number>
void append(std::string& text, Number number) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), end);
}

template <typename Number, typename... Numbers>
void append(std::string& text, Number first, Numbers... others) {
  append(text, first);
  ((text += ' ', append(text, others)), ...);
}

void append(std::string& text, const Eigen::Vector3d& vector) {
  append(text, vector.x(), vector.y(), vector.z());
}

void write_text(const std::string& text, const fs::path& path) {
  write_atomically(path, text);
}

std::string camera_text(const ColmapModel& model) {
  std::string text = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n";
  for (const auto& [id, camera] : model.cameras) {
    append(text, id);
    text += ' ' + camera.model + ' ';
    append(text, camera.width, camera.height);
    for (const double parameter : camera.parameters) {
      text += ' ';
      append(text, parameter);
    }
    text += '\n';
  }
  return text;
}

void require_writable_name(const std::string& name, const fs::path& path) {
  if (name.find_first_of(" \t\r\n") == std::string::npos) return;
  throw InputError(path.string(), "cannot hold the image name \"" + name + "\": names must not contain white space",
                   "use the binary format");
}

std::string image_text(const ColmapModel& model, const fs::path& path) {
  std::string text = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n# then X Y POINT3D_ID for each keypoint\n";
  for (const auto& [id, image] : model.images) {
    require_writable_name(image.name, path);
    const Eigen::Quaterniond& rotation = image.camera_from_world.rotation;
    append(text, id, rotation.w(), rotation.x(), rotation.y(), rotation.z());
    text += ' ';
    append(text, image.camera_from_world.translation);
    text += ' ';
    append(text, image.camera_id);
    text += ' ' + image.name + '\n';
    const char* separator = "";
    for (const ColmapKeypoint& keypoint : image.keypoints) {
      text += std::exchange(separator, " ");
      append(text, keypoint.pixel.x(), keypoint.pixel.y());
      text += ' ';
      keypoint.point_id ? append(text, *keypoint.point_id) : append(text, -1);
    }
    text += '\n';
  }
  return text;
}

std::string point_text(const ColmapModel& model) {
  std::string text = "# POINT3D_ID X Y Z R G B ERROR, then IMAGE_ID POINT2D_IDX for each view\n";
  for (const auto& [id, point] : model.points) {
    append(text, id);
    text += ' ';
    append(text, point.position_in_world);
    for (const int channel : point.colour) {
      text += ' ';
      append(text, channel);
    }
    text += ' ';
    append(text, point.error);
    for (const ColmapTrackEntry& entry : point.track) {
      text += ' ';
      append(text, entry.image_id, entry.keypoint);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::map<std::uint32_t, ColmapCamera> read_colmap_cameras_text(const fs::path& path) {
  Lines lines(path);
  std::map<std::uint32_t, ColmapCamera> cameras;
  while (const std::optional<std::string_view> line = lines.next_entry()) {
    Fields fields(*line, lines);
    const auto id = fields.whole<std::uint32_t>("camera id");
    insert(cameras, id, read_camera(fields), lines.place());
  }
  return cameras;
}

std::map<std::uint32_t, ColmapImage> read_colmap_images_text(const fs::path& path) {
  Lines lines(path);
  std::map<std::uint32_t, ColmapImage> images;
  while (const std::optional<std::string_view> line = lines.next_entry()) {
    Fields fields(*line, lines);
    const auto id = fields.whole<std::uint32_t>("image id");
    ColmapImage image = read_colmap_image(fields);
    const std::string place = lines.place();
    Fields keypoints(lines.next().value_or(""), lines);
    image.keypoints = read_keypoints(keypoints);
    insert(images, id, std::move(image), place);
  }
  return images;
}

std::map<std::uint64_t, ColmapPoint> read_colmap_points_text(const fs::path& path) {
  Lines lines(path);
  std::map<std::uint64_t, ColmapPoint> points;
  while (const std::optional<std::string_view> line = lines.next_entry()) {
    Fields fields(*line, lines);
    const auto id = fields.whole<std::uint64_t>("point id");
    insert(points, id, read_point(fields), lines.place());
  }
  return points;
}

void write_colmap_text(const ColmapModel& model, const fs::path& folder) {
  write_text(camera_text(model), folder / "cameras.txt");
  write_text(image_text(model, folder / "images.txt"), folder / "images.txt");
  write_text(point_text(model), folder / "points3D.txt");
}

}  // namespace byre
