#include "scene/placement.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "manifest/sections/mechanism_use.h"
#include "scene/amounts.h"

namespace gonio::scene {
namespace {

using mechanism::Mechanism;
using Edit = void (*)(Instance&, std::span<const double>);

Vec3 middle_of(const Instance& instance) {  // of the box in the object's frame, in the world
  const auto* mesh = std::get_if<std::shared_ptr<const mesh::Mesh>>(&instance.shape);
  if (!mesh || (*mesh)->positions_m.empty()) return instance.world_from_object.translation_m;
  Vec3 lower = (*mesh)->positions_m[0], upper = lower;
  for (const Vec3& p : (*mesh)->positions_m) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  return instance.world_from_object * ((lower + upper) * 0.5);
}

void move(Instance& instance, std::span<const double> a) {
  const Vec3 middle = middle_of(instance);
  const Quaternion turn = quaternion_of_rotation_vector({a[3], a[4], a[5]});
  auto& pose = instance.world_from_object;
  pose.translation_m = middle + matrix_of(turn) * (pose.translation_m - middle) + Vec3{a[0], a[1], a[2]};
  pose.rotation = normalized(turn * pose.rotation);
}

void sink(Instance& instance, std::span<const double> a) {
  instance.world_from_object.translation_m.z -= a[0];
}

template <class F>
void each_vertex(Instance& instance, const F& f) {
  const auto& mesh = std::get<std::shared_ptr<const mesh::Mesh>>(instance.shape);
  auto copy = std::make_shared<mesh::Mesh>(*mesh);
  const std::vector<Vec3> normals =
      mesh->normals.empty() ? mesh::averaged_normals(mesh->positions_m, mesh->triangles) : mesh->normals;
  for (std::size_t i = 0; i < copy->positions_m.size(); ++i) copy->positions_m[i] = f(mesh->positions_m[i], normals[i]);
  instance.shape = std::shared_ptr<const mesh::Mesh>(std::move(copy));
}

void grow(Instance& instance, std::span<const double> a) {
  if (auto* sphere = std::get_if<Sphere>(&instance.shape)) {
    sphere->radius_m *= 1 + a[0];
  } else if (auto* plane = std::get_if<Plane>(&instance.shape)) {
    plane->size_x_m *= 1 + a[0];
    plane->size_y_m *= 1 + a[0];
  } else {
    each_vertex(instance, [&](Vec3 p, Vec3) { return p * (1 + a[0]); });
  }
}

void offset(Instance& instance, std::span<const double> a) {
  if (auto* sphere = std::get_if<Sphere>(&instance.shape))
    sphere->radius_m += a[0];
  else if (std::holds_alternative<Plane>(instance.shape))
    instance.world_from_object.translation_m += instance.world_from_object.rotate({0, 0, a[0]});
  else
    each_vertex(instance, [&](Vec3 p, Vec3 normal) { return p + normal * a[0]; });
}

const std::map<std::string, Edit>& edits() {
  static const std::map<std::string, Edit> all = {
      {"geometry.contact", sink}, {"geometry.offset", offset}, {"geometry.pose", move}, {"geometry.scale", grow}};
  return all;
}

}  // namespace

bool applies_to_objects(const Mechanism& mechanism) {
  return edits().contains(mechanism.id);
}

Instance moved(const Instance& instance, const Mechanism& mechanism, std::span<const double> amounts) {
  Instance result = instance;
  if (!neutral(mechanism, amounts)) edits().at(mechanism.id)(result, amounts);
  return result;
}

void apply_mechanism(std::vector<Instance>& instances, const Mechanism& mechanism, const manifest::MechanismUse& use,
                     const std::string& place) {
  if (!applies_to_objects(mechanism)) return;
  std::vector<std::string> on = use.on;
  if (on.empty())
    for (const Instance& i : instances)
      if (!std::holds_alternative<Plane>(i.shape)) on.push_back(i.id);
  for (std::size_t k = 0; k < on.size(); ++k) {
    const auto found =
        std::find_if(instances.begin(), instances.end(), [&](const Instance& i) { return i.id == on[k]; });
    if (found == instances.end())
      throw Error(Exit::data, place + "/on", "nothing here is called \"" + on[k] + "\"", "name an object");
    *found = moved(*found, mechanism, amounts_of(mechanism, use, k, on.size(), place));
  }
}

}  // namespace gonio::scene
