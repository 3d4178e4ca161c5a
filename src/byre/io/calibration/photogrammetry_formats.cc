// Cameras of MATLAB and of photogrammetry: OpenSfM, Metashape, OpenMVG, Middlebury.
#include "byre/input_error.h"
#include "byre/io/calibration/camera_fields.h"
#include "byre/io/calibration/format_readers.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include <Eigen/QR>
#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Fields = CalibrationFields;

constexpr double kHalf = 0.5;  // coordinates of the centre of the first pixel in photogrammetry minus byre's, pixels
constexpr double kBoardUnit = 1e-3;  // metres, default unit of calibration boards and of Middlebury

Pose pair_of(const Fields& fields, const std::string& place, const Eigen::Matrix3d& matrix,
             const Eigen::Vector3d& translation) {
  const auto rotation = rotation_from_matrix(matrix);
  if (!rotation) throw InputError(fields.place(place), "is not a rotation", "calibrate the pair again");
  return {*rotation, translation};
}

// ---- MATLAB

// Name of a property of cameraParameters, which variables of scripts begin with a small letter.
std::string property(const Fields& fields, std::string name) {
  if (fields.has(name)) return name;
  std::string variable = name;
  variable.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(variable.front())));
  return fields.has(variable) ? variable : name;
}

// Image coordinates count from 1; ImageSize is rows, columns; IntrinsicMatrix is the transpose of K.
PlacedCamera matlab_camera(const Fields& fields, std::vector<std::string>& notes) {
  PlacedCamera result;
  Camera& camera = result.camera;
  if (const std::string name = property(fields, "ImageSize"); fields.has(name)) {
    const std::vector<double> size = fields.numbers(name, 2);
    camera.height = to_image_side(size[0], fields.place(name));
    camera.width = to_image_side(size[1], fields.place(name));
  }
  std::vector<double> matrix;
  std::string place = property(fields, "IntrinsicMatrix");
  if (fields.has(place)) {
    matrix = fields.numbers(place, 9);
    const bool is_transposed = matrix[2] == 0.0 && matrix[5] == 0.0;
    if (is_transposed) {
      std::swap(matrix[1], matrix[3]), std::swap(matrix[2], matrix[6]), std::swap(matrix[5], matrix[7]);
    }
  } else if (fields.has("FocalLength") && fields.has("PrincipalPoint")) {
    place = "FocalLength";
    const std::vector<double> focal = fields.numbers("FocalLength", 2);
    const std::vector<double> centre = fields.numbers("PrincipalPoint", 2);
    matrix = {focal[0], fields.number_or("Skew", 0.0), centre[0], 0.0, focal[1], centre[1], 0.0, 0.0, 1.0};
  } else {
    place = "K";
    if (!fields.has(place)) throw InputError(fields.place("IntrinsicMatrix"), "is missing");
    matrix = fields.numbers(place, 9);
  }
  matrix[2] -= 1.0, matrix[5] -= 1.0;
  set_skewed_matrix(camera, matrix, fields.place(place), notes);
  const std::string radial_name = property(fields, "RadialDistortion");
  const std::string tangential_name = property(fields, "TangentialDistortion");
  std::vector<double> radial = fields.numbers(radial_name);
  std::vector<double> tangential(2, 0.0);
  if (fields.has(tangential_name)) tangential = fields.numbers(tangential_name, 2);
  if (radial.size() != 2 && radial.size() != 3) fields.numbers(radial_name, 2);
  radial.resize(3, 0.0);
  set_opencv_distortion(camera, std::array{radial[0], radial[1], tangential[0], tangential[1], radial[2]}, false,
                        fields.place(radial_name));
  return result;
}

// Metres per unit of length of a calibration board, millimetres by default.
double board_unit(const Fields& fields, std::vector<std::string>& notes) {
  const std::string unit = text_or(fields, "WorldUnits", "");
  if (unit == "m" || unit == "meters" || unit == "metres") return 1.0;
  if (unit == "cm" || unit == "centimeters") return 0.01;
  if (unit == "mm" || unit == "millimeters") return kBoardUnit;
  if (unit == "in" || unit == "inches") return 0.0254;
  notes.push_back("the baseline is taken as millimetres, the unit of MATLAB's calibration boards");
  return kBoardUnit;
}

// ---- Bouguet's toolbox

PlacedCamera bouguet_camera(const Fields& fields, const std::string& side, std::vector<std::string>& notes) {
  PlacedCamera result;
  Camera& camera = result.camera;
  read_size(fields, "nx", "ny", camera);
  const std::vector<double> focal = fields.numbers("fc" + side, 2);
  const std::vector<double> centre = fields.numbers("cc" + side, 2);
  const double skew = fields.has("alpha_c" + side) ? fields.number("alpha_c" + side) * focal[0] : 0.0;
  set_skewed_matrix(camera, {focal[0], skew, centre[0], 0.0, focal[1], centre[1], 0.0, 0.0, 1.0},
                    fields.place("fc" + side), notes);
  const std::vector<double> lens = fields.numbers("kc" + side);
  constexpr std::size_t kFisheye = 4, kRadialTangential = 5;
  if (lens.size() != kFisheye && lens.size() != kRadialTangential) fields.numbers("kc" + side, kRadialTangential);
  set_opencv_distortion(camera, lens, lens.size() == kFisheye, fields.place("kc" + side));
  if (lens.size() == kFisheye) notes.push_back("kc" + side + ": four coefficients are those of the fisheye model");
  return result;
}

// ---- OpenSfM

// Pixels are normalised by the longer side, from the centre of the image.
PlacedCamera opensfm_camera(const Fields& fields, std::vector<std::string>& notes) {
  constexpr double kDefaultFocal = 0.85;
  PlacedCamera result;
  Camera& camera = result.camera;
  camera.width = fields.pixels("width"), camera.height = fields.pixels("height");
  const double size = std::max(camera.width, camera.height);
  const std::string type = fields.text("projection_type");
  const bool has_one_focal = fields.has("focal");
  const std::string focal = has_one_focal ? "focal" : "focal_x";
  camera.fx = size * fields.number(focal);
  camera.fy = has_one_focal ? camera.fx : size * fields.number("focal_y");
  camera.cx = size * fields.number_or("c_x", 0.0) + 0.5 * (camera.width - 1);
  camera.cy = size * fields.number_or("c_y", 0.0) + 0.5 * (camera.height - 1);
  const std::string place = fields.place(focal);
  if (type == "perspective" || type == "brown" || type == "radial" || type == "simple_radial") {
    set_opencv_distortion(camera, coefficients_of(fields, "", {"k1", "k2", "p1", "p2", "k3"}), false, place);
  } else if (type == "fisheye" || type == "fisheye_opencv") {
    set_opencv_distortion(camera, coefficients_of(fields, "", {"k1", "k2", "k3", "k4"}), true, place);
  } else if (type == "fisheye62" || type == "fisheye624") {
    const std::vector<double> high = coefficients_of(fields, "", {"k5", "k6", "s1", "s3"});
    if (std::ranges::any_of(high, [](double value) { return value != 0.0; })) {
      throw InputError(fields.place("k5"), "coefficients above k4, p2, s0 and s2 are not supported",
                       "reconstruct with fisheye_opencv");
    }
    set_kalibr_lens(camera,
                    {"pinhole",
                     {camera.fx, camera.fy, camera.cx, camera.cy},
                     "thin_prism_fisheye",
                     coefficients_of(fields, "", {"k1", "k2", "p1", "p2", "k3", "k4", "s0", "s2"})},
                    place);
  } else {
    throw InputError(fields.place("projection_type"), "\"" + type + "\" is not supported",
                     "supported types: perspective, brown, radial, simple_radial, fisheye, fisheye_opencv");
  }
  require_valid(camera, place);
  const bool is_guess =
      has_one_focal && fields.number("focal") == kDefaultFocal && camera.model == CameraModel::pinhole;
  if (is_guess) notes.push_back("the focal length is OpenSfM's guess for images without EXIF, not a calibration");
  return result;
}

// ---- Metashape, PhotoScan

// Ideal radii up to that of the farthest corner of the image, and their distorted radii, which grow.
struct RadialSamples {
  std::vector<double> ideal;
  std::vector<double> distorted;
};

RadialSamples radial_samples(const Camera& camera, const std::array<double, 4>& k) {
  constexpr double kStep = 0.005;
  const double reach = std::hypot(std::max(camera.cx, camera.width - camera.cx) / camera.fx,
                                  std::max(camera.cy, camera.height - camera.cy) / camera.fy);
  RadialSamples samples;
  double distorted = 0.0;
  for (double r = kStep; distorted < reach; r += kStep) {
    const double s = r * r;
    const double next = r * (1.0 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))));
    if (next <= distorted) break;
    distorted = next;
    samples.ideal.push_back(r);
    samples.distorted.push_back(distorted);
  }
  return samples;
}

// Approximates four radial coefficients by the rational model. Returns the largest error, pixels.
double fit_rational(const std::array<double, 4>& k, double p1, double p2, Camera& camera) {
  const RadialSamples samples = radial_samples(camera, k);
  const auto count = static_cast<Eigen::Index>(samples.ideal.size());
  constexpr Eigen::Index kUnknowns = 6;
  if (count < 2 * kUnknowns) return std::numeric_limits<double>::infinity();
  // r (1 + k1 r^2 + k2 r^4 + k3 r^6) = d (1 + k4 r^2 + k5 r^4 + k6 r^6), with radii as shares of the largest.
  const double scale = samples.ideal.back();
  Eigen::MatrixXd equations(count, kUnknowns);
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double r = samples.ideal[static_cast<std::size_t>(i)] / scale;
    const double d = samples.distorted[static_cast<std::size_t>(i)] / scale;
    const double s = r * r;
    equations.row(i) << r * s, r * s * s, r * s * s * s, -d * s, -d * s * s, -d * s * s * s;
    values(i) = d - r;
  }
  const Eigen::VectorXd fit = equations.colPivHouseholderQr().solve(values);
  const double unit = 1.0 / (scale * scale);
  camera.model = CameraModel::rational;
  camera.distortion = {
      fit(0) * unit,        fit(1) * unit * unit,       p1, p2, fit(2) * unit * unit * unit, fit(3) * unit,
      fit(4) * unit * unit, fit(5) * unit * unit * unit};
  double largest = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double s = std::pow(samples.ideal[static_cast<std::size_t>(i)] / scale, 2);
    const double ratio =
        (1.0 + s * (fit(0) + s * (fit(1) + s * fit(2)))) / (1.0 + s * (fit(3) + s * (fit(4) + s * fit(5))));
    const double error =
        samples.ideal[static_cast<std::size_t>(i)] * ratio - samples.distorted[static_cast<std::size_t>(i)];
    largest = std::max(largest, std::abs(error));
  }
  return largest * std::max(camera.fx, camera.fy);
}

void set_metashape_lens(const Fields& fields, double p1, double p2, Camera& camera, std::vector<std::string>& notes) {
  constexpr double kMostError = 0.05;  // pixels
  const std::vector<double> k = coefficients_of(fields, "", {"k1", "k2", "k3", "k4"});
  const std::string place = fields.place(fields.has("k4") ? "k4" : "f");
  const std::string type = text_or(fields, "projection", text_or(fields, "type", "frame"));
  if (fields.number_or("p3", 0.0) != 0.0 || fields.number_or("p4", 0.0) != 0.0) {
    throw InputError(fields.place("p3"), "tangential coefficients above p2 are not supported",
                     "calibrate with p3 and p4 fixed to zero");
  }
  if (type == "fisheye") {
    set_kalibr_lens(camera,
                    {"pinhole",
                     {camera.fx, camera.fy, camera.cx, camera.cy},
                     "thin_prism_fisheye",
                     {k[0], k[1], p1, p2, k[2], k[3], 0.0, 0.0}},
                    place);
  } else if (type != "frame") {
    throw InputError(fields.place("projection"), "\"" + type + "\" is not supported", "supported: frame, fisheye");
  } else if (k[3] == 0.0) {
    set_opencv_distortion(camera, std::array{k[0], k[1], p1, p2, k[2]}, false, place);
  } else {
    const double error = fit_rational({k[0], k[1], k[2], k[3]}, p1, p2, camera);
    if (!(error < kMostError)) {
      throw InputError(place, "four radial coefficients are not supported", "calibrate with k4 fixed to zero");
    }
    notes.push_back(
        fmt::format("k4: converted to the rational model, which moves pixels by at most {:.1g} pixels", error));
  }
}

// ---- OpenMVG

PlacedCamera openmvg_camera(const Fields& view, const std::string& type) {
  const Fields fields = view.has("value0") ? view.group("value0") : view;
  PlacedCamera result;
  Camera& camera = result.camera;
  camera.width = fields.pixels("width"), camera.height = fields.pixels("height");
  const std::vector<double> centre = fields.numbers("principal_point", 2);
  const double focal = fields.positive("focal_length");
  set_kalibr_lens(camera, {"pinhole", {focal, focal, centre[0], centre[1]}, "none", {}}, fields.place("focal_length"));
  for (const char* const name : {"disto_k1", "disto_k3"}) {
    if (!view.has(name)) continue;
    std::vector<double> k = view.numbers(name);
    k.resize(3, 0.0);
    set_opencv_distortion(camera, std::array{k[0], k[1], 0.0, 0.0, k[2]}, false, view.place(name));
    return result;
  }
  if (view.has("disto_t2")) {
    const std::vector<double> t = view.numbers("disto_t2", 5);
    set_opencv_distortion(camera, std::array{t[0], t[1], t[3], t[4], t[2]}, false, view.place("disto_t2"));
  } else if (view.has("fisheye")) {
    set_opencv_distortion(camera, view.numbers("fisheye", 4), true, view.place("fisheye"));
  } else if (type != "pinhole") {
    throw InputError(fields.place("polymorphic_name"), "\"" + type + "\" is not supported",
                     "supported: pinhole, pinhole_radial_k1, pinhole_radial_k3, pinhole_brown_t2, fisheye");
  }
  return result;
}

}  // namespace

bool has_matlab_camera(const Fields& fields) {
  if (fields.has(property(fields, "IntrinsicMatrix"))) return fields.has(property(fields, "RadialDistortion"));
  return fields.has("RadialDistortion") && (fields.has("FocalLength") || fields.has("K"));
}

CameraList read_matlab(const Fields& fields, const fs::path&) {
  CameraList list{"MATLAB", {}, {"the principal point is counted from 1, as in MATLAB"}};
  list.cameras.push_back(matlab_camera(fields, list.notes));
  return list;
}

CameraList read_matlab_pair(const Fields& fields, const fs::path&) {
  CameraList list{"MATLAB", {}, {"principal points are counted from 1, as in MATLAB"}};
  const Fields first = fields.group("CameraParameters1");
  for (const Fields& each : {first, fields.group("CameraParameters2")}) {
    list.cameras.push_back(matlab_camera(each, list.notes));
  }
  PlacedCamera& right = list.cameras[1];
  right.pose_place = fields.place("RotationOfCamera2");
  if (fields.has("RotationOfCamera2")) {
    const Eigen::Vector3d translation(fields.numbers("TranslationOfCamera2", 3).data());
    // Row vectors are multiplied from the left.
    right.from_previous = pair_of(fields, "RotationOfCamera2", fields.matrix("RotationOfCamera2").transpose(),
                                  board_unit(first, list.notes) * translation);
  } else if (fields.is_group("PoseCamera2")) {
    const Fields pose = fields.group("PoseCamera2");
    const Eigen::Vector3d translation(pose.numbers("Translation", 3).data());
    right.from_previous = pair_of(pose, "R", pose.matrix("R"), board_unit(first, list.notes) * translation);
  }
  return list;
}

CameraList read_bouguet(const Fields& fields, const fs::path&) {
  CameraList list{"Bouguet's toolbox", {}};
  if (fields.has("fc")) {
    list.cameras = {bouguet_camera(fields, "", list.notes)};
    return list;
  }
  list.cameras = {bouguet_camera(fields, "_left", list.notes), bouguet_camera(fields, "_right", list.notes)};
  list.cameras[1].pose_place = fields.place("om, T");
  if (const auto pose = pair_pose(fields)) {
    list.cameras[1].from_previous = Pose{pose->rotation, board_unit(fields, list.notes) * pose->translation};
  }
  return list;
}

CameraList read_opensfm(const Fields& fields, const fs::path&) {
  CameraList list{"OpenSfM", {}};
  list.cameras.push_back(opensfm_camera(fields, list.notes));
  return list;
}

bool has_metashape_camera(const Fields& fields) {
  return fields.has("f") ? fields.has("projection") || fields.has("type") || fields.is_group("resolution")
                         : fields.has("projection") && fields.has("fx") && fields.has("skew");
}

// u = 0.5 width + cx + f x' + b1 x' + b2 y' with p1 and p2 exchanged. PhotoScan's first files have fx, fy, skew, and cx
// from the corner, with p1 and p2 as in OpenCV.
CameraList read_metashape(const Fields& fields, const fs::path&) {
  CameraList list{"Metashape", {}};
  PlacedCamera result;
  Camera& camera = result.camera;
  const Fields size = fields.is_group("resolution") ? fields.group("resolution") : fields;
  camera.width = size.pixels("width"), camera.height = size.pixels("height");
  const bool is_first = !fields.has("f");
  const double focal = fields.positive(is_first ? "fy" : "f");
  const double focal_x = is_first ? fields.positive("fx") : focal + fields.number_or("b1", 0.0);
  const double skew = fields.number_or(is_first ? "skew" : "b2", 0.0);
  const double left = is_first ? 0.0 : 0.5 * camera.width, top = is_first ? 0.0 : 0.5 * camera.height;
  set_skewed_matrix(camera,
                    {focal_x, skew, left + fields.number_or("cx", 0.0) - kHalf, 0.0, focal,
                     top + fields.number_or("cy", 0.0) - kHalf, 0.0, 0.0, 1.0},
                    fields.place(is_first ? "skew" : "b2"), list.notes);
  const double p1 = fields.number_or("p1", 0.0), p2 = fields.number_or("p2", 0.0);
  set_metashape_lens(fields, is_first ? p1 : p2, is_first ? p2 : p1, camera, list.notes);
  list.cameras.push_back(result);
  return list;
}

CameraList read_openmvg(const Fields& fields, const fs::path& path) {
  CameraList list{"OpenMVG", {}};
  const std::vector<Fields> entries = fields.list("intrinsics");
  std::string type = "pinhole";
  for (const Fields& entry : entries) {
    const Fields value = entry.group("value");
    type = text_or(value, "polymorphic_name", type);
    list.cameras.push_back(openmvg_camera(value.group("ptr_wrapper").group("data"), type));
  }
  if (list.cameras.empty()) throw InputError(path.string(), "has no cameras in \"intrinsics\"");
  for (const Fields& entry : entries) list.names.push_back(entry.text("key"));
  return list;
}

CameraList read_middlebury(const Fields& fields, const fs::path&) {
  CameraList list{"Middlebury", {}};
  for (const char* const name : {"cam0", "cam1"}) {
    PlacedCamera placed;
    read_size(fields, "width", "height", placed.camera);
    set_camera_matrix(placed.camera, fields.numbers(name, 9), fields.place(name));
    list.cameras.push_back(placed);
  }
  list.cameras[1].from_previous = baseline_pose(-kBoardUnit * fields.positive("baseline"));
  list.cameras[1].pose_place = fields.place("baseline");
  list.notes.push_back("rectified images; the baseline is in millimetres, as Middlebury has them");
  return list;
}

}  // namespace byre
