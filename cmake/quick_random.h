// Included first when compiling with Clang. The random numbers of libstdc++ need the logarithm of the engine's range in
// long double. GCC computes it at compile time, Clang for each number, which takes half the time of many tests. These
// specialisations give the same numbers without it.
#pragma once

#include <cmath>
#include <random>

#ifdef __GLIBCXX__
namespace std {

#define BYRE_QUICK_CANONICAL(Real, digits, Engine, count)                      \
  template <>                                                                  \
  inline Real generate_canonical<Real, digits, Engine>(Engine & random) {      \
    constexpr Real kValues = static_cast<Real>(Engine::max()) + Real{1};       \
    Real sum = 0, scale = 1;                                                   \
    for (int i = 0; i < count; ++i) {                                          \
      sum += static_cast<Real>(random()) * scale;                              \
      scale *= kValues;                                                        \
    }                                                                          \
    const Real canonical = sum / scale;                                        \
    return canonical < Real{1} ? canonical : std::nextafter(Real{1}, Real{0}); \
  }
BYRE_QUICK_CANONICAL(double, 53, mt19937_64, 1)
BYRE_QUICK_CANONICAL(double, 53, mt19937, 2)
BYRE_QUICK_CANONICAL(float, 24, mt19937_64, 1)
BYRE_QUICK_CANONICAL(float, 24, mt19937, 1)
#undef BYRE_QUICK_CANONICAL

}  // namespace std
#endif
