#include "byre/simulation/cowshed/ray_casting.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

namespace byre {
namespace {

template <typename Value>
Value* new_buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format, std::size_t count) {
  return static_cast<Value*>(rtcSetNewGeometryBuffer(geometry, type, slot, format, sizeof(Value), count));
}

void set_vertices(RTCGeometry geometry, unsigned time_step, const std::vector<Eigen::Vector3f>& vertices) {
  std::ranges::copy(vertices, new_buffer<Eigen::Vector3f>(geometry, RTC_BUFFER_TYPE_VERTEX, time_step,
                                                          RTC_FORMAT_FLOAT3, vertices.size()));
}

RTCGeometry geometry_of(RTCDevice device, const QuadMesh& begin, const QuadMesh& end) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
  const bool moves = &begin != &end;
  rtcSetGeometryTimeStepCount(geometry, moves ? 2 : 1);
  set_vertices(geometry, 0, begin.vertices);
  if (moves) set_vertices(geometry, 1, end.vertices);
  std::ranges::copy(begin.quads, new_buffer<std::array<std::uint32_t, 4>>(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                                          RTC_FORMAT_UINT4, begin.quads.size()));
  rtcCommitGeometry(geometry);
  return geometry;
}

#if RTC_VERSION_MAJOR >= 4
void intersect_coherent(const int* valid, RTCScene scene, RTCRayHit8& rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &rays, &arguments);
}

void find_occlusion(RTCScene scene, RTCRay& ray) {
  rtcOccluded1(scene, &ray);
}
#else
void intersect_coherent(const int* valid, RTCScene scene, RTCRayHit8& rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, &rays);
}

void find_occlusion(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
#endif

}  // namespace

RayScene::RayScene(const QuadMesh& begin, const QuadMesh& end, unsigned id, Build build) {
  assert(begin.quads == end.quads && begin.vertices.size() == end.vertices.size());
  device_.reset(rtcNewDevice("threads=1"));  // one thread, so that builds are deterministic
  if (!device_) throw std::runtime_error("Embree cannot be started");
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneBuildQuality(scene_.get(), build == Build::careful ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_LOW);
  if (!begin.quads.empty()) {
    const RTCGeometry geometry = geometry_of(device_.get(), begin, end);
    rtcAttachGeometryByID(scene_.get(), geometry, id);
    rtcReleaseGeometry(geometry);  // the scene holds a reference
  }
  rtcCommitScene(scene_.get());
  if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::runtime_error("Embree cannot hold the scene");
}

void RayScene::intersect(const int* valid, RTCRayHit8& rays) const {
  intersect_coherent(valid, scene_.get(), rays);
}

bool RayScene::is_free(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const {
  constexpr float kEnd = 1e-3f;  // share of the segment left out at both ends, whose points lie on surfaces
  const Eigen::Vector3f way = to - from;
  RTCRay ray{};
  ray.org_x = from.x();
  ray.org_y = from.y();
  ray.org_z = from.z();
  ray.dir_x = way.x();
  ray.dir_y = way.y();
  ray.dir_z = way.z();
  ray.tnear = kEnd;
  ray.tfar = 1.0f - kEnd;
  ray.mask = ~0u;
  find_occlusion(scene_.get(), ray);
  return ray.tfar >= 0.0f;  // Embree sets tfar to minus infinity on a hit
}

}  // namespace byre
