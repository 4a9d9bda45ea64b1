// Reader for the part of YAML that the database uses: a list of small maps below `DATA:`, values on the key's line (or
// folded onto more indented ones), tables as literal blocks (`data: |`). Everything else in a file is passed over.
#include "optics/refractive_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

#include "base/error.h"
#include "optics/number_words.h"

namespace gonio::optics {
namespace {

constexpr double micrometre = 1e-6;

struct Entry {  // of the list
  int line = 0;
  std::map<std::string, std::string> values;
};

std::size_t indentation(const std::string& line) {
  return std::min(line.find_first_not_of(" \t"), line.size());
}

// "key: value" at the start of `content`; false where there is no key.
bool split_key(std::string_view content, std::string& key, std::string& value) {
  const auto colon = content.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  if (colon + 1 < content.size() && content[colon + 1] != ' ') return false;
  key = trimmed(content.substr(0, colon));
  value = trimmed(content.substr(colon + 1));
  return true;
}

std::vector<Entry> data_entries(const std::string& text, const std::string& place) {
  std::vector<Entry> entries;
  std::istringstream in(text);
  std::string line, key, value, open;  // open: the key whose value may go on
  std::size_t open_indentation = 0;
  bool inside = false;
  for (int row = 1; std::getline(in, line); ++row) {
    std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    std::size_t indent = indentation(line);
    const bool item = content.front() == '-' && (content.size() == 1 || content[1] == ' ');
    if (indent == 0 && !item) {
      inside = content.starts_with("DATA:");
      open.clear();
      continue;
    }
    if (!inside) continue;
    if (!open.empty() && indent > open_indentation) {
      entries.back().values[open] += "\n" + std::string(content);
      continue;
    }
    if (item) {
      entries.push_back({row, {}});
      content = trimmed(content.substr(1));
      indent += 2;
      if (content.empty()) continue;
    }
    if (entries.empty() || !split_key(content, key, value))
      throw Error(Exit::data, place + ":" + std::to_string(row), "\"" + std::string(content) + "\" is no entry of DATA",
                  "take the file as refractiveindex.info offers it (YAML)");
    if (value.starts_with('|') || value.starts_with('>')) value.clear();
    entries.back().values[key] = value;
    open = key;
    open_indentation = indent;
  }
  return entries;
}

class EntryReader {
 public:
  EntryReader(const Entry& entry, const std::string& place)
      : entry_(entry), place_(place + ":" + std::to_string(entry.line)) {}

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const {
    throw Error(Exit::data, place_, problem, remedy);
  }

  std::vector<double> numbers(const std::string& key) const {
    std::vector<double> result;
    std::istringstream words(text(key));
    for (std::string word; words >> word;) {
      const auto value = number(word);
      if (!value) fail(key + " holds \"" + word + "\"", "numbers, please");
      result.push_back(*value);
    }
    return result;
  }

  DispersionFormula formula(int which) const {
    // Older files say `range`.
    const auto range = numbers(entry_.values.contains("wavelength_range") ? "wavelength_range" : "range");
    if (range.size() != 2 || !(range[0] > 0) || !(range[1] > range[0]))
      fail("the wavelength range is not two growing lengths", "wavelength_range: LOW HIGH in micrometres");
    DispersionFormula result{which, numbers("coefficients"), range[0] * micrometre, range[1] * micrometre};
    constexpr std::array<std::size_t, 10> most = {0, 17, 17, 17, 17, 11, 11, 6, 4, 6};
    const std::size_t limit = most[static_cast<std::size_t>(which)];
    if (result.coefficients.empty() || result.coefficients.size() > limit)
      fail("formula " + std::to_string(which) + " with " + std::to_string(result.coefficients.size()) + " coefficients",
           "it has 1 to " + std::to_string(limit));
    return result;
  }

  // Columns: wavelength in micrometres, then `columns` values.
  std::vector<Spectrum> table(std::size_t columns) const {
    const std::vector<double> all = numbers("data");
    if (all.empty() || all.size() % (columns + 1) != 0)
      fail(std::to_string(all.size()) + " numbers do not make rows of " + std::to_string(columns + 1),
           "write the wavelength in micrometres and its values on each line");
    const std::size_t rows = all.size() / (columns + 1);
    const bool falling = rows > 1 && all[0] > all[columns + 1];
    std::vector<Spectrum> result;
    for (std::size_t c = 1; c <= columns; ++c) {
      std::vector<double> wavelengths, values;
      for (std::size_t i = 0; i < rows; ++i) {
        const std::size_t start = (falling ? rows - 1 - i : i) * (columns + 1);
        if (all[start + c] < 0) fail("negative value in the table", "n and k are not negative");
        wavelengths.push_back(all[start] * micrometre);
        values.push_back(all[start + c]);
      }
      result.emplace_back(std::move(wavelengths), std::move(values), place_);
    }
    return result;
  }

  const std::string& text(const std::string& key) const {
    const auto found = entry_.values.find(key);
    if (found == entry_.values.end()) fail("no `" + key + "`", "every entry of DATA has one");
    return found->second;
  }

 private:
  const Entry& entry_;
  std::string place_;
};

// C(2i) w^C(2i+1), from the coefficient `first` on. Terms without a factor vanish, whatever their other number.
double power_terms(const std::vector<double>& c, std::size_t first, double w) {
  double sum = 0;
  for (std::size_t i = first; i + 1 < c.size(); i += 2)
    if (c[i] != 0) sum += c[i] * std::pow(w, c[i + 1]);
  return sum;
}

template <class Term>
double pair_terms(const std::vector<double>& c, Term term) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < c.size(); i += 2)
    if (c[i] != 0) sum += term(c[i], c[i + 1]);
  return sum;
}

double database_formula(const std::vector<double>& c, double w) {
  const auto at = [&](std::size_t i) { return i < c.size() ? c[i] : 0.0; };
  double sum = at(0);
  for (const std::size_t i : {1u, 5u})
    if (at(i) != 0) sum += at(i) * std::pow(w, at(i + 1)) / (w * w - std::pow(at(i + 2), at(i + 3)));
  return sum + power_terms(c, 9, w);
}

}  // namespace

double DispersionFormula::at(double wavelength_m) const {
  const auto& c = coefficients;
  const auto at = [&](std::size_t i) { return i < c.size() ? c[i] : 0.0; };
  const double w = wavelength_m / micrometre, w2 = w * w;
  const auto root = [](double squared) { return std::sqrt(squared); };  // NaN below zero
  double n = std::numeric_limits<double>::quiet_NaN();
  if (number == 1) n = root(1 + at(0) + pair_terms(c, [&](double a, double b) { return a * w2 / (w2 - b * b); }));
  if (number == 2) n = root(1 + at(0) + pair_terms(c, [&](double a, double b) { return a * w2 / (w2 - b); }));
  if (number == 3) n = root(at(0) + power_terms(c, 1, w));
  if (number == 4) n = root(database_formula(c, w));
  if (number == 5) n = at(0) + power_terms(c, 1, w);
  if (number == 6) n = 1 + at(0) + pair_terms(c, [&](double a, double b) { return a / (b - 1 / w2); });
  if (number == 7) {
    const double l = 1 / (w2 - 0.028);
    n = at(0) + at(1) * l + at(2) * l * l + at(3) * w2 + at(4) * w2 * w2 + at(5) * w2 * w2 * w2;
  }
  if (number == 8) {  // Lorentz & Lorenz: n^2 = (1 + 2 r) / (1 - r)
    const double r = at(0) + (at(1) != 0 ? at(1) * w2 / (w2 - at(2)) : 0) + at(3) * w2;
    n = root((1 + 2 * r) / (1 - r));
  }
  if (number == 9) {
    const double d = w - at(4);
    n = root(at(0) + (at(1) != 0 ? at(1) / (w2 - at(2)) : 0) + (at(3) != 0 ? at(3) * d / (d * d + at(5)) : 0));
  }
  return std::isfinite(n) ? n : std::numeric_limits<double>::quiet_NaN();
}

namespace {

double first_m(const std::variant<DispersionFormula, Spectrum>& part) {
  const auto* formula = std::get_if<DispersionFormula>(&part);
  return formula ? formula->first_m : std::get<Spectrum>(part).first_m();
}
double last_m(const std::variant<DispersionFormula, Spectrum>& part) {
  const auto* formula = std::get_if<DispersionFormula>(&part);
  return formula ? formula->last_m : std::get<Spectrum>(part).last_m();
}

}  // namespace

double RefractiveIndex::n(double wavelength_m) const {
  std::string stated;
  for (const auto& part : n_) {
    if (first_m(part) <= wavelength_m && wavelength_m <= last_m(part)) {
      const auto* formula = std::get_if<DispersionFormula>(&part);
      const double value = formula ? formula->at(wavelength_m) : std::get<Spectrum>(part).at(wavelength_m);
      if (value > 0) return value;
      throw Error(Exit::data, place_, "no positive index at " + nanometres(wavelength_m),
                  "check the coefficients and the range that they were fitted for");
    }
    stated += (stated.empty() ? "" : ", ") + nanometres(first_m(part)) + " to " + nanometres(last_m(part));
  }
  throw Error(Exit::data, place_,
              stated.empty() ? "states no refractive index n"
                             : "n at " + nanometres(wavelength_m) + " is outside of what it states, " + stated,
              "name a file that covers this wavelength");
}

double RefractiveIndex::k(double wavelength_m) const {
  std::string stated;
  for (const Spectrum& part : k_) {
    if (part.covers(wavelength_m)) return part.at(wavelength_m);
    stated += (stated.empty() ? "" : ", ") + nanometres(part.first_m()) + " to " + nanometres(part.last_m());
  }
  throw Error(Exit::data, place_,
              stated.empty() ? "states no extinction coefficient k"
                             : "k at " + nanometres(wavelength_m) + " is outside of what it states, " + stated,
              "name a file that covers this wavelength, or give the parameter a number");
}

Range RefractiveIndex::range_n() const {
  Range range{first_m(n_.front()), last_m(n_.front())};
  for (const auto& part : n_) range = {std::min(range.first_m, first_m(part)), std::max(range.last_m, last_m(part))};
  return range;
}
Range RefractiveIndex::range_k() const {
  Range range = k_.front().range();
  for (const Spectrum& part : k_)
    range = {std::min(range.first_m, part.first_m()), std::max(range.last_m, part.last_m())};
  return range;
}
bool RefractiveIndex::covers_n(double wavelength_m) const {
  return std::ranges::any_of(
      n_, [&](const auto& part) { return first_m(part) <= wavelength_m && wavelength_m <= last_m(part); });
}
bool RefractiveIndex::covers_k(double wavelength_m) const {
  return std::ranges::any_of(k_, [&](const Spectrum& part) { return part.covers(wavelength_m); });
}

RefractiveIndex parse_refractive_index(const std::string& text, const std::string& place) {
  RefractiveIndex result;
  result.place_ = place;
  for (const Entry& entry : data_entries(text, place)) {
    const EntryReader reader(entry, place);
    const std::string& type = reader.text("type");
    if (type.size() == 9 && type.starts_with("formula ") && type[8] >= '1' && type[8] <= '9') {
      result.n_.emplace_back(reader.formula(type[8] - '0'));
    } else if (type == "tabulated nk") {
      auto both = reader.table(2);
      result.n_.emplace_back(std::move(both[0]));
      result.k_.push_back(std::move(both[1]));
    } else if (type == "tabulated n") {
      result.n_.emplace_back(reader.table(1).front());
    } else if (type == "tabulated k") {
      result.k_.push_back(reader.table(1).front());
    } else {
      reader.fail("type \"" + type + "\" is not known", "formula 1 ... 9, tabulated nk, tabulated n, tabulated k");
    }
  }
  if (!result.states_n() && !result.states_k())
    throw Error(Exit::data, place, "no entry below DATA", "take the file as refractiveindex.info offers it (YAML)");
  return result;
}

RefractiveIndex read_refractive_index(const std::filesystem::path& path) {
  return parse_refractive_index(text_of(path), path.string());
}

}  // namespace gonio::optics
