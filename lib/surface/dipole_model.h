// What the dipole models share: parameters, the interface's lobes, distances, and the registry's face. A model supplies
// its Subsurface, derived from DipoleSubsurface.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "surface/dipole_distances.h"
#include "surface/dipole_interface.h"
#include "surface/dipole_medium.h"
#include "surface/subsurface.h"
#include "surface/surface.h"

namespace gonio::surface {

enum DipoleParameter : std::size_t { dipole_eta, dipole_alpha, dipole_sigma_a, dipole_sigma_s, dipole_g };
std::vector<manifest::ParameterInfo> dipole_parameters();

// Of the standard dipole (models/dipole.cpp): depths of its two sources, and its whole reflectance.
std::array<double, 2> standard_depths(const DipoleMedium& medium, const InteriorFresnel& interior);
double standard_reflectance(const DipoleMedium& medium, const InteriorFresnel& interior);

class DipoleSubsurface : public Subsurface, public Prepared {
 public:
  DipoleSubsurface(const Values& values, bool directional);

  double sample_distance(int band, double u) const override { return distances(band).sample(u); }
  double distance_density(int band, double distance_m) const override { return distances(band).density(distance_m); }
  double reach_m() const override { return reach_m_; }
  Entrance enter(const Values& values, Vec3 wi, Vec2 u) const override;
  Entrance leave(const Values& values, Vec3 travel, Vec2 u) const override;
  double eta() const override { return eta_; }

  bool scatters() const { return media_[0].scatters() || media_[1].scatters() || media_[2].scatters(); }
  // Exitance over flux that enters, uniform light on a plane: the reflectance beneath the interface.
  const Rgb& diffuse_reflectance() const { return reflectance_; }
  const DipoleMedium& medium(int band) const { return media_[static_cast<std::size_t>(band)]; }
  const InteriorFresnel& interior() const { return interior_; }

 protected:
  using Sources = std::array<DipoleDistances::Source, 2>;
  void set_distances(int band, const Sources& sources);
  void finish_distances();  // after all bands
  void set_reflectance(const Rgb& reflectance) { reflectance_ = reflectance; }
  double normaliser() const { return normaliser_; }  // 1 / (pi T_mean)

 private:
  const DipoleDistances& distances(int band) const { return distances_[static_cast<std::size_t>(band)]; }
  double eta_, normaliser_;
  bool directional_;
  InteriorFresnel interior_;
  std::array<DipoleMedium, 3> media_;
  std::array<DipoleDistances, 3> distances_;
  double reach_m_ = 0;
  Rgb reflectance_;
};

// evaluate(), sample() and pdf() are the interface's; sample() also sends paths into the medium (Sample::below).
// albedo(): what uniform light on a plane makes it reflect, E(wo) + T(wo) R, exact to what the tables of E and the
// quadrature of R are (before prepare(): R of the standard dipole).
class DipoleModel : public Model {
 public:
  Rgb evaluate(const Values& values, Vec3 wo, Vec3 wi) const override;
  Sample sample(const Values& values, Vec3 wo, Vec2 u, double u_lobe) const override;
  double pdf(const Values& values, Vec3 wo, Vec3 wi) const override;
  // The interface's; what comes out of the medium is unpolarized.
  optics::MuellerRgb mueller(const Values& values, Vec3 wo, Vec3 wi) const override;
  Rgb albedo(const Values& values, Vec3 wo) const override;
  const Subsurface* subsurface(const Values& values) const override;
  std::shared_ptr<const Prepared> prepare(const Values& values, const std::filesystem::path& file,
                                          const std::string& place) const override;

 protected:
  virtual std::shared_ptr<const DipoleSubsurface> build(const Values& values) const = 0;

 private:
  Rgb reflectance(const Values& values) const;
  double share(const Values& values, Vec3 wo) const;  // of samples for the interface's reflection
};

}  // namespace gonio::surface
