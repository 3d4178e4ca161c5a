#include "byre/input_error.h"

#include "byre/base/printable.h"

namespace byre {
namespace {

std::string sentence(std::string_view place, std::string_view reason, std::string_view remedy) {
  std::string text;
  text.append(place).append(": ").append(reason);
  if (!remedy.empty()) text.append(" (").append(remedy).append(")");
  return printable(text);
}

}  // namespace

InputError::InputError(std::string_view place, std::string_view reason, std::string_view remedy)
    : std::runtime_error(sentence(place, reason, remedy)),
      place_(printable(place)),
      reason_(printable(reason)),
      remedy_(printable(remedy)) {}

}  // namespace byre
