#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace byre {

// Bad input, detected where a file, an option or a calibration is read. what() reads "place: reason (remedy)".
class InputError : public std::runtime_error {
 public:
  // place: "file", "file:line" or "file: field"; remedy: advice to the user, may be empty. Control characters and
  // invalid UTF-8 are escaped ("\xNN").
  InputError(std::string_view place, std::string_view reason, std::string_view remedy = {});

  const std::string& place() const { return place_; }
  const std::string& reason() const { return reason_; }
  const std::string& remedy() const { return remedy_; }

 private:
  std::string place_;
  std::string reason_;
  std::string remedy_;
};

}  // namespace byre
