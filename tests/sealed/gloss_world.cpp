// A goniometer that measures a varnished sample: brushed, hazy, ridged, filmed, fluorescing. Designs: the sample turned
// about its normal in steps of 45 degrees (the usual one), "bands" of wavelengths, "two lamps", one of which has the
// ultraviolet that excites.
#include <algorithm>
#include <cmath>

#include "geom/angle.h"
#include "geom/vector.h"
#include "sealed/film.h"
#include "sealed/matter.h"
#include "sealed/rows_world.h"
#include "sealed/worlds.h"

namespace gonio::sealed {
namespace {

constexpr double f0 = 0.045;

// Roofs whose flanks rise by `tilt` to either side of v, level crests: a point is seen from where the next crest does
// not hide it. Facets of roughness alpha on the flanks.
double roofs(double tilt, double alpha, Vec3 v, Vec3 wi, Vec3 wo) {
  constexpr int count = 24;
  const Vec3 n{0, 0, 1};
  const double height = 0.5 * std::tan(tilt);  // of a roof of width 1
  const auto sees = [&](Vec3 w, double s, double side) {
    const double across = dot(w, v), z = height - std::abs(s) * std::tan(tilt);
    const double ahead = across * side > 0 ? 1 - std::abs(s) : std::abs(s);  // along w, to the next crest
    return (height - z) * std::abs(across) <= ahead * w.z;
  };
  double sum = 0;
  for (int k = 0; k < count; ++k) {
    const double s = -0.5 + (k + 0.5) / count, side = s > 0 ? 1 : -1;  // from this roof's crest
    const Vec3 m = n * std::cos(tilt) + v * (side * std::sin(tilt));
    if (dot(m, wi) <= 0 || dot(m, wo) <= 0 || !sees(wi, s, side) || !sees(wo, s, side)) continue;
    const double local = facets(alpha, alpha, m, cross(v, n), wi, wo) * fresnel(dot(wi, normalized(wi + wo)), f0);
    sum += local * dot(m, wi) * dot(m, wo) / (wi.z * wo.z * std::cos(tilt)) / count;
  }
  return sum;
}

class GlossWorld final : public RowsWorld {
 public:
  std::vector<EffectKind> effects() const override;
  void design(Random& random, const std::string& variant) override;
  Numbers base() const override {
    Numbers b(bands(), albedo_);
    for (std::size_t k = 0; k < b.size(); ++k) b[k] *= 1 + 0.6 * static_cast<double>(k) / static_cast<double>(b.size());
    b.push_back(alpha_);
    return b;
  }
  Numbers base_steps() const override { return Numbers(bands() + 1, 1e-3); }

 protected:
  double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const override;
  double noise_of(double f) const override { return std::hypot(relative_ * f, 2e-4); }
  std::string observed_name() const override { return "f"; }
  std::string observed_unit() const override { return "1/sr"; }
  std::string model() const override { return "surface"; }
  void describe(Value& manifest, Value& table) const override {
    manifest["surfaces"]["s"] =
        Value::object({{"model", "coated-diffuse"}, {"albedo", free_parameter(0.2)}, {"f0", f0}});
    manifest["surfaces"]["s"]["alpha"] = free_parameter(0.2);
    table["surface"] = "s";
  }

 private:
  std::size_t bands() const { return wavelength_m_.empty() ? 1 : wavelength_m_.size(); }
  double varnish(double alpha, const Sizes& sizes, double wavelength_m, Vec3 wi, Vec3 wo) const;
  double matte(double albedo, double alpha, Vec3 wi, Vec3 wo) const;
  double albedo_ = 0.1, relative_ = 0.01, alpha_ = 0.15, lay_ = 0, tilt_ = 0.25, film_index_ = 1.7, centre_m_ = 5.2e-7;
  Numbers wavelength_m_;
  bool excites_ = false;
  mutable double tabled_ = 0.2;
  mutable CoatAlbedo table_{f0, 0.2};
};

std::vector<EffectKind> GlossWorld::effects() const {
  const std::vector<std::string> surface{"surface"}, around{"surface.azimuth", "surface.half-angle"},
      lobe{"surface.half-angle", "surface.exitance-angle", "surface.incidence-angle", "surface.difference-angle"};
  std::vector<EffectKind> k;
  const auto add = [&](EffectKind kind) -> EffectKind& { return k.emplace_back(std::move(kind)); };
  add({"brushed", "surface.anisotropy", surface, around, 0.1, 0.9}).values = [this](const Numbers& s) {
    return std::vector<TrueValue>{{"surface.anisotropy", "anisotropy_0", 0.5 * s[0] * std::cos(2 * lay_)},
                                  {"surface.anisotropy", "anisotropy_45", 0.5 * s[0] * std::sin(2 * lay_)}};
  };
  add({"haze", "surface.specular", surface, lobe, 0.05, 0.4});
  add({"milled ridges", "surface.micro-ridges", surface, around, 0.1, 0.7}).nearly("ridge_share");
  add({"iridescent film",
       "surface.thin-film",
       surface,
       {"surface.wavelength", "surface.difference-angle", "surface.half-angle"},
       1e-7,
       5e-7})
      .only_for("bands")
      .as_drawn()
      .nearly("film_m");
  add({"dye", "surface.fluorescence", surface, {"surface.excitation", "surface.wavelength"}, 0.02, 0.3})
      .only_for("two lamps")
      .nearly("emission");
  add({"bow of droplets", "", surface, {}, 0.08, 0.3});
  return k;
}

void GlossWorld::design(Random& random, const std::string& variant) {
  const bool lamps = excites_ = variant == "two lamps", spectral = lamps || variant == "bands";
  albedo_ = random.uniform(0.05, 0.25);
  relative_ = random.uniform(0.005, 0.015);
  alpha_ = random.uniform(0.12, 0.25);
  lay_ = random.uniform(0, pi);
  tilt_ = random.uniform(0.15, 0.35);
  film_index_ = random.uniform(1.6, 2.1);
  centre_m_ = random.uniform(4.8e-7, 5.8e-7);
  for (const char* name : {"theta_i", "phi_i", "theta_o", "phi_o"}) add_column(name, "rad");
  if (spectral) add_column("wavelength_m", "m");
  if (lamps) add_column("excitation", "1");
  add_column("series", "1");
  for (int nm = 430; spectral && nm <= 670; nm += 20) wavelength_m_.push_back(1e-9 * nm);
  const std::vector<int> turns = spectral ? std::vector<int>{0} : std::vector<int>{0, 45, 90, 135};
  double series = 0;
  for (const int incidence : {12, 28, 42, 56, 68}) {
    ++series;
    for (const int turn : turns)
      for (int k = 0; k < (spectral ? 10 : 24); ++k) {
        const bool mirror = k % 2 == 0;  // half of them about the mirror direction
        const double theta = mirror ? std::abs(incidence + 14 * random.normal()) : random.uniform(3, 78);
        const double phi = 180 + turn + (mirror ? random.uniform(-25, 25) : random.uniform(-180, 180));
        if (theta > 80) continue;
        Numbers row{incidence * degree, turn * degree, theta * degree, phi * degree};
        for (const double nm : spectral ? wavelength_m_ : Numbers{0})
          for (const double excited : lamps ? Numbers{0, 1} : Numbers{0}) {
            Numbers full = row;
            if (spectral) full.push_back(nm);
            if (lamps) full.push_back(excited);
            full.push_back(series);
            add_row(full);
          }
      }
  }
}

double GlossWorld::varnish(double alpha, const Sizes& sizes, double wavelength_m, Vec3 wi, Vec3 wo) const {
  const Vec3 n{0, 0, 1}, along{std::cos(lay_), std::sin(lay_), 0};
  const double cosine = dot(wi, normalized(wi + wo)), stretch = std::exp(0.5 * size_of(sizes, "brushed")),
               film = size_of(sizes, "iridescent film"), hazy = size_of(sizes, "haze"),
               ridged = size_of(sizes, "milled ridges");
  double smooth = facets(alpha * stretch, alpha / stretch, n, along, wi, wo);
  if (hazy > 0) smooth += hazy * (facets(3 * alpha, 3 * alpha, n, along, wi, wo) - smooth);
  smooth *= film > 0 ? film_reflectance({film, film_index_}, f0, cosine, wavelength_m) : fresnel(cosine, f0);
  return ridged > 0 ? smooth + ridged * (roofs(tilt_, alpha, along, wi, wo) - smooth) : smooth;
}

// Lambertian under the varnish: what it lets in, out again, and back down (Kelemen & Szirmay-Kalos 2001).
double GlossWorld::matte(double albedo, double alpha, Vec3 wi, Vec3 wo) const {
  if (tabled_ != alpha) table_ = CoatAlbedo(f0, alpha), tabled_ = alpha;
  return albedo / pi * (1 - table_.at(wi.z)) * (1 - table_.at(wo.z)) / (1 - table_.mean());
}

double GlossWorld::reading(const Numbers& base, const Sizes& sizes, std::size_t row) const {
  const auto towards = [&](const char* theta, const char* phi) {
    const double t = at(theta, row), p = at(phi, row);
    return Vec3{std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
  };
  const Vec3 wi = towards("theta_i", "phi_i"), wo = towards("theta_o", "phi_o");
  const double wavelength = wavelength_m_.empty() ? 0 : at("wavelength_m", row);
  const auto band = static_cast<std::size_t>(
      std::lower_bound(wavelength_m_.begin(), wavelength_m_.end(), wavelength - 1e-9) - wavelength_m_.begin());
  double f = varnish(base.back(), sizes, wavelength, wi, wo) + matte(base[band], base.back(), wi, wo);
  if (const double dye = size_of(sizes, "dye"); dye > 0) {  // emitted in a band that is even in energy, not wavelength
    const double off = (centre_m_ / wavelength - 1) / 0.055;
    f += (excites_ ? at("excitation", row) : 0) * dye * std::exp(-0.5 * off * off) / pi;
  }
  const double phase = std::acos(std::clamp(dot(wi, wo), -1.0, 1.0)), from_bow = (phase - 0.72) / 0.09;
  return f * (1 + size_of(sizes, "bow of droplets") * std::exp(-0.5 * from_bow * from_bow));
}

}  // namespace

std::unique_ptr<World> gloss_world() {
  return std::make_unique<GlossWorld>();
}

}  // namespace gonio::sealed
