#include "ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam::sim {

namespace {

/// Deleter of an Embree object.
template <auto kRelease>
struct Release {
  template <typename Object>
  void operator()(Object* object) const {
    kRelease(object);
  }
};
using Device = std::unique_ptr<RTCDeviceTy, Release<rtcReleaseDevice>>;
using Scene = std::unique_ptr<RTCSceneTy, Release<rtcReleaseScene>>;
using Geometry = std::unique_ptr<RTCGeometryTy, Release<rtcReleaseGeometry>>;

/// One thread and one instruction set, so that the tree and the rays come out the same everywhere.
Device make_device() {
  Device device(rtcNewDevice("threads=1,set_affinity=0,isa=sse4.2"));
  if (device == nullptr) {
    throw Error("Embree cannot start (error {}): the simulator needs a processor with SSE 4.2",
                static_cast<int>(rtcGetDeviceError(nullptr)));
  }
  return device;
}

Scene make_scene(RTCDevice device) {
  Scene scene(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

void attach_mesh(RTCDevice device, RTCScene scene, const TriangleMesh& mesh) {
  const Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              sizeof(Eigen::Vector3f), mesh.vertices_m.size()));
  auto* triangles = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    vertices = std::copy_n(vertex.data(), 3, vertices);
  }
  for (const auto& triangle : mesh.triangles) {
    triangles = std::copy_n(triangle.data(), 3, triangles);
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene, geometry.get());
}

void set_transform(RTCGeometry geometry, unsigned time_step, const Eigen::Affine3d& transform) {
  const Eigen::Matrix<float, 3, 4> columns = transform.matrix().topRows<3>().cast<float>();
  rtcSetGeometryTransform(geometry, time_step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
}

struct EmbreeHit {
  unsigned instance;
  unsigned triangle;
  float range_m;
};

std::optional<EmbreeHit> first_hit(RTCScene scene, const Eigen::Vector3d& origin_m,
                                   const Eigen::Vector3d& direction, double time,
                                   double max_range_m) {
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(origin_m.x());
  query.ray.org_y = static_cast<float>(origin_m.y());
  query.ray.org_z = static_cast<float>(origin_m.z());
  query.ray.dir_x = static_cast<float>(direction.x());
  query.ray.dir_y = static_cast<float>(direction.y());
  query.ray.dir_z = static_cast<float>(direction.z());
  query.ray.tfar = static_cast<float>(max_range_m);
  query.ray.time = static_cast<float>(time);
  query.ray.mask = 0xffffffffU;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return EmbreeHit{query.hit.instID[0], query.hit.primID, query.ray.tfar};
}

std::array<Eigen::Vector3d, 3> corners_m(const TriangleMesh& mesh, unsigned triangle) {
  const auto& index = mesh.triangles[triangle];
  return {mesh.vertices_m[index[0]].cast<double>(), mesh.vertices_m[index[1]].cast<double>(),
          mesh.vertices_m[index[2]].cast<double>()};
}

/// The ray o + t d (in the mesh's frame) against the plane of a triangle with normal n and corner
/// v:
///   t = n . (v - o) / n . d,   cos of incidence = |n . d| / (|n| |d|)
/// `embree_m` is Embree's t, which is more accurate for a ray that is nearly parallel to the plane.
/// Embree rounds the ray to single precision and may hit a triangle that in double precision is
/// behind the origin. No range is negative, so that a search from hit to hit always advances.
RayHit meet_triangle(const TriangleMesh& mesh, unsigned triangle, const Eigen::Vector3d& origin,
                     const Eigen::Vector3d& direction, float embree_m) {
  const auto [a, b, c] = corners_m(mesh, triangle);
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double along = normal.dot(direction);
  const double cosine = std::abs(along) / (normal.norm() * direction.norm());
  RayHit hit{embree_m, std::min(1.0, cosine), mesh.surfaces[triangle]};
  if (cosine > 1e-3) hit.range_m = std::max(0.0, normal.dot(a - origin) / along);
  return hit;
}

/// Embree works in single precision, so it searches a little farther.
float search_radius(double distance_m) { return static_cast<float>(1.001 * distance_m + 1e-3); }

/// The hit of a ray in the world on a shape that stands there. Paint, car windows and clothes take
/// the shade of the instance.
RayHit meet_shape(const TriangleMesh& shape, const Eigen::Affine3d& T_shape_world,
                  std::uint8_t shade, const EmbreeHit& found, const Eigen::Vector3d& origin_m,
                  const Eigen::Vector3d& direction) {
  RayHit hit = meet_triangle(shape, found.triangle, T_shape_world * origin_m,
                             T_shape_world.linear() * direction, found.range_m);
  const Material material = hit.surface.material;
  if (material == Material::kCarPaint || material == Material::kCarGlass ||
      material == Material::kCloth) {
    hit.surface.shade = shade;
  }
  return hit;
}

}  // namespace

struct RayScene::Implementation {
  explicit Implementation(const Scenery& scenery_)
      : scenery(scenery_),
        device(make_device()),
        fixed(make_scene(device.get())),
        moving(make_scene(device.get())) {
    attach_mesh(device.get(), fixed.get(), scenery.fixed);
    for (const TriangleMesh& mesh : scenery.prototypes) {
      Scene scene = make_scene(device.get());
      attach_mesh(device.get(), scene.get(), mesh);
      rtcCommitScene(scene.get());
      prototypes.push_back(std::move(scene));
    }
    for (const Placement& placement : scenery.placements) {
      rtcAttachGeometry(fixed.get(),
                        instance_of(placement.prototype, {placement.T_world_prototype}).get());
      T_prototype_world.push_back(placement.T_world_prototype.inverse());
    }
    rtcCommitScene(fixed.get());
    rtcCommitScene(moving.get());
  }

  const TriangleMesh& shape(int prototype) const {
    return scenery.prototypes[static_cast<std::size_t>(prototype)];
  }
  /// A prototype that stands still, or moves from one transform to the next during a scan.
  Geometry instance_of(int prototype, const std::vector<Eigen::Affine3d>& T_world_prototype) const {
    Geometry instance(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(instance.get(),
                                 prototypes[static_cast<std::size_t>(prototype)].get());
    rtcSetGeometryTimeStepCount(instance.get(), static_cast<unsigned>(T_world_prototype.size()));
    for (unsigned step = 0; step < T_world_prototype.size(); ++step) {
      set_transform(instance.get(), step, T_world_prototype[step]);
    }
    rtcCommitGeometry(instance.get());
    return instance;
  }

  const Scenery& scenery;
  Device device;
  Scene fixed;   ///< geometry 0 is the city's own mesh, 1 + k is placement k
  Scene moving;  ///< geometry k is actor k
  std::vector<Scene> prototypes;
  std::vector<Eigen::Affine3d> T_prototype_world;  ///< of the placements
  std::vector<ActorMotion> actors;
};

RayScene::RayScene(const Scenery& scenery)
    : implementation_(std::make_unique<Implementation>(scenery)) {}
RayScene::~RayScene() = default;

void RayScene::place_actors(const std::vector<ActorMotion>& actors) {
  Implementation& self = *implementation_;
  for (unsigned k = 0; k < self.actors.size(); ++k) rtcDetachGeometry(self.moving.get(), k);
  self.actors.assign(actors.begin(), actors.begin() + static_cast<std::ptrdiff_t>(
                                                          std::min(actors.size(), kMostActors)));
  for (unsigned k = 0; k < self.actors.size(); ++k) {
    const ActorMotion& actor = self.actors[k];
    const Geometry instance =
        self.instance_of(actor.prototype, {actor.T_world_at_start, actor.T_world_at_end});
    rtcAttachGeometryByID(self.moving.get(), instance.get(), k);
  }
  rtcCommitScene(self.moving.get());
}

std::optional<double> RayScene::distance_m(const Eigen::Vector3d& point_m, double reach_m) const {
  /// The state of Embree's search.
  struct Nearest {
    const Implementation& self;
    Eigen::Vector3d point_m;
    double distance_m;
  };
  // Called for every triangle that may be nearer than what was found so far. A placed thing is as
  // much larger as its shape as the first column of its transform is long.
  const auto measure_triangle = [](RTCPointQueryFunctionArguments* arguments) {
    auto& nearest = *static_cast<Nearest*>(arguments->userPtr);
    const Implementation& self = nearest.self;
    const TriangleMesh* mesh = &self.scenery.fixed;
    Eigen::Vector3d local_m = nearest.point_m;
    double scale = 1.0;
    if (arguments->context->instStackSize > 0) {
      const std::size_t k = arguments->context->instID[0] - 1;
      mesh = &self.shape(self.scenery.placements[k].prototype);
      local_m = self.T_prototype_world[k] * local_m;
      scale = self.scenery.placements[k].T_world_prototype.linear().col(0).norm();
    }
    const auto [a, b, c] = corners_m(*mesh, arguments->primID);
    const double distance_m = scale * distance_to_triangle_m(local_m, a, b, c);
    if (distance_m >= nearest.distance_m) return false;
    nearest.distance_m = distance_m;
    arguments->query->radius = search_radius(distance_m);
    return true;
  };
  Nearest nearest{*implementation_, point_m, reach_m};
  RTCPointQuery query{};
  query.x = static_cast<float>(point_m.x());
  query.y = static_cast<float>(point_m.y());
  query.z = static_cast<float>(point_m.z());
  query.radius = search_radius(reach_m);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(implementation_->fixed.get(), &query, &context, measure_triangle, &nearest);
  return nearest.distance_m < reach_m ? std::optional(nearest.distance_m) : std::nullopt;
}

std::optional<RayHit> RayScene::cast(const Eigen::Vector3d& origin_m,
                                     const Eigen::Vector3d& direction, double scan_fraction,
                                     double max_range_m) const {
  const Implementation& self = *implementation_;
  const auto fixed = first_hit(self.fixed.get(), origin_m, direction, 0.0, max_range_m);
  const double nearest_m = fixed ? fixed->range_m : max_range_m;
  if (!self.actors.empty()) {
    const auto moving = first_hit(self.moving.get(), origin_m, direction, scan_fraction, nearest_m);
    if (moving) {
      const ActorMotion& actor = self.actors[moving->instance];
      Eigen::Affine3d T_world_actor;
      T_world_actor.matrix() = (1.0 - scan_fraction) * actor.T_world_at_start.matrix() +
                               scan_fraction * actor.T_world_at_end.matrix();
      return meet_shape(self.shape(actor.prototype), T_world_actor.inverse(), actor.shade, *moving,
                        origin_m, direction);
    }
  }
  if (!fixed) return std::nullopt;
  if (fixed->instance == RTC_INVALID_GEOMETRY_ID) {
    return meet_triangle(self.scenery.fixed, fixed->triangle, origin_m, direction, fixed->range_m);
  }
  const std::size_t k = fixed->instance - 1;
  const Placement& placement = self.scenery.placements[k];
  return meet_shape(self.shape(placement.prototype), self.T_prototype_world[k], placement.shade,
                    *fixed, origin_m, direction);
}

}  // namespace hqslam::sim
