#include "render/spectral.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "base/text.h"
#include "render/film.h"

namespace gonio::render {
namespace {

constexpr double shortest_m = 1e-7, longest_m = 1e-4;
constexpr int most_bins = 1000;

// A tenth of a picometre: what channels' names tell apart.
double rounded(double wavelength_m) {
  return std::round(wavelength_m * 1e13) / 1e13;
}

[[noreturn]] void refuse(const std::string& text, const std::string& place, const std::string& why) {
  throw Error(Exit::usage, place, "\"" + text + "\" " + why, "write FIRST:LAST:COUNT, such as 400nm:700nm:31");
}

// Which planes of an integrator have a place among spectral channels, and as which Stokes component: the radiance, s1,
// s2 and s3. Those of single lights are left to the colours.
int stokes_component(const std::string& plane) {
  if (plane.empty()) return 0;
  return plane == "s1" || plane == "s2" || plane == "s3" ? plane[1] - '0' : -1;
}

class SpectralIntegrator final : public Integrator {
 public:
  SpectralIntegrator(std::unique_ptr<Integrator> colour, std::vector<std::unique_ptr<Integrator>> spectral,
                     const std::vector<double>& wavelengths_m)
      : colour_(std::move(colour)),
        spectral_(std::move(spectral)),
        names_(colour_->planes()),
        of_colour_(names_.size()) {
    inner_ = spectral_.empty() ? std::vector<std::string>() : spectral_[0]->planes();
    for (std::size_t group = 0; group < spectral_.size(); ++group)
      for (const std::string& plane : inner_)
        if (stokes_component(plane) >= 0) names_.push_back(name(stokes_component(plane), group, wavelengths_m));
  }

  std::vector<std::string> planes() const override { return names_; }
  std::size_t lights() const override { return colour_->lights(); }

  void trace(Vec2 pixel, Sampler& sampler, std::span<Rgb> planes, Noticed& noticed) const override {
    const Sampler start = sampler;
    colour_->trace(pixel, sampler, planes.first(of_colour_), noticed);
    std::span<Rgb> rest = planes.subspan(of_colour_);
    std::vector<Rgb> found(inner_.size());
    Noticed unused{.seen = std::vector<std::uint32_t>(lights()), .met = 0};
    for (const auto& integrator : spectral_) {
      Sampler again = start;
      std::fill(found.begin(), found.end(), Rgb{});
      integrator->trace(pixel, again, found, unused);
      for (std::size_t plane = 0; plane < inner_.size(); ++plane)
        if (stokes_component(inner_[plane]) >= 0) {
          rest.front() += found[plane];
          rest = rest.subspan(1);
        }
    }
  }

  PixelGeometry geometry(int x, int y, const Noticed& noticed) const override {
    return colour_->geometry(x, y, noticed);
  }
  const SampleMap* sample_map(int preset) const override { return colour_->sample_map(preset); }
  bool traces_from_lights() const override { return colour_->traces_from_lights(); }
  void trace_from_lights(std::uint64_t seed, std::uint64_t first, std::uint64_t count, Splats& splats) const override {
    colour_->trace_from_lights(seed, first, count, splats);
    std::size_t place = of_colour_;
    for (const auto& integrator : spectral_) {
      Shifted shifted(splats, inner_, place);
      integrator->trace_from_lights(seed, first, count, shifted);
      place = shifted.end();
    }
  }

 private:
  // Hands the planes of one spectral integrator on to their places behind `first`.
  class Shifted final : public Splats {
   public:
    Shifted(Splats& to, const std::vector<std::string>& planes, std::size_t first) : to_(to), end_(first) {
      for (const std::string& plane : planes) places_.push_back(stokes_component(plane) >= 0 ? end_++ : 0);
    }
    void add(Vec2 pixel, std::size_t plane, Rgb value) override {
      if (places_[plane] > 0) to_.add(pixel, places_[plane], value);
    }
    std::size_t end() const { return end_; }

   private:
    Splats& to_;
    std::vector<std::size_t> places_;
    std::size_t end_;
  };

  static std::string name(int stokes, std::size_t group, const std::vector<double>& wavelengths_m) {
    std::string text;
    for (std::size_t i = 3 * group; i < 3 * group + 3; ++i)
      text += (text.empty() ? "" : " ") +
              (i < wavelengths_m.size() ? spectral_channel(stokes, wavelengths_m[i]) : std::string("-"));
    return text;
  }

  std::unique_ptr<Integrator> colour_;
  std::vector<std::unique_ptr<Integrator>> spectral_;
  std::vector<std::string> names_, inner_;
  std::size_t of_colour_;
};

}  // namespace

std::vector<double> parse_wavelengths(const std::string& text, const std::string& place) {
  const auto first_colon = text.find(':'), last_colon = text.rfind(':');
  if (first_colon == std::string::npos || first_colon == last_colon) refuse(text, place, "is no range of wavelengths");
  const double first = parse_quantity(text.substr(0, first_colon), Dimension::length, place);
  const double last =
      parse_quantity(text.substr(first_colon + 1, last_colon - first_colon - 1), Dimension::length, place);
  const double count = parse_quantity(text.substr(last_colon + 1), Dimension::none, place);
  if (!(first >= shortest_m && last <= longest_m && first <= last))
    refuse(text, place, "does not go up from at least 100nm to at most 100um");
  if (!(count >= 1 && count <= most_bins && count == std::floor(count)) || (count > 1) != (last > first))
    refuse(text, place, "has no sensible number of bins");
  std::vector<double> wavelengths_m;
  for (int i = 0; i < static_cast<int>(count); ++i)
    wavelengths_m.push_back(rounded(count > 1 ? first + (last - first) * i / (count - 1) : first));
  return wavelengths_m;
}

std::vector<optics::Bands> spectral_bands(const std::vector<double>& wavelengths_m) {
  std::vector<optics::Bands> all;
  for (std::size_t first = 0; first < wavelengths_m.size(); first += 3) {
    optics::Bands& bands = all.emplace_back();
    bands.rgb = false;
    for (std::size_t i = 0; i < 3; ++i)
      bands.wavelength_m[i] = wavelengths_m[std::min(first + i, wavelengths_m.size() - 1)];
  }
  return all;
}

std::string spectral_channel(int stokes, double wavelength_m) {
  const double nm = std::round(wavelength_m * 1e13) / 1e4;
  std::string text = shortest_text(nm);
  if (text.find('.') == std::string::npos) text += ".0";
  std::replace(text.begin(), text.end(), '.', ',');
  return "S" + std::to_string(stokes) + "." + text + "nm";
}

std::vector<double> wavelengths_of(const std::vector<std::string>& planes) {
  std::vector<double> wavelengths_m;
  for (const std::string& plane : planes)
    for (std::string channel : plane_channels(plane)) {
      if (!channel.starts_with("S0.")) continue;
      std::replace(channel.begin(), channel.end(), ',', '.');
      wavelengths_m.push_back(rounded(parse_quantity(channel.substr(3), Dimension::length, plane)));
    }
  return wavelengths_m;
}

std::unique_ptr<Integrator> with_spectrum(std::unique_ptr<Integrator> colour,
                                          std::vector<std::unique_ptr<Integrator>> spectral,
                                          const std::vector<double>& wavelengths_m) {
  return std::make_unique<SpectralIntegrator>(std::move(colour), std::move(spectral), wavelengths_m);
}

}  // namespace gonio::render
