// Parameters of a reflectance table's forward model and where their values go: the free numbers of the base surface,
// per band where they are colours, and those of the candidates.
//
// surface.diffuse-roughness, surface.interface, surface.specular, surface.anisotropy, surface.retro-reflection,
// surface.metal, surface.sheen, surface.residue and surface.walls set parameters of registered models, as `render` does
// (scene/mechanisms.h): the base model gives way to the smallest that can express them all; what it has free already is
// no candidate. surface.thin-film and surface.micro-ridges come as several candidates of one family, each with its own
// range of thickness or azimuth: fringes and lobes have many local minima, and a range holds one of them.
//
// A table whose scale is not trusted states a `gain` among its parameters, by which every reflectance is multiplied.
#pragma once
#include <string>
#include <vector>

#include "explain/tables/reflectance_surface.h"
#include "mechanism/form.h"

namespace gonio::explain::tables {

struct ReflectanceSlot {
  enum class Kind { base, gain, mechanism, film, ridges, fluorescence };
  Kind kind = Kind::base;
  std::string name;        // of the surface model's parameter
  std::size_t band = all;  // base: a colour's band
  std::size_t which = 0;   // film, ridges, fluorescence: number of the parameter
  std::string mechanism;   // id; empty for the base surface
  bool switches = false;   // mechanism: away from `neutral` it needs the full model
  const mechanism::Form* form =
      nullptr;  // of the mechanism, which acts where the number that switches it is not neutral
  double neutral = 0;
  static constexpr std::size_t all = static_cast<std::size_t>(-1);
};

struct ReflectanceParameters {
  std::string surface, place;                                         // name in "surfaces"; of the table, for messages
  const surface::Model *base_model = nullptr, *full_model = nullptr;  // full: with every mechanism in play
  std::vector<surface::Values> base_values;                           // of base_model, per triple of bands
  std::shared_ptr<const surface::Prepared> prepared;
  std::vector<Parameter> parameters;
  std::vector<ReflectanceSlot> slots;  // one per parameter
  std::vector<std::size_t> base;
  std::vector<Candidate> candidates;
  double gain = 1;  // where it is not free

  ReflectanceState state(std::span<const double> values) const;
};
ReflectanceParameters reflectance_parameters(const manifest::Document& document, const std::string& table_name,
                                             const Table& table, const ReflectanceRows& rows);

}  // namespace gonio::explain::tables
