// Mechanisms as edits of a scene's parameters. `render` applies what the manifest's `mechanisms` section says;
// `explain` applies its hypotheses by the same function. At the neutral values the edit leaves every simulated number
// as it was, to the last bit.
//
// Mechanisms of surfaces and lights set the parameters of the same names. Where the target's model does not have them,
// the smallest registered model takes its place that has all parameters of the present one and the mechanism's: diffuse
// becomes coated-diffuse, point becomes sphere. No list says so; a new model is found by its parameters. A target to
// whose model the parameters are not optional (the f0 of a metal) is one that the mechanism cannot apply to. A model
// that reads a file gives way to none that would not read it. light.direction and light.lobe turn and narrow what is
// there. Mechanisms of boards do not change scenes. Of cameras, those of the stage "lens" replace terms of the
// distortion and optics.defocus gives views a lens; what happens behind the lens is the matter of
// render/sensor_chain.h.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"
#include "scene/scene.h"

namespace gonio::scene {

// Names of the surfaces or lights that `mechanism` can apply to; empty for scene, camera and board mechanisms.
std::vector<std::string> mechanism_targets(const Appearance& appearance, const mechanism::Mechanism& mechanism);

// Can a scene have both on this surface, one after the other in the order of their ids, as a manifest's are applied?
// What scenes leave as they are stands beside anything.
bool go_together(const Surface& surface, const mechanism::Mechanism& a, const mechanism::Mechanism& b);

// Does this room know how to apply it to a scene's appearance (targets scene, surface, light)?
bool applies_to_scenes(const mechanism::Mechanism& mechanism);

// Mechanisms that explain simulates and a path tracer of this kind cannot: re-radiation from band to band, and a share
// of the caustics that it finds or does not find by itself. They leave scenes as they are.
bool beyond_rendering(const mechanism::Mechanism& mechanism);

// Edits `appearance`. `use.on` empty: all that it can apply to; a parameter is one number, or one per name in `on`;
// parameters left out are neutral. `centre_m`: Scene::centre_m. Error(data) at `place` for unknown names and wrong
// counts.
void apply_mechanism(Appearance& appearance, const mechanism::Mechanism& mechanism, const manifest::MechanismUse& use,
                     Vec3 centre_m, const std::string& place);

// The camera's part: lens.* replace the distortion terms of the same names; others leave the camera as it is.
void apply_mechanism(manifest::Camera& camera, const std::string& name, const mechanism::Mechanism& mechanism,
                     const manifest::MechanismUse& use, const std::string& place);

// What a mechanism of cameras amounts to for the camera `name` (or for one picture of it, where `on` names pictures: a
// name of `on` is a camera's or a picture's), one number per parameter in its order; nothing where it
// is not meant or neutral. Error(data) at `place` also for values beyond the parameters' bounds (but for the lens'
// terms, which fits may take anywhere).
std::optional<std::vector<double>> camera_amounts(const mechanism::Mechanism& mechanism,
                                                  const manifest::MechanismUse& use, const std::string& name,
                                                  const std::string& place, const std::string& picture = "");

// The view's part: what moves pixels, and optics.defocus; others leave it as it is. "on" may name pictures as well as
// cameras: the amounts of a picture's own name come first. The lens' terms for all of a camera's pictures are the
// camera's part.
void apply_mechanism(View& view, const mechanism::Mechanism& mechanism, const manifest::MechanismUse& use,
                     const std::string& place);
void apply_amounts(View& view, const mechanism::Mechanism& mechanism, const std::vector<double>& amounts);

// Does it act on the rays of a view: on where things are seen?
bool moves_pixels(const mechanism::Mechanism& mechanism);

// "surface.interface:f0=0.05,alpha=0.15,on=bunny,on=cup" as typed on a command line. Error(usage) at `place`.
std::pair<const mechanism::Mechanism*, manifest::MechanismUse> parse_mechanism(const std::string& text,
                                                                               const std::string& place);

}  // namespace gonio::scene
