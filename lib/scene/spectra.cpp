#include "scene/spectra.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "optics/colour.h"
#include "optics/refractive_index.h"
#include "scene/variation.h"

namespace gonio::scene {
namespace {

using optics::RefractiveIndex;

struct Stated {
  std::function<double(double)> value;
  optics::Range range;
};

Stated of_index(const RefractiveIndex& index, const std::string& parameter, const std::string& place) {
  const auto n = [index](double w) { return index.n(w); };
  const auto k = [index](double w) { return index.k(w); };
  const bool needs_k = parameter == "k" || parameter == "sigma_a_per_m", needs_n = !needs_k;
  if (needs_k && !index.states_k())
    throw Error(Exit::data, index.place(), "states no extinction coefficient k",
                "give " + parameter + " a number, or name a file that states k");
  if (needs_n && !index.states_n())
    throw Error(Exit::data, index.place(), "states no refractive index n", "name a file that states n");
  if (parameter.starts_with("eta")) return {n, index.range_n()};
  if (parameter == "k") return {k, index.range_k()};
  if (parameter == "sigma_a_per_m") return {[k](double w) { return 4 * pi * k(w) / w; }, index.range_k()};
  if (parameter == "f0") {
    if (!index.states_k()) return {[n](double w) { return std::pow((n(w) - 1) / (n(w) + 1), 2); }, index.range_n()};
    const optics::Range a = index.range_n(), b = index.range_k();
    return {[n, k](double w) {
              const double k2 = k(w) * k(w), less = n(w) - 1, more = n(w) + 1;
              return (less * less + k2) / (more * more + k2);
            },
            {std::max(a.first_m, b.first_m), std::min(a.last_m, b.last_m)}};
  }
  throw Error(Exit::data, place, "a refractive index does not say what " + parameter + " is",
              "eta, k, f0 and sigma_a_per_m follow from it; for others name a CSV file (wavelength_nm,value)");
}

Stated stated_in(const std::filesystem::path& file, const std::string& parameter, const std::string& place) {
  if (file.extension() == ".yml" || file.extension() == ".yaml")
    return of_index(optics::read_refractive_index(file), parameter, place);
  const optics::Spectrum spectrum = optics::read_spectrum(file);
  return {[spectrum](double w) { return spectrum.at(w); }, spectrum.range()};
}

bool within(Rgb v, double lower, double upper) {
  return std::min({v.x, v.y, v.z}) >= lower && std::max({v.x, v.y, v.z}) <= upper;
}

// A rule whose colours are the bands'.
class InBands final : public Rule {
 public:
  InBands(std::shared_ptr<const Rule> rule, const manifest::ParameterInfo& info, const optics::Bands& bands)
      : rule_(std::move(rule)), info_(info), bands_(bands) {}
  Rgb at(const Place& place) const override { return in_bands(rule_->at(place), info_, bands_); }
  void fits(const mesh::Mesh* mesh, const manifest::ParameterInfo& info, const std::string& place) const override {
    rule_->fits(mesh, info, place);
  }

 private:
  std::shared_ptr<const Rule> rule_;
  const manifest::ParameterInfo& info_;
  optics::Bands bands_;
};

}  // namespace

std::vector<double> spectrum_in_bands(const std::filesystem::path& file, const manifest::ModelInfo& info,
                                      const std::string& parameter, const optics::Bands& bands,
                                      const std::string& place) {
  const auto known = std::ranges::find(info.parameters, parameter, &manifest::ParameterInfo::name);
  if (known == info.parameters.end())
    throw Error(Exit::data, place, "model \"" + info.id + "\" has no such parameter",
                "name a file for one of its parameters");
  const Stated stated = stated_in(file, parameter, place);
  std::vector<double> values;
  if (known->components == 1) {
    values = {stated.value(d_line_m)};
  } else {
    const Rgb value = optics::band_values(stated.value, stated.range, bands, file.string());
    values = {value.x, value.y, value.z};
  }
  for (const double v : values)
    if (!(v >= known->lower && v <= known->upper))
      throw Error(Exit::data, place,
                  format("%s becomes %g, outside %g to %g", parameter.c_str(), v, known->lower, known->upper),
                  known->meaning);
  return values;
}

Rgb in_bands(Rgb value, const manifest::ParameterInfo& info, const optics::Bands& bands) {
  if (bands.rgb || !info.rgb) return value;
  const Rgb v = optics::upsampled(value, bands);
  return {std::clamp(v.x, info.lower, info.upper), std::clamp(v.y, info.lower, info.upper),
          std::clamp(v.z, info.lower, info.upper)};
}

manifest::Parameters in_bands(manifest::Parameters parameters, const manifest::ModelInfo& info,
                              const optics::Bands& bands) {
  if (bands.rgb) return parameters;
  for (const manifest::ParameterInfo& known : info.parameters) {
    const auto given = parameters.find(known.name);
    if (!known.rgb || given == parameters.end() || given->second.value.size() != 3) continue;
    const Rgb rgb = given->second.rgb();
    if (!within(rgb, known.lower, known.upper)) continue;  // to be refused
    const Rgb v = in_bands(rgb, known, bands);
    given->second.value = {v.x, v.y, v.z};
  }
  return parameters;
}

io::Image in_bands(io::Image picture, double lower, double upper, const optics::Bands& bands) {
  const std::size_t channels = picture.channels.size();
  if (bands.rgb || channels < 3) return picture;
  for (std::size_t i = 0; i + 3 <= picture.data.size(); i += channels) {
    const Rgb rgb{picture.data[i], picture.data[i + 1], picture.data[i + 2]};
    if (!within(rgb, lower, upper)) continue;  // to be refused
    const Rgb v = optics::upsampled(rgb, bands);
    for (int c = 0; c < 3; ++c)
      picture.data[i + static_cast<std::size_t>(c)] = static_cast<float>(std::clamp(v[c], lower, upper));
  }
  return picture;
}

void in_bands(Surface& surface) {
  if (surface.bands.rgb) return;
  for (Varying& varying : surface.varying)
    for (const manifest::ParameterInfo& info : surface.model->info().parameters)
      if (info.rgb && info.name == varying.name)
        varying.rule = std::make_shared<const InBands>(varying.rule, info, surface.bands);
}

}  // namespace gonio::scene
