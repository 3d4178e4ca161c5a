#include "byre/io/image/opencv_library.h"

#include "byre/input_error.h"

#include <string>

#include <dlfcn.h>

namespace byre {
namespace {

std::string reason_of_failure() {
  const char* const reason = dlerror();
  return reason ? std::string("cannot be used: ") + reason : "cannot be used";
}

InputError unusable(const char* name) {
  return {name, reason_of_failure(), "install this OpenCV module in the version used to build byre"};
}

// The library stays loaded.
void* load(const char* name) {
  void* const library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) throw unusable(name);
  return library;
}

}  // namespace

void* find_function(OpencvLibrary library, const char* symbol) {
  const char* const name = library == OpencvLibrary::images ? BYRE_OPENCV_IMAGES : BYRE_OPENCV_VIDEOS;
  void* const function = dlsym(load(name), symbol);
  if (function == nullptr) throw unusable(name);
  return function;
}

}  // namespace byre
