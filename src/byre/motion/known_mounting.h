#pragma once

#include "byre/motion/gyroscope_mounting.h"
#include "byre/motion/standing.h"
#include "byre/motion/wheel_mounting.h"

#include <map>
#include <optional>
#include <string>

namespace byre {

// How wheels and a gyroscope are mounted, as it is kept from one drive to the next. The gyroscope's bias is not: it is
// another one each day.
struct KnownMounting {
  std::optional<WheelMounting> wheels;
  std::optional<GyroscopeMounting> gyroscope;
  double time_offset = 0.0;   // seconds that wheels stamp later than the camera
  std::optional<KnownUp> up;  // in the map

  bool is_empty() const { return !wheels && !gyroscope && !up; }
};

// As notes of a map, by the keys "wheels", "gyroscope" and "gravity": numbers with their names, for people and for
// mounting_in. What is not known has no note.
void note_mounting(const KnownMounting& mounting, std::map<std::string, std::string>& notes);

// What is noted; a note that somebody else wrote tells nothing.
KnownMounting mounting_in(const std::map<std::string, std::string>& notes);

// The mounting in a map whose lengths are multiplied by a factor.
KnownMounting scaled(KnownMounting mounting, double factor);

// The mounting of another point of the body. Its height above the base stays unknown.
KnownMounting moved(KnownMounting mounting, const Pose& before_from_after);

// Whether motions tell a mounting that is not the one that was known: they differ by more than both leave open, and
// than a drive changes.
bool is_contradicted(const WheelMounting& known, const WheelMounting& found);

// Note of a map, with the key kMetresNote, whose metres wheels alone measured: "sigma_by_wheels SHARE".
inline constexpr const char* kMetresNote = "metres";
std::string metres_note(double sigma);

}  // namespace byre
