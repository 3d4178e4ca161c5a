#pragma once

#include "byre/simulation/cowshed/quad_mesh.h"

#include <memory>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace byre {

// Intersects rays with a mesh by Embree (Wald 2014). Deterministic, thread-safe for const calls.
class RayScene {
 public:
  // careful: slow build, fast queries, for many frames; quick: fast build for one frame.
  enum class Build : std::uint8_t { careful, quick };

  // id: geomID of hits on this scene. The mesh is copied.
  RayScene(const QuadMesh& mesh, unsigned id, Build build = Build::careful) : RayScene(mesh, mesh, id, build) {}

  // A moving mesh: rays intersect it at their time, from 0 (begin) to 1 (end). Precondition: the meshes differ only in
  // their vertices.
  RayScene(const QuadMesh& begin, const QuadMesh& end, unsigned id, Build build);

  // Shortens the rays of a packet to their first hit on this scene. valid: -1 for active rays, 0 for others; both
  // aligned as Embree requires.
  void intersect(const int* valid, RTCRayHit8& rays) const;

  // Whether nothing lies between two points, exclusive of both.
  bool is_free(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

 private:
  struct Release {
    void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
    void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace byre
