#pragma once

#include "byre/simulation/quad_mesh.h"

#include <memory>

#include <embree3/rtcore.h>

namespace byre {

// Finds where rays meet a mesh, with Embree (Wald 2014). The same rays give the same hits, whichever thread asks.
class RayScene {
 public:
  enum class Build : std::uint8_t { careful, quick };  // careful for many frames, quick for one

  // id: what hits on this scene have as geomID. The mesh is copied.
  RayScene(const QuadMesh& mesh, unsigned id, Build build = Build::careful) : RayScene(mesh, mesh, id, build) {}

  // A mesh that moves: rays meet it as it is at their time, from 0, at the beginning, to 1, at the end. Precondition:
  // the meshes differ in where their vertices are, and in nothing else.
  RayScene(const QuadMesh& begin, const QuadMesh& end, unsigned id, Build build);

  // Makes the rays of a packet end at this scene where it is nearer than where they end so far. valid: -1 for the rays
  // that count, 0 for the others; both are aligned as Embree asks.
  void intersect(const int* valid, RTCRayHit8& rays) const;

  // Whether nothing lies between two points, both of them left out.
  bool is_free(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

 private:
  struct Release {
    void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
    void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;  // constant after construction
};

}  // namespace byre
