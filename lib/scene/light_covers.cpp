#include "scene/light_covers.h"

#include "light/near_environment.h"
#include "light/polarized_emitter.h"

namespace gonio::scene {
namespace {

constexpr const char *polarization = "light.polarization", *near_environment = "light.near-environment";

// From the scene's centre; zero for lamps that are all round.
Vec3 towards(const Light& light, Vec3 centre_m) {
  Vec3 arm;
  if (const auto given = light.parameters.find("towards"); given != light.parameters.end())
    arm = given->second.vector();
  else if (const auto place = light.parameters.find("position_m"); place != light.parameters.end())
    arm = place->second.vector() - centre_m;
  return norm(arm) > 0 ? normalized(arm) : Vec3{};
}

}  // namespace

bool covers(const mechanism::Mechanism& mechanism) {
  return mechanism.id == polarization || mechanism.id == near_environment;
}

bool can_cover(const Light& light, const mechanism::Mechanism& mechanism) {
  if (mechanism.id == polarization)
    return light.parameters.contains("towards") || light.parameters.contains("position_m");
  return light.model->info().id == "directional" || (light.emitter && light.emitter->infinite());
}

void cover(Light& light, const mechanism::Mechanism& mechanism, const Amounts& amounts, Vec3 centre_m) {
  if (mechanism.id == near_environment) {
    const light::Walls walls{centre_m, 1 / amounts[0]};
    light.emitter = std::make_shared<const light::NearEnvironment>(light.emitter, walls);
    return;
  }
  const Vec3 axis = towards(light, centre_m);
  if (axis == Vec3{}) return;  // in the centre itself: no sheet stands before it
  const light::Sheet sheet = light::Sheet::before(axis, amounts[0], amounts[1]);
  light.emitter = std::make_shared<const light::PolarizedEmitter>(light.emitter, sheet);
}

std::shared_ptr<const light::Emitter> covered_as(const std::shared_ptr<const light::Emitter>& before,
                                                 std::shared_ptr<const light::Emitter> fresh) {
  if (const auto* sheeted = dynamic_cast<const light::PolarizedEmitter*>(before.get()))
    return std::make_shared<const light::PolarizedEmitter>(covered_as(sheeted->bare(), std::move(fresh)),
                                                           sheeted->sheet());
  if (const auto* walled = dynamic_cast<const light::NearEnvironment*>(before.get()))
    return std::make_shared<const light::NearEnvironment>(covered_as(walled->bare(), std::move(fresh)),
                                                          walled->walls());
  return fresh;
}

}  // namespace gonio::scene
