// A surface as reflectance tables see it: a registered model in any number of bands, and three terms that no registered
// model has.
//   f = f_model
//     + lobes (F_film - F) + base (T_film / T - 1)              surface.thin-film      surface/thin_film.h
//     + ridge_share (F ridges - gloss)                          surface.micro-ridges   surface/ridges.h
//     + emission excitation exp(-(w - centre)^2 / 2 width^2) / pi                      surface.fluorescence
// all of it times the gain of the table, 1 where reflectances are absolute.
// gloss = lobes F is the model without its base, T = (1 - F(wi)) (1 - F(wo)), ridges the mean of saws that face either
// way. Every term is skipped, to the bit, where its amount is zero.
#pragma once
#include <optional>
#include <vector>

#include "explain/tables/reflectance_rows.h"
#include "surface/ridges.h"
#include "surface/surface.h"

namespace gonio::explain::tables {

struct FilmTerm {
  double film_m = 0, film_eta = 1.4;
};
struct RidgesTerm {
  double share = 0, tilt_rad = 0, azimuth_rad = 0;
};
struct FluorescenceTerm {
  double emission = 0, centre_m = 0, width_m = 1;
};

// Places of the parameters that the terms read, in a model's list; nothing where it has them not.
struct SurfacePlaces {
  explicit SurfacePlaces(const surface::Model& model);
  std::optional<std::size_t> albedo, f0, alpha, retro;
  bool dielectric = false;  // f0 is one number: a clear interface
  bool film() const { return dielectric && alpha.has_value(); }
  bool ridges() const { return f0.has_value() && alpha.has_value(); }
};
std::optional<std::size_t> parameter_place(const surface::Model& model, const std::string& name);

struct ReflectanceState {
  const surface::Model* model = nullptr;
  std::vector<surface::Values> triples;  // bands 3 t, 3 t + 1, 3 t + 2 as red, green and blue of values t
  FilmTerm film;
  RidgesTerm ridges;
  FluorescenceTerm fluorescence;
  double gain = 1;
};

// f of a row in a band. Rows of one geometry that follow each other share their work: one for each thread.
class ReflectanceEvaluation {
 public:
  ReflectanceEvaluation(const ReflectanceState& state, const ReflectanceRows& rows);
  struct Shared {  // what the registered model says at one geometry, of a triple of bands
    std::size_t row = static_cast<std::size_t>(-1), triple = 0;
    Rgb f, gloss, lobes;  // lobes: of a reference interface
    // Where a film lies on it: of the half vector; Fresnel factors of the bare interface, of the reference's and of
    // this one's facets; what passes it, there and back.
    double half_cosine = 1, reference = 1, plain = 0, passes = 1;
  };
  double operator()(std::size_t row, std::size_t band) { return value(row, band, look(row, band / 3)); }
  // Where the terms alone have changed, the model's part may come from another evaluation.
  double value(std::size_t row, std::size_t band, const Shared& shared) const;
  const Shared& look(std::size_t row, std::size_t triple);

 private:
  double fresnel(std::size_t band, double cosine) const;
  double f0(std::size_t band) const;
  void look_beneath_film(std::size_t row, std::size_t triple);
  double film(std::size_t row, std::size_t band, double f, const Shared& shared) const;
  double coated(std::size_t band, double cosine) const;  // Fresnel factor of film and interface
  double ridged(std::size_t row, std::size_t band, const Shared& shared) const;

  const ReflectanceState& state_;
  const ReflectanceRows& rows_;
  SurfacePlaces places_;
  std::vector<surface::Values> bare_, glazed_;  // without base; the same under a reference interface
  std::vector<surface::Ridges> saws_;           // facing either way
  Shared last_;
  struct Incidence {  // one series shares it
    double cosine = -1, coated = 0;
  };
  mutable std::vector<Incidence> incidence_;  // per band
};

}  // namespace gonio::explain::tables
