// See outputs.h.
#include "goniometry/outputs.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

namespace gonio::goniometry {
namespace {

constexpr std::array<double, 3> red_green_blue_m = {610e-9, 545e-9, 455e-9};

std::size_t nearest_band(const std::vector<double>& band_m, double wavelength_m) {
  std::size_t best = 0;
  for (std::size_t b = 1; b < band_m.size(); ++b)
    if (std::abs(band_m[b] - wavelength_m) < std::abs(band_m[best] - wavelength_m)) best = b;
  return best;
}

Vec3 turned(Vec3 w, double angle) {
  return {w.x * std::cos(angle) - w.y * std::sin(angle), w.x * std::sin(angle) + w.y * std::cos(angle), w.z};
}

bool changes_when_turned(const Fit& fit) {
  const Vec3 wi = normalized(Vec3{0.5, 0.1, 0.8}), wo = normalized(Vec3{-0.45, 0.05, 0.85});
  const double f = fit.evaluate(wo, wi, 0);
  for (int k = 1; k < 8; ++k) {
    const double angle = pi * k / 8;
    if (std::abs(fit.evaluate(turned(wo, angle), turned(wi, angle), 0) - f) > 1e-6 * std::abs(f) + 1e-12) return true;
  }
  return false;
}

// Middle of a cell, phi_h = 0 (tables_merl.cpp has the formulas).
struct Pair {
  Vec3 wi, wo;
};
Pair pair_of(double theta_h, double theta_d, double phi_d) {
  const Vec3 h{std::sin(theta_h), 0, std::cos(theta_h)};
  const Vec3 d{std::sin(theta_d) * std::cos(phi_d), std::sin(theta_d) * std::sin(phi_d), std::cos(theta_d)};
  const Vec3 wi{d.x * h.z + d.z * h.x, d.y, -d.x * h.x + d.z * h.z};
  return {wi, 2 * dot(h, wi) * h - wi};
}

double azimuth(Vec3 w) {
  return std::atan2(w.y, w.x);
}
double zenith(Vec3 w) {
  return std::acos(std::clamp(w.z, -1.0, 1.0));
}

}  // namespace

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::array<std::size_t, 3> written_bands(const Samples& samples) {
  std::array<std::size_t, 3> out{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto named = std::ranges::find(samples.band_name, std::string(1, "rgb"[c]));
    if (named != samples.band_name.end())
      out[c] = static_cast<std::size_t>(named - samples.band_name.begin());
    else if (!samples.band_m.empty())
      out[c] = nearest_band(samples.band_m, red_green_blue_m[c]);
    else
      out[c] = c * (samples.bands() - 1) / 2;
  }
  return out;
}

std::array<std::string, 3> written_names(const Outcome& outcome) {
  const Samples& s = outcome.read.samples;
  const auto bands = written_bands(s);
  std::array<std::string, 3> out;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<std::size_t> members;
    for (std::size_t b = 0; outcome.reconstruction && b < s.bands(); ++b)
      if (colour_of_band(s, b) == c) members.push_back(b);
    out[c] = members.size() > 1 ? "mean of " + std::to_string(members.size()) + " bands, " +
                                      s.band_name[members.front()] + " to " + s.band_name[members.back()]
                                : s.band_name[members.empty() ? bands[c] : members.front()];
  }
  return out;
}

double compared(double f, Vec3 wi, Vec3 wo) {
  return std::log1p(100 * std::max(f, 0.0) * wi.z * wo.z);
}

double predicted(const Outcome& outcome, Vec3 wi, Vec3 wo, std::size_t band) {
  if (outcome.table) {
    const auto component = static_cast<int>(colour_of_band(outcome.read.samples, band));
    return outcome.table_scale * outcome.table->evaluate(wo, wi)[component];
  }
  const Fit* fit = outcome.chosen();
  return fit == nullptr ? std::nan("") : fit->evaluate(wo, wi, band);
}

io::MerlTable merl_of(const Outcome& outcome, const std::string& place) {
  if (outcome.reconstruction) return outcome.reconstruction->table;
  const Fit* fit = outcome.chosen();
  if (fit == nullptr) throw Error(Exit::negative, place, "there is no surface to write");
  if (changes_when_turned(*fit))
    throw Error(Exit::usage, place,
                "the chosen " + fit->model->info().id + " changes when it is turned about its normal",
                "tables of MERL hold none of these; --isotropic fits one that does not");
  io::MerlTable out;
  out.bins = merl_bins;
  out.brdf_per_sr.assign(3 * out.cells(), -1);
  const auto bands = written_bands(outcome.read.samples);
  const auto [nh, nd, np] = out.bins;
  parallel_for(0, nh, [&](std::size_t i) {
    const double root = (static_cast<double>(i) + 0.5) / static_cast<double>(nh);
    for (std::size_t j = 0; j < nd; ++j)
      for (std::size_t k = 0; k < np; ++k) {
        const auto [wi, wo] =
            pair_of(root * root * pi / 2, (static_cast<double>(j) + 0.5) / static_cast<double>(nd) * pi / 2,
                    (static_cast<double>(k) + 0.5) / static_cast<double>(np) * pi);
        if (wi.z <= 0 || wo.z <= 0) continue;
        for (std::size_t c = 0; c < 3; ++c)
          out.brdf_per_sr[3 * ((i * nd + j) * np + k) + c] = static_cast<float>(fit->evaluate(wo, wi, bands[c]));
      }
  });
  return out;
}

std::string samples_csv(const Outcome& outcome) {
  const Samples& s = outcome.read.samples;
  const bool one = s.bands() == 1 && s.band_m.empty();
  std::string out = "theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,";
  out += one ? "" : s.band_m.empty() ? "channel," : "wavelength_m,";
  out += s.sigma.empty() ? "f,model,residual,series,place\n" : "f,f_sigma,model,residual,series,place\n";
  for (std::size_t r = 0; r < s.rows(); ++r)
    for (std::size_t b = 0; b < s.bands(); ++b) {
      const double f = s.f[r * s.bands() + b], model = predicted(outcome, s.wi[r], s.wo[r], b);
      if (!std::isfinite(f)) continue;
      out += format("%.9g,%.9g,%.9g,%.9g,", zenith(s.wi[r]), azimuth(s.wi[r]), zenith(s.wo[r]), azimuth(s.wo[r]));
      if (!one) out += s.band_m.empty() ? std::to_string(b) + "," : format("%.6g,", s.band_m[b]);
      out += format("%.8g,", f);
      if (!s.sigma.empty()) out += format("%.4g,", s.sigma[r * s.bands() + b]);
      out += std::isfinite(model)
                 ? format("%.8g,%.5g,", model, compared(f, s.wi[r], s.wo[r]) - compared(model, s.wi[r], s.wo[r]))
                 : ",,";
      out += std::to_string(s.series.empty() ? 0 : s.series[r]) + "," + quoted(r < s.place.size() ? s.place[r] : "") +
             "\n";
    }
  return out;
}

}  // namespace gonio::goniometry
