// Ray casting on Embree 3 (Wald et al. 2014), with a second, double-precision intersection; see ray_caster.h.
//
// Embree sees coordinates relative to the centre of the meshes' box, so that its single precision is spent on their
// extent, and the rays' own double-precision values through the query context. Triangles are hit again in double
// precision by the plane that they span: t = n.(v0 - o) / n.d, barycentric coordinates from the areas at o + t d.
//
// A few analytic shapes are tried one by one, before Embree, which is not asked where the ray misses the box around all
// that it holds; many are left to its tree.
#include "render/ray_caster.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "render/analytic_shape.h"
#include "render/ray_box.h"

namespace gonio::render {
namespace {

constexpr double lift = 1e-6;          // of a triangle's point along its normal, over half the meshes' extent
constexpr double least_cosine = 1e-4;  // between shading normal and viewing ray
constexpr std::size_t few_shapes = 8;  // tried one by one

struct PlacedMesh {  // of one instance; null for analytic shapes. The mesh is shared, not copied: ten million triangles
  std::shared_ptr<const mesh::Mesh> mesh;  // must fit
  Mat3 world_from_object;
  Vec3 origin_m;
  Vec3 position(std::uint32_t vertex) const { return world_from_object * mesh->positions_m[vertex] + origin_m; }
};

struct Query {  // travels through Embree as its context
  RTCIntersectContext context;
  AnalyticRay ray;
  std::uint32_t from = none;
  static constexpr std::uint32_t none = RTC_INVALID_GEOMETRY_ID;
};

struct Marking {  // travels through Embree as its context
  RTCIntersectContext context;
  std::uint32_t instance;
  std::vector<LineMark>* marks;
};

// Notes a triangle and goes on as if it had not been met.
void note_mark(const RTCFilterFunctionNArguments* args) {
  auto& marking = *reinterpret_cast<Marking*>(args->context);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  if (args->valid[0] != 0 && hit.geomID == marking.instance)
    marking.marks->push_back(
        {reinterpret_cast<const RTCRay*>(args->ray)->tfar, normalized(Vec3{hit.Ng_x, hit.Ng_y, hit.Ng_z}), hit.primID});
  args->valid[0] = 0;
}

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, Release>;
using Scene = std::unique_ptr<RTCSceneTy, Release>;

Query* query_of(RTCIntersectContext* context) {
  return reinterpret_cast<Query*>(context);
}

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
  const auto* shape = static_cast<const AnalyticShape*>(args->geometryUserPtr);
  // Rounded outwards by more than an ulp: bounds are single precision, shapes are not.
  const auto down = [](double v) { return static_cast<float>(v - 1e-6 * std::abs(v) - 1e-7); };
  const auto up = [](double v) { return static_cast<float>(v + 1e-6 * std::abs(v) + 1e-7); };
  *args->bounds_o = {down(shape->low.x), down(shape->low.y), down(shape->low.z), 0,
                     up(shape->high.x),  up(shape->high.y),  up(shape->high.z),  0};
}

// Of a shape in Embree's tree, where it is nearer than `limit`.
std::optional<float> reach(const void* shape, const Query& query, unsigned geometry, float limit) {
  const auto distance = distance_to(*static_cast<const AnalyticShape*>(shape), query.ray, query.from == geometry);
  if (!distance || !(static_cast<float>(*distance) < limit)) return {};
  return static_cast<float>(*distance);
}

void analytic_intersect(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0 || args->context->filter) return;  // marks are sought on meshes
  auto* ray_hit = reinterpret_cast<RTCRayHit*>(args->rayhit);
  const auto distance = reach(args->geometryUserPtr, *query_of(args->context), args->geomID, ray_hit->ray.tfar);
  if (!distance) return;
  ray_hit->ray.tfar = *distance;
  ray_hit->hit.geomID = args->geomID;
  ray_hit->hit.primID = 0;
}

void analytic_occluded(const RTCOccludedFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  auto* ray = reinterpret_cast<RTCRay*>(args->ray);
  if (reach(args->geometryUserPtr, *query_of(args->context), args->geomID, ray->tfar))
    ray->tfar = -std::numeric_limits<float>::infinity();
}

PlacedMesh placed(const scene::Instance& instance) {
  const auto* shape = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
  return {shape ? *shape : nullptr, matrix_of(instance.world_from_object.rotation),
          instance.world_from_object.translation_m};
}

// Along growing u, where the triangle's texture coordinates say so.
Vec3 tangent_of(Vec3 ab, Vec3 ac, Vec2 uv_ab, Vec2 uv_ac, Vec3 otherwise) {
  const double area = uv_ab.x * uv_ac.y - uv_ab.y * uv_ac.x;
  return area != 0 ? (ab * uv_ac.y - ac * uv_ab.y) / area : otherwise;
}

}  // namespace

struct RayCaster::Impl {
  Device device{rtcNewDevice(nullptr)};
  Scene scene;
  Vec3 centre_m;
  double lift_m = 0;
  RayBox box;  // around what Embree holds, with room for its rounding to single precision
  std::vector<PlacedMesh> meshes;
  std::vector<AnalyticShape> shapes;  // one per instance, those of meshes without meaning
  std::vector<std::uint32_t> singly;  // instances that are tried one by one
  std::vector<std::uint32_t> surfaces;

  explicit Impl(std::span<const scene::Instance> instances);

  void place_centre();
  void attach_mesh(std::uint32_t instance);
  void attach_shape(std::uint32_t instance);
  RTCRay float_ray(Vec3 origin_m, Vec3 direction, double distance_m) const;
  Vec3 start(const SurfacePoint& from) const;
  bool is_mesh(std::uint32_t instance) const { return meshes[instance].mesh != nullptr; }
  std::optional<SurfacePoint> closest(Query& query, double distance_m = far_away) const;
  bool blocked(Query& query, double distance_m) const;
  void on_triangle(const RTCHit& hit, Vec3 origin_m, Vec3 direction, SurfacePoint& point) const;
  void finish(SurfacePoint& point, std::uint32_t instance, Vec3 direction) const;
};

RayCaster::Impl::Impl(std::span<const scene::Instance> instances) {
  if (!device)
    throw Error(Exit::internal, "Embree", "no device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  for (const scene::Instance& instance : instances) {
    surfaces.push_back(static_cast<std::uint32_t>(instance.surface));
    meshes.push_back(placed(instance));
  }
  place_centre();
  for (const scene::Instance& instance : instances) shapes.push_back(analytic_shape(instance, centre_m));
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    if (!is_mesh(i)) singly.push_back(i);
  if (singly.size() > few_shapes) singly.clear();
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    if (is_mesh(i))
      attach_mesh(i);
    else if (singly.empty())
      attach_shape(i);
  if (!box.empty()) box.widen(1e-5 * max_component(box.high - box.low));
  rtcCommitScene(scene.get());
  if (const RTCError error = rtcGetDeviceError(device.get()); error != RTC_ERROR_NONE)
    throw Error(Exit::internal, "Embree", "scene cannot be built (error " + std::to_string(error) + ")");
}

void RayCaster::Impl::place_centre() {
  for (const PlacedMesh& mesh : meshes)
    for (std::uint32_t v = 0; mesh.mesh && v < mesh.mesh->positions_m.size(); ++v)
      box.add(mesh.position(v), mesh.position(v));
  if (box.empty()) return;
  centre_m = (box.low + box.high) * 0.5;
  lift_m = lift * max_component((box.high - box.low) * 0.5);
}

void RayCaster::Impl::attach_mesh(std::uint32_t instance) {
  const PlacedMesh& placed_mesh = meshes[instance];
  const mesh::Mesh& mesh = *placed_mesh.mesh;
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.positions_m.size()));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (!vertices || !indices) throw Error(Exit::internal, "Embree", "no memory for a mesh");
  for (std::uint32_t v = 0; v < mesh.positions_m.size(); ++v)
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>((placed_mesh.position(v) - centre_m)[axis]);
  for (const auto& triangle : mesh.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene.get(), geometry, instance);
  rtcReleaseGeometry(geometry);
}

void RayCaster::Impl::attach_shape(std::uint32_t instance) {
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryUserData(geometry, &shapes[instance]);
  rtcSetGeometryBoundsFunction(geometry, analytic_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, analytic_intersect);
  rtcSetGeometryOccludedFunction(geometry, analytic_occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene.get(), geometry, instance);
  rtcReleaseGeometry(geometry);
  box.add(shapes[instance].low + centre_m, shapes[instance].high + centre_m);
}

RTCRay RayCaster::Impl::float_ray(Vec3 origin_m, Vec3 direction, double distance_m) const {
  const auto f = [](double v) { return static_cast<float>(v); };
  const Vec3 o = origin_m - centre_m;
  return {f(o.x), f(o.y), f(o.z), 0, f(direction.x), f(direction.y), f(direction.z), 0, f(distance_m), ~0u, 0, 0};
}

Vec3 RayCaster::Impl::start(const SurfacePoint& from) const {
  return is_mesh(from.instance) ? from.position_m + from.geometric_normal * lift_m : from.position_m;
}

void RayCaster::Impl::on_triangle(const RTCHit& hit, Vec3 origin_m, Vec3 direction, SurfacePoint& point) const {
  const PlacedMesh& placed_mesh = meshes[hit.geomID];
  const mesh::Mesh& mesh = *placed_mesh.mesh;
  const auto& triangle = mesh.triangles[hit.primID];
  const Vec3 a = placed_mesh.position(triangle[0]), ab = placed_mesh.position(triangle[1]) - a,
             ac = placed_mesh.position(triangle[2]) - a;
  const Vec3 area = cross(ab, ac);
  point.distance_m = dot(area, a - origin_m) / dot(area, direction);
  point.position_m = origin_m + direction * point.distance_m;
  const Vec3 arm = point.position_m - a;
  const double scale = 1 / dot(area, area);
  const double v = std::clamp(dot(cross(arm, ac), area) * scale, 0.0, 1.0);
  const double w = std::clamp(dot(cross(ab, arm), area) * scale, 0.0, 1.0 - v), u = 1 - v - w;
  point.triangle = hit.primID;
  point.b1 = v;
  point.b2 = w;
  point.geometric_normal = area / norm(area);
  point.normal = point.geometric_normal;
  if (!mesh.normals.empty()) {
    const Vec3 normal = placed_mesh.world_from_object *
                        (mesh.normals[triangle[0]] * u + mesh.normals[triangle[1]] * v + mesh.normals[triangle[2]] * w);
    const double length = norm(normal);
    if (length > 0) point.normal = normal / length;
  }
  const Mat3& axes = placed_mesh.world_from_object;
  point.tangent = {axes(0, 0), axes(1, 0), axes(2, 0)};
  if (!mesh.texture.empty()) {
    const Vec2 at = mesh.texture[triangle[0]], to_b = mesh.texture[triangle[1]], to_c = mesh.texture[triangle[2]];
    point.uv = at * u + to_b * v + to_c * w;
    point.tangent = tangent_of(ab, ac, to_b - at, to_c - at, point.tangent);
  }
}

std::optional<SurfacePoint> RayCaster::Impl::closest(Query& query, double distance_m) const {
  const auto& [origin_m, direction, left_normal] = query.ray;
  std::uint32_t instance = Query::none;
  double nearest = distance_m;
  for (const std::uint32_t i : singly)
    if (const auto distance = distance_to(shapes[i], query.ray, query.from == i); distance && *distance < nearest) {
      nearest = *distance;
      instance = i;
    }
  RTCRayHit ray_hit;
  if (box.met_by(origin_m, direction, nearest)) {
    ray_hit.ray = float_ray(origin_m, direction, nearest);
    ray_hit.hit.geomID = ray_hit.hit.instID[0] = Query::none;
    rtcInitIntersectContext(&query.context);
    rtcIntersect1(scene.get(), &query.context, &ray_hit);
    if (ray_hit.hit.geomID != Query::none) instance = ray_hit.hit.geomID;
  }
  if (instance == Query::none) return {};
  std::optional<SurfacePoint> found(std::in_place);
  SurfacePoint& point = *found;
  if (is_mesh(instance)) {
    on_triangle(ray_hit.hit, origin_m, direction, point);
  } else {
    if (singly.empty()) nearest = distance_to(shapes[instance], query.ray, query.from == instance).value_or(nearest);
    const AnalyticHit hit = hit_at(shapes[instance], query.ray, nearest);
    point.distance_m = hit.distance_m;
    point.position_m = hit.position_m;
    point.geometric_normal = point.normal = hit.normal;
    point.uv = hit.uv;
    point.tangent = hit.tangent;
  }
  finish(point, instance, direction);
  return found;
}

void RayCaster::Impl::finish(SurfacePoint& point, std::uint32_t instance, Vec3 direction) const {
  point.instance = instance;
  point.surface = surfaces[instance];
  point.outside = !(dot(point.geometric_normal, direction) > 0);
  if (!point.outside) point.geometric_normal = -point.geometric_normal;
  if (dot(point.normal, point.geometric_normal) < 0) point.normal = -point.normal;
  const double cosine = -dot(point.normal, direction);
  if (cosine < least_cosine) point.normal = normalized(point.normal - direction * (least_cosine - cosine));
}

bool RayCaster::Impl::blocked(Query& query, double distance_m) const {
  for (const std::uint32_t i : singly)
    if (const auto distance = distance_to(shapes[i], query.ray, query.from == i); distance && *distance < distance_m)
      return true;
  if (!box.met_by(query.ray.origin_m, query.ray.direction, distance_m)) return false;
  rtcInitIntersectContext(&query.context);
  RTCRay ray = float_ray(query.ray.origin_m, query.ray.direction, distance_m);
  rtcOccluded1(scene.get(), &query.context, &ray);
  return ray.tfar < 0;
}

RayCaster::RayCaster(std::span<const scene::Instance> instances) : impl_(std::make_unique<Impl>(instances)) {}
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;

std::optional<SurfacePoint> RayCaster::closest(Vec3 origin_m, Vec3 direction) const {
  Query query{.context = {}, .ray = {origin_m, direction, {}}};
  return impl_->closest(query);
}

std::optional<SurfacePoint> RayCaster::closest_from(const SurfacePoint& from, Vec3 direction) const {
  Query query{.context = {}, .ray = {impl_->start(from), direction, from.geometric_normal}, .from = from.instance};
  auto point = impl_->closest(query);
  // From where the surface is, not from where the ray was lifted to: media attenuate over this distance.
  if (point) point->distance_m = std::max(0.0, dot(point->position_m - from.position_m, direction));
  return point;
}

bool RayCaster::occluded(const SurfacePoint& from, Vec3 direction, double distance_m) const {
  if (!(dot(from.geometric_normal, direction) > 0)) return true;
  Query query{.context = {}, .ray = {impl_->start(from), direction, from.geometric_normal}, .from = from.instance};
  return impl_->blocked(query, distance_m);
}

bool RayCaster::blocked(Vec3 origin_m, Vec3 direction, double distance_m) const {
  Query query{.context = {}, .ray = {origin_m, direction, {}}};
  return impl_->blocked(query, distance_m);
}

std::vector<SurfacePoint> RayCaster::crossings(std::uint32_t instance, Vec3 origin_m, Vec3 direction,
                                               double distance_m) const {
  std::vector<SurfacePoint> found;
  const auto next = [&](const SurfacePoint* from, double left_m) {
    Query query{.context = {},
                .ray = {origin_m, direction, from ? from->geometric_normal : Vec3{}},
                .from = from ? from->instance : Query::none};
    query.ray.origin_m = from ? impl_->start(*from) : origin_m;
    return impl_->closest(query, left_m);
  };
  double walked = 0;
  for (auto point = next(nullptr, distance_m); point;) {
    walked += point->distance_m;
    if (walked > distance_m) break;
    if (point->instance == instance) found.push_back(*point);
    const SurfacePoint other_side = beyond(*point);
    point = next(&other_side, distance_m - walked);
  }
  return found;
}

void RayCaster::mark(std::uint32_t instance, Vec3 origin_m, Vec3 direction, double distance_m,
                     std::vector<LineMark>& marks) const {
  if (!impl_->is_mesh(instance)) {
    std::uint32_t number = 0;
    for (const SurfacePoint& point : crossings(instance, origin_m, direction, distance_m))
      marks.push_back({dot(point.position_m - origin_m, direction), point.geometric_normal, number++});
    return;
  }
  Marking marking{.context = {}, .instance = instance, .marks = &marks};
  rtcInitIntersectContext(&marking.context);
  marking.context.filter = note_mark;
  RTCRayHit ray_hit{impl_->float_ray(origin_m, direction, distance_m), {}};
  ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene.get(), &marking.context, &ray_hit);
}

SurfacePoint RayCaster::marked(std::uint32_t instance, Vec3 origin_m, Vec3 direction, double distance_m,
                               const LineMark& mark) const {
  if (!impl_->is_mesh(instance)) return crossings(instance, origin_m, direction, distance_m).at(mark.number);
  RTCHit hit{};
  hit.geomID = instance;
  hit.primID = mark.number;
  SurfacePoint point;
  impl_->on_triangle(hit, origin_m, direction, point);
  impl_->finish(point, instance, direction);
  return point;
}

}  // namespace gonio::render
