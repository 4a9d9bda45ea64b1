// Sampled spectra: values over the wavelength (metres), linear in between. Outside of what was measured there is no
// value: Error(data), never a guess.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonio::optics {

struct Range {
  double first_m, last_m;
  bool operator==(const Range&) const = default;
};

class Spectrum {
 public:
  // Wavelengths grow; one or more samples. Error(data) at `place` else, or for numbers that are not finite.
  Spectrum(std::vector<double> wavelength_m, std::vector<double> value, std::string place);

  double first_m() const { return wavelength_m_.front(); }
  double last_m() const { return wavelength_m_.back(); }
  bool covers(double wavelength_m) const { return wavelength_m >= first_m() && wavelength_m <= last_m(); }
  Range range() const { return {first_m(), last_m()}; }
  double at(double wavelength_m) const;
  const std::string& place() const { return place_; }

 private:
  std::vector<double> wavelength_m_, value_;
  std::string place_;
};

// CSV: two columns, wavelength in nanometres and value; one heading line may stand first (wavelength_nm,value), and
// lines that start with # are comments. Error(no_input | data) at the file and line.
Spectrum read_spectrum(const std::filesystem::path& path);
Spectrum parse_spectrum(const std::string& text, const std::string& place);

// "580 nm": for messages.
std::string nanometres(double wavelength_m);

}  // namespace gonio::optics
