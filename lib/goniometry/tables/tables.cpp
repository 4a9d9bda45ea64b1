// See tables.h: which reader, and what becomes of its readings.
#include "goniometry/tables/tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "goniometry/tables/tables_readings.h"
#include "manifest/fields.h"
#include "stats/intervals.h"

namespace gonio::goniometry {
namespace {

constexpr std::uint64_t largest_file = std::uint64_t{1} << 30;
constexpr double least_relative_value = 1e-3;  // of the median, below which relative noise does not shrink further

Vec3 direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Degrees that are called radians are an error; what speaks for radians that are called degrees is told, else nothing.
std::string check_angles(const Readings& in) {
  double largest = 0, azimuth = 0;
  for (std::size_t r = 0; r < in.angles.size(); ++r)
    for (std::size_t k = 0; k < 4; ++k) {
      const double a = std::abs(in.angles[r][k]);
      (k % 2 == 0 ? largest : azimuth) = std::max(k % 2 == 0 ? largest : azimuth, a);
      if (!(a > (k % 2 == 0 ? pi * (1 + 1e-6) : 4 * pi))) continue;
      const bool radians = in.said_radians;
      const double shown = radians ? in.angles[r][k] : in.angles[r][k] * 180 / pi;
      throw Error(
          Exit::data, in.place[r] + ": " + in.angle_name[k],
          shortest_text(shown) + (radians ? " rad" : " deg") +
              (k % 2 == 0 ? " is no zenith: it is beyond half a turn" : " is more than two turns"),
          radians ? "if these are degrees, say so: \"" + in.angle_name[k] + " [deg]\" in the heading, or --angles deg"
                  : "check the column and its unit");
    }
  if (!in.said_radians && largest < 1.58 * pi / 180 && azimuth < 6.3 * pi / 180 && in.angles.size() > 4)
    return "no angle is above " + format("%.2f", std::max(largest, azimuth) * 180 / pi) +
           " deg; if these are radians, say so in the heading, or --angles rad";
  return {};
}

Convention convention_of(const Samples& samples, const TableOptions& options, const Readings& in,
                         const std::string& hint) {
  try {
    return find_convention(samples, options.mirror, in.preset, in.name);
  } catch (const Error& error) {
    if (hint.empty()) throw;
    throw Error(error.code(), error.place(), error.problem(), hint + "; else " + error.remedy());
  }
}

[[noreturn]] void nothing_left(const Readings& in, const std::vector<Dropped>& dropped) {
  std::map<std::string, std::size_t> reasons;
  for (const Dropped& d : dropped) ++reasons[d.reason];
  std::string why;
  for (const auto& [reason, n] : reasons) why += (why.empty() ? "" : ", ") + std::to_string(n) + " " + reason;
  bool swapped = true;  // the azimuths would do as zeniths, and are some
  for (const auto& a : in.angles) swapped = swapped && std::max(std::abs(a[1]), std::abs(a[3])) <= pi / 2 * 1.0001;
  throw Error(Exit::data, in.name, "has no row that can be used, of " + std::to_string(in.angles.size()) + ": " + why,
              swapped && reasons.contains("below the horizon")
                  ? "where phi is the zenith and theta the azimuth, say so: --columns "
                    "theta_i=phi_i:deg,phi_i=theta_i:deg,theta_o=phi_o:deg,phi_o=theta_o:deg"
                  : "check the units of the angles and the sign of the values");
}

// Reason to leave the whole row out; empty: none. Bands that are no number become NaN.
std::string fault_of(const Readings& in, std::size_t row, Vec3 wi, Vec3 wo, const TableOptions& options,
                     std::vector<double>& f) {
  if (!is_finite(wi) || !is_finite(wo)) return "without all its angles";
  if (wi.z <= 1e-9 || wo.z <= 1e-9) return "below the horizon";
  if (std::min(wi.z, wo.z) < std::cos(options.grazing_rad) - 1e-9) return "beyond the grazing limit";
  const std::size_t n = in.band_name.size();
  std::size_t negative = 0, numbers = 0;
  for (std::size_t b = 0; b < n; ++b) {
    const double v = in.f[row * n + b];
    negative += v < 0;
    numbers += std::isfinite(v) && v >= 0;
    f.push_back(std::isfinite(v) && v >= 0 ? v : std::nan(""));
  }
  if (numbers > 0) return {};
  f.resize(f.size() - n);
  return negative > 0 ? "with a negative value" : "without a number";
}

void add_sigma(const Readings& in, std::size_t row, const std::vector<double>& median, const TableOptions& options,
               Samples& out) {
  const std::size_t n = in.band_name.size();
  if (!in.sigma.empty()) {
    for (std::size_t b = 0; b < n; ++b) {
      const double s = in.sigma[row * n + b];
      if (!(s > 0) && std::isfinite(in.f[row * n + b]))
        throw Error(Exit::data, in.place[row] + ": sigma", shortest_text(s) + " is no standard uncertainty",
                    "it is above 0; leave the column out where it is not known");
      out.sigma.push_back(s);
    }
  } else if (options.relative_noise) {
    for (std::size_t b = 0; b < n; ++b)
      out.sigma.push_back(*options.relative_noise * std::max(in.f[row * n + b], least_relative_value * median[b]));
  }
}

std::vector<double> medians(const Readings& in) {
  const std::size_t n = in.band_name.size();
  std::vector<double> out(n, 0);
  for (std::size_t b = 0; b < n; ++b) {
    std::vector<double> values;
    for (std::size_t i = b; i < in.f.size(); i += n)
      if (in.f[i] > 0) values.push_back(in.f[i]);
    if (!values.empty()) out[b] = stats::median(values);
  }
  return out;
}

std::string series_label(const Readings& in, std::size_t row, Vec3 wi) {
  if (!in.series.empty()) return in.series[row];
  return std::to_string(std::lround(wi.x * 500)) + "," + std::to_string(std::lround(wi.y * 500));
}

void check_pairs(const Samples& samples) {
  for (std::size_t r = 1; r < samples.rows(); ++r)
    if (norm(samples.wi[r] - samples.wi[0]) > 1e-6 || norm(samples.wo[r] - samples.wo[0]) > 1e-6) return;
  throw Error(Exit::negative, samples.name, "has one pair of directions only, from which no surface can be told",
              "measure at several directions of light and eye: brdf-fit --plan 20 says which");
}

std::vector<std::string> known_bands(const Samples& samples) {
  std::vector<std::string> names;
  for (const std::string& name : samples.band_name) names.push_back(name.empty() ? "(without a name)" : name);
  return names;
}

std::string without_blanks(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c != ' ') out += c;
  return out;
}

double nanometres(const std::string& text, const std::string& place) {
  const std::string word = without_blanks(text);
  return word.empty() ? 0 : parse_quantity(word, Dimension::length, place);
}

}  // namespace

void check_wavelength(double metres, const std::string& place) {
  if (!(metres >= 1e-9 && metres <= 1e-3))
    throw Error(Exit::data, place, format("%.6g nm is none of light, which has 1 nm to 1 mm", metres * 1e9),
                "check the unit of the wavelengths");
}

ReadTable samples_of(Readings in, const TableOptions& options) {
  ReadTable out;
  out.notes = in.notes;
  const std::string hint = check_angles(in);
  if (!hint.empty()) out.notes.push_back(out.units_doubt = "Take care: " + hint + ".");
  for (const double wavelength : in.band_m) check_wavelength(wavelength, in.name + ": wavelength");
  Samples& s = out.samples;
  s.name = in.name, s.band_name = in.band_name, s.band_m = in.band_m;
  std::map<std::string, std::size_t> series;
  const std::vector<double> median = medians(in);
  std::size_t holes = 0;
  for (std::size_t r = 0; r < in.angles.size(); ++r) {
    const auto& a = in.angles[r];
    const Vec3 wi = direction(a[0], a[1]), wo = direction(a[2], a[3]);
    const std::string fault = fault_of(in, r, wi, wo, options, s.f);
    if (!fault.empty()) {
      out.dropped.push_back({in.place[r], fault});
      continue;
    }
    s.wi.push_back(wi), s.wo.push_back(wo), s.place.push_back(in.place[r]);
    s.series.push_back(series.try_emplace(series_label(in, r, wi), series.size()).first->second);
    add_sigma(in, r, median, options, s);
  }
  for (const double f : s.f) holes += std::isnan(f);
  if (s.rows() == 0) nothing_left(in, out.dropped);
  if (std::ranges::none_of(s.f, [](double f) { return f > 0; }))
    throw Error(Exit::data, in.name, "has no value above zero in " + std::to_string(s.rows()) + " rows",
                "check which column holds the reflectance");
  if (holes > 0)
    out.notes.push_back(std::to_string(holes) +
                        " single values in otherwise good rows do not count: negative or no number.");
  out.convention = convention_of(s, options, in, hint);
  if (out.convention.mirror == Mirror::same) turn_exitance(s);
  check_pairs(s);
  keep_bands(s, options.bands, "--bands");
  return out;
}

ReadTable read_table(const std::filesystem::path& path, const TableOptions& options) {
  const std::string name = path.filename().string(), extension = path.extension().string();
  if (extension == ".binary") return samples_of(merl_readings(path, options), options);
  const std::string text = read_file(path, largest_file);
  if (extension == ".brdf") return samples_of(cornell_readings(text, name), options);
  return samples_of(column_readings(parse_text_table(text, name), options), options);
}

void keep_bands(Samples& samples, const std::vector<std::string>& bands, const std::string& place) {
  if (bands.empty()) return;
  std::set<std::size_t> kept;
  for (const std::string& wanted : bands) {
    const std::size_t before = kept.size();
    const auto colon = wanted.find(':');
    if (colon != std::string::npos && !samples.band_m.empty()) {
      const double from = nanometres(wanted.substr(0, colon), place), to = nanometres(wanted.substr(colon + 1), place);
      for (std::size_t b = 0; b < samples.bands(); ++b)
        if (samples.band_m[b] >= from - 1e-12 && samples.band_m[b] <= to + 1e-12) kept.insert(b);
    } else {
      for (std::size_t b = 0; b < samples.bands(); ++b)
        if (without_blanks(samples.band_name[b]) == without_blanks(wanted)) kept.insert(b);
    }
    if (kept.size() == before && std::ranges::count(bands, wanted) == 1)
      throw Error(Exit::usage, place, "\"" + wanted + "\" is no band of " + samples.name,
                  manifest::remedy_for(wanted, known_bands(samples)));
  }
  const std::size_t n = samples.bands();
  const auto keep = [&](std::vector<double>& values) {
    std::vector<double> left;
    for (std::size_t r = 0; r < samples.rows() && !values.empty(); ++r)
      for (const std::size_t b : kept) left.push_back(values[r * n + b]);
    values = std::move(left);
  };
  keep(samples.f), keep(samples.sigma);
  std::vector<std::string> names;
  std::vector<double> wavelengths;
  for (const std::size_t b : kept) {
    names.push_back(samples.band_name[b]);
    if (!samples.band_m.empty()) wavelengths.push_back(samples.band_m[b]);
  }
  samples.band_name = std::move(names), samples.band_m = std::move(wavelengths);
}

}  // namespace gonio::goniometry
