#pragma once

#include "byre/viewer/picture.h"

#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace byre {

inline cv::Mat decoded(const std::vector<std::byte>& png) {
  return cv::imdecode(cv::Mat(1, static_cast<int>(png.size()), CV_8U, const_cast<std::byte*>(png.data())),
                      cv::IMREAD_COLOR);
}

inline Colour colour_at(const cv::Mat& drawn, int x, int y) {
  const cv::Vec3b bgr = drawn.at<cv::Vec3b>(y, x);
  return {bgr[2], bgr[1], bgr[0]};
}

// Number of moves in the path of an SVG class: one per filled symbol, one per stroke for stroked symbols.
inline int moves_in_class(const std::string& svg, const std::string& name) {
  const std::size_t group = svg.find("class=\"" + name + "\"");
  if (group == std::string::npos) return 0;
  const std::size_t last_path = svg.rfind(" d=\"", svg.find("</g>", group));
  const std::size_t end = svg.find('"', last_path + 4);
  return static_cast<int>(std::count(svg.begin() + static_cast<std::ptrdiff_t>(last_path),
                                     svg.begin() + static_cast<std::ptrdiff_t>(end), 'M'));
}

// Whether all elements are closed in order.
inline bool is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (std::count(tag.begin(), tag.end(), '"') % 2 != 0 || tag.find('<') != std::string::npos) return false;
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(tag.substr(0, tag.find_first_of(" \n")));
    }
  }
  return open.empty();
}

}  // namespace byre
