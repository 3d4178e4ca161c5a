// Images as numpy arrays.

#include "bindings.h"

namespace byre::python {
namespace {

constexpr const char* kPictures =
    "an image needs uint8 or uint16, height x width, or uint8, height x width x 3, in native byte order";
constexpr const char* kDepths =
    "a depth image needs uint16 (units) or float32 (metres), height x width, in native byte order";

bool is_of(const py::array& image, char kind, py::ssize_t size) {
  return image.dtype().kind() == kind && image.itemsize() == size && image.dtype().byteorder() != '>';
}

PixelFormat depth_format(const py::array& image) {
  if (image.ndim() == 2 && is_of(image, 'u', 2)) return PixelFormat::depth16;
  if (image.ndim() == 2 && is_of(image, 'f', 4)) return PixelFormat::depth_metres;
  throw py::type_error(kDepths);
}

PixelFormat picture_format(const py::array& image, const std::optional<PixelFormat>& given) {
  const bool is_flat = image.ndim() == 2 || (image.ndim() == 3 && image.shape(2) == 1);
  const bool is_colour = image.ndim() == 3 && image.shape(2) == 3 && is_of(image, 'u', 1);
  if (is_colour) return given.value_or(PixelFormat::bgr8);
  if (is_flat && is_of(image, 'u', 1)) return PixelFormat::grey8;
  if (is_flat && is_of(image, 'u', 2)) return PixelFormat::grey16;
  throw py::type_error(kPictures);
}

// Borrows the array's memory: rows may be strided, pixels within a row must be packed.
ImageView view_of(const py::array& image, PixelFormat format, int bits) {
  if (image.size() == 0) return {};
  const py::ssize_t channels = image.ndim() == 3 ? image.shape(2) : 1;
  const bool is_packed = image.strides(1) == channels * image.itemsize() && image.strides(0) > 0 &&
                         (channels == 1 || image.strides(2) == image.itemsize());
  if (!is_packed) throw py::value_error("pixels within a row must be contiguous: use numpy.ascontiguousarray");
  ImageView view{image.data(), static_cast<int>(image.shape(1)), static_cast<int>(image.shape(0))};
  view.stride = static_cast<std::size_t>(image.strides(0));
  view.format = format;
  view.bits = bits;
  return view;
}

}  // namespace

CameraImages images_of(const py::array& left, const std::optional<py::array>& right,
                       const std::optional<py::array>& depth, const std::optional<PixelFormat>& format, int bits) {
  CameraImages images{view_of(left, picture_format(left, format), bits)};
  if (right) images.right = view_of(*right, picture_format(*right, format), bits);
  if (depth) images.depth = view_of(*depth, depth_format(*depth), bits);
  return images;
}

}  // namespace byre::python
