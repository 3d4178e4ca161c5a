#include "byre/input_error.h"

namespace byre {
namespace {

std::string sentence(std::string_view place, std::string_view reason, std::string_view remedy) {
  std::string text;
  text.append(place).append(": ").append(reason);
  if (!remedy.empty()) text.append(" (").append(remedy).append(")");
  return text;
}

}  // namespace

InputError::InputError(std::string_view place, std::string_view reason, std::string_view remedy)
    : std::runtime_error(sentence(place, reason, remedy)), place_(place), reason_(reason), remedy_(remedy) {}

}  // namespace byre
