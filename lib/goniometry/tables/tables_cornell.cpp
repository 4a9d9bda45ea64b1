// Cornell's .brdf: comments, the number of wavelengths, the wavelengths in nm, then for each pair of directions
// theta_i phi_i theta_s phi_s in radians and one value in 1/sr per wavelength. Numbers may be wrapped over lines.
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "goniometry/tables/tables_readings.h"
#include "io/csv.h"

namespace gonio::goniometry {
namespace {

struct Token {
  std::string text;
  std::size_t line = 0;
};

std::vector<Token> tokens_of(const std::string& text) {
  std::vector<Token> tokens;
  std::size_t line = 1;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '#') at = std::min(text.find('\n', at), text.size());
    if (at < text.size() && text[at] == '\n') ++line;
    const auto end = std::min(text.find_first_of(" \t\r\n#", at), text.size());
    if (end > at) tokens.push_back({text.substr(at, end - at), line});
    at = end > at ? end : at + 1;
  }
  return tokens;
}

}  // namespace

std::string band_text(double wavelength_m) {
  return shortest_text(std::round(wavelength_m * 1e11) / 100) + " nm";
}

Readings cornell_readings(const std::string& text, const std::string& name) {
  const std::vector<Token> tokens = tokens_of(text);
  const auto number = [&](std::size_t i) {
    const std::string& word = tokens[i].text;
    if (word == "nan" || word == "NaN") return std::nan("");
    return io::csv_number(word, name + ":" + std::to_string(tokens[i].line));
  };
  if (tokens.empty()) throw Error(Exit::data, name, "is empty", "a .brdf begins with its number of wavelengths");
  const double announced = number(0);
  if (!(announced >= 1 && announced <= 4096 && announced == std::floor(announced)))
    throw Error(Exit::data, name + ":" + std::to_string(tokens[0].line),
                "\"" + tokens[0].text + "\" is no number of wavelengths",
                "a .brdf begins with it; other tables are named *.csv or *.txt");
  const auto bands = static_cast<std::size_t>(announced);
  Readings out{name, {}, {"theta_i", "phi_i", "theta_s", "phi_s"}, true, {}, {}, {}, {}, {}, {}, Mirror::opposite};
  if (tokens.size() < 1 + bands + 4 + bands) {
    for (std::size_t i = 1; i < tokens.size(); ++i) number(i);
    throw Error(Exit::data, name + ":" + std::to_string(tokens.back().line),
                "ends within its first row: " + std::to_string(bands) + " wavelengths and " +
                    std::to_string(4 + bands) + " numbers are announced, " + std::to_string(tokens.size() - 1) +
                    " are there",
                "copy the whole file");
  }
  for (std::size_t b = 0; b < bands; ++b) {
    out.band_m.push_back(number(1 + b) * 1e-9);
    out.band_name.push_back(band_text(out.band_m.back()));
  }
  const std::size_t width = 4 + bands, start = 1 + bands;
  if ((tokens.size() - start) % width != 0)
    throw Error(Exit::data, name + ":" + std::to_string(tokens.back().line),
                "ends within a row: " + std::to_string((tokens.size() - start) % width) + " of " +
                    std::to_string(width) + " numbers",
                "copy the whole file");
  for (std::size_t i = start; i < tokens.size(); i += width) {
    out.angles.push_back({number(i), number(i + 1), number(i + 2), number(i + 3)});
    for (std::size_t b = 0; b < bands; ++b) out.f.push_back(number(i + 4 + b));
    out.place.push_back(name + ":" + std::to_string(tokens[i].line));
  }
  return out;
}

}  // namespace gonio::goniometry
