#include "optics/spectrum.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "optics/number_words.h"

namespace gonio::optics {

std::string nanometres(double wavelength_m) {
  return format("%.6g nm", wavelength_m * 1e9);
}

Spectrum::Spectrum(std::vector<double> wavelength_m, std::vector<double> value, std::string place)
    : wavelength_m_(std::move(wavelength_m)), value_(std::move(value)), place_(std::move(place)) {
  if (wavelength_m_.empty() || wavelength_m_.size() != value_.size())
    throw Error(Exit::data, place_, "spectrum without samples", "give one value per wavelength");
  for (std::size_t i = 0; i < value_.size(); ++i) {
    if (!std::isfinite(value_[i]) || !(wavelength_m_[i] > 0) || !std::isfinite(wavelength_m_[i]))
      throw Error(Exit::data, place_,
                  "sample " + std::to_string(i + 1) + " is no finite value at a positive wavelength",
                  "check the numbers");
    if (i > 0 && !(wavelength_m_[i] > wavelength_m_[i - 1]))
      throw Error(Exit::data, place_, "wavelengths do not grow at " + nanometres(wavelength_m_[i]),
                  "sort the samples and state each wavelength once");
  }
}

double Spectrum::at(double wavelength_m) const {
  if (!covers(wavelength_m))
    throw Error(Exit::data, place_,
                nanometres(wavelength_m) + " is outside of what it states, " + nanometres(first_m()) + " to " +
                    nanometres(last_m()),
                "ask for wavelengths within, or name a file that covers more");
  if (value_.size() == 1) return value_.front();
  const auto after = std::upper_bound(wavelength_m_.begin() + 1, wavelength_m_.end() - 1, wavelength_m);
  const auto i = static_cast<std::size_t>(after - wavelength_m_.begin());
  const double share = (wavelength_m - wavelength_m_[i - 1]) / (wavelength_m_[i] - wavelength_m_[i - 1]);
  return value_[i - 1] + (value_[i] - value_[i - 1]) * share;
}

Spectrum parse_spectrum(const std::string& text, const std::string& place) {
  std::vector<double> wavelengths, values;
  std::istringstream in(text);
  std::string line;
  bool heading = true;  // may still come
  for (int row = 1; std::getline(in, line); ++row) {
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    const auto comma = content.find(',');
    const auto wavelength = number(trimmed(content.substr(0, comma)));
    const auto value = comma == std::string_view::npos ? std::nullopt : number(trimmed(content.substr(comma + 1)));
    const bool skip = heading && !wavelength;
    heading = false;
    if (skip) continue;
    if (!wavelength || !value)
      throw Error(Exit::data, place + ":" + std::to_string(row),
                  "\"" + std::string(content) + "\" is not a wavelength and a value", "write wavelength_nm,value");
    wavelengths.push_back(*wavelength * 1e-9);
    values.push_back(*value);
  }
  return {std::move(wavelengths), std::move(values), place};
}

Spectrum read_spectrum(const std::filesystem::path& path) {
  return parse_spectrum(text_of(path), path.string());
}

}  // namespace gonio::optics
