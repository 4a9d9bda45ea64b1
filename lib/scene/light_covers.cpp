#include "scene/light_covers.h"

#include "light/near_environment.h"
#include "light/polarized_emitter.h"

namespace gonio::scene {

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
