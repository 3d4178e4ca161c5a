#pragma once

#include "byre/motion/gyroscope_mounting.h"
#include "byre/motion/standing.h"
#include "byre/motion/wheel_mounting.h"

#include <map>
#include <optional>
#include <string>

namespace byre {

// Mounting of wheels and gyroscope, kept between drives. The gyroscope's bias is not kept: it changes from day to day.
struct KnownMounting {
  std::optional<WheelMounting> wheels;
  std::optional<GyroscopeMounting> gyroscope;
  double time_offset = 0.0;   // delay of wheel stamps against the camera's, seconds
  std::optional<KnownUp> up;  // in the map

  bool is_empty() const { return !wheels && !gyroscope && !up; }
};

// Writes the mounting to notes of a map, under the keys "wheels", "gyroscope" and "gravity": readable numbers with
// names, which mounting_in parses. Unknown parts have no note.
void note_mounting(const KnownMounting& mounting, std::map<std::string, std::string>& notes);

// Reads the notes of note_mounting; ignores notes in another format.
KnownMounting mounting_in(const std::map<std::string, std::string>& notes);

// The mounting for a map whose lengths are multiplied by a factor.
KnownMounting scaled(KnownMounting mounting, double factor);

// The mounting of another point of the body. Its unknown height above the base stays zero.
KnownMounting moved(KnownMounting mounting, const Pose& before_from_after);

// Whether two estimates of a mounting differ by more than their uncertainty and the usual change from drive to drive.
bool is_contradicted(const WheelMounting& known, const WheelMounting& found);

// Note of a map whose scale only wheels measured, with the key kMetresNote: "sigma_by_wheels SHARE".
inline constexpr const char* kMetresNote = "metres";
std::string metres_note(double sigma);

}  // namespace byre
