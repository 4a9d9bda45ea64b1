// Columns with names: which column is which angle, band or sigma, and in which unit. What the user says (--columns)
// comes first; names that mean one thing only are known without.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "goniometry/tables/tables_readings.h"
#include "io/csv.h"
#include "manifest/fields.h"

namespace gonio::goniometry {
namespace {

constexpr std::array<const char*, 4> angle_names = {"theta_i", "phi_i", "theta_o", "phi_o"};
const std::vector<std::string> quantities = {"theta_i", "phi_i",      "theta_o", "phi_o", "f",
                                             "sigma",   "wavelength", "channel", "series"};
const std::map<std::string, std::string> known_names = {{"theta_i", "theta_i"},
                                                        {"theta_in", "theta_i"},
                                                        {"theta_inc", "theta_i"},
                                                        {"phi_i", "phi_i"},
                                                        {"phi_in", "phi_i"},
                                                        {"phi_inc", "phi_i"},
                                                        {"theta_o", "theta_o"},
                                                        {"theta_s", "theta_o"},
                                                        {"theta_r", "theta_o"},
                                                        {"theta_out", "theta_o"},
                                                        {"phi_o", "phi_o"},
                                                        {"phi_s", "phi_o"},
                                                        {"phi_r", "phi_o"},
                                                        {"phi_out", "phi_o"},
                                                        {"f", "f"},
                                                        {"brdf", "f"},
                                                        {"r", "f"},
                                                        {"g", "f"},
                                                        {"b", "f"},
                                                        {"red", "f"},
                                                        {"green", "f"},
                                                        {"blue", "f"},
                                                        {"sigma", "sigma"},
                                                        {"wavelength", "wavelength"},
                                                        {"lambda", "wavelength"},
                                                        {"channel", "channel"},
                                                        {"series", "series"},
                                                        {"f_sigma", "sigma"},
                                                        {"sigma_f", "sigma"},
                                                        {"f_r", "f"},
                                                        {"f_g", "f"},
                                                        {"f_b", "f"}};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

struct Heading {
  std::string name, unit;
};
// "theta_i [deg]", "theta_i (deg)", "theta_i_deg", "lambda/nm".
Heading heading_of(const std::string& text) {
  const auto bracket = text.find_first_of("[(");
  if (bracket != std::string::npos && bracket > 0) {
    const auto end = text.find_first_of("])", bracket);
    const auto last = text.find_last_not_of(" \t", bracket - 1);
    return {text.substr(0, last + 1),
            text.substr(bracket + 1, (end == std::string::npos ? text.size() : end) - bracket - 1)};
  }
  for (const std::string unit : {"deg", "rad", "nm", "um", "m"})
    for (const char mark : {'_', '/'})
      if (text.size() > unit.size() + 1 && text.ends_with(unit) && text[text.size() - unit.size() - 1] == mark)
        return {text.substr(0, text.size() - unit.size() - 1), unit};
  for (const std::string end : {"_per_sr", "_1/sr"})
    if (text.ends_with(end)) return {text.substr(0, text.size() - end.size()), "1/sr"};
  return {text, ""};
}

// "550nm", "550 nm", "f_550nm", "brdf_550.5 nm": a band; nothing for other names.
std::optional<double> wavelength_in(const std::string& text) {
  std::string name = lower(text);
  for (const std::string start : {"f_", "brdf_", "sigma_"})
    if (name.starts_with(start)) name = name.substr(start.size());
  if (!name.ends_with("nm")) return {};
  name.resize(name.size() - 2);
  while (!name.empty() && (name.back() == ' ' || name.back() == '_')) name.pop_back();
  try {
    return io::csv_number(name, "") * 1e-9;
  } catch (const Error&) {
    return {};
  }
}

// What a column is used for.
struct Use {
  std::string quantity;
  std::size_t column = 0;
  std::string unit, name;
  std::optional<double> constant;  // "@0": no column, but a number for all rows
};

class Columns {
 public:
  Columns(const TextTable& table, const TableOptions& options) : table_(table), options_(options) {
    for (const ColumnUse& use : options.columns) add_stated(use);
    for (std::size_t c = 0; c < table.heading.size(); ++c) add_known(c);
    for (const char* angle : angle_names) needed(angle);
    if (of("f").empty()) missing("f", "the reflectance in 1/sr");
    pair_sigmas();
  }
  const Use& angle(std::size_t k) const { return *of(angle_names[k]).front(); }
  std::vector<const Use*> of(const std::string& quantity) const {
    std::vector<const Use*> found;
    for (const Use& use : uses_)
      if (use.quantity == quantity) found.push_back(&use);
    return found;
  }
  const std::vector<const Use*>& sigmas() const { return sigmas_; }  // one per f, or none
  double factor(const Use& use) const {
    if (use.unit == "deg") return pi / 180;
    if (use.unit == "rad") return 1;
    if (!use.unit.empty())
      throw Error(Exit::data, table_.heading_place(), "column \"" + use.name + "\" is an angle in " + use.unit,
                  "angles are in deg or rad");
    if (options_.angles.empty())
      throw Error(
          Exit::data, table_.heading_place(), "column \"" + use.name + "\" states no unit",
          "name it \"" + use.name + " [deg]\" or \"" + use.name + " [rad]\", or say --angles deg or --angles rad");
    return options_.angles == "deg" ? pi / 180 : 1;
  }
  double length_factor(const Use& use) const {
    const std::map<std::string, double> units = {{"nm", 1e-9}, {"um", 1e-6}, {"m", 1}};
    const auto found = units.find(use.unit);
    if (found == units.end())
      throw Error(Exit::data, table_.heading_place(), "column \"" + use.name + "\" states no unit of length",
                  "name it \"" + use.name + " [nm]\", or say --columns wavelength=" + use.name + ":nm");
    return found->second;
  }

 private:
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (std::size_t c = 0; c < table_.heading.size(); ++c)
      all.push_back(table_.heading[c].empty() ? "#" + std::to_string(c + 1) : table_.heading[c]);
    return all;
  }
  std::size_t column_called(const std::string& name) const {
    if (name.starts_with("#")) {
      const double n = io::csv_number(name.substr(1), "--columns: " + name);
      if (n >= 1 && n <= static_cast<double>(table_.heading.size())) return static_cast<std::size_t>(n) - 1;
    }
    for (std::size_t c = 0; c < table_.heading.size(); ++c)
      if (table_.heading[c] == name || heading_of(table_.heading[c]).name == name) return c;
    throw Error(Exit::data, table_.heading_place(), "has no column \"" + name + "\", which --columns names",
                manifest::remedy_for(name, names()));
  }
  void add_stated(const ColumnUse& use) {
    if (use.column.starts_with("@")) {
      uses_.push_back({use.quantity, 0, use.unit, use.column, io::csv_number(use.column.substr(1), "--columns")});
      return;
    }
    const std::size_t c = column_called(use.column);
    std::string unit = heading_of(table_.heading[c]).unit;
    if (!use.unit.empty() && (unit.empty() || !use.heading_first)) unit = use.unit;
    uses_.push_back({use.quantity, c, std::move(unit), table_.heading[c].empty() ? use.column : table_.heading[c], {}});
    stated_.push_back(use.quantity);
  }
  void add_known(std::size_t c) {
    const std::string& text = table_.heading[c];
    if (text.empty() || std::ranges::any_of(uses_, [c](const Use& u) { return !u.constant && u.column == c; })) return;
    const Heading heading = heading_of(text);
    std::string quantity;
    if (const auto known = known_names.find(lower(heading.name)); known != known_names.end())
      quantity = known->second;
    else if (wavelength_in(text))
      quantity = lower(text).starts_with("sigma_") ? "sigma" : "f";
    else if (lower(heading.name).ends_with("_sigma") || lower(heading.name).starts_with("sigma_"))
      quantity = "sigma";
    if (quantity.empty() || std::ranges::find(stated_, quantity) != stated_.end()) return;
    if (std::ranges::any_of(uses_, [&](const Use& u) { return u.constant && u.quantity == quantity; })) return;
    if (quantity != "f" && quantity != "sigma" && !of(quantity).empty())
      throw Error(Exit::data, table_.heading_place(),
                  "\"" + of(quantity).front()->name + "\" and \"" + text + "\" could both be " + quantity,
                  "say which: --columns " + quantity + "=" + text);
    uses_.push_back({quantity, c, heading.unit, text, {}});
  }
  void needed(const std::string& quantity) const {
    const auto found = of(quantity);
    if (found.empty()) missing(quantity, quantity.starts_with("theta") ? "a zenith angle" : "an azimuth");
    if (found.size() > 1) throw Error(Exit::usage, "--columns", "names " + quantity + " twice");
  }
  [[noreturn]] void missing(const std::string& quantity, const std::string& meaning) const {
    std::string have;
    for (const std::string& name : names()) have += (have.empty() ? "" : ", ") + name;
    throw Error(Exit::data, table_.heading_place(),
                "has no column for " + quantity + ", " + meaning + " (there is " + have + ")",
                quantity.starts_with("phi")
                    ? "name it with --columns " + quantity + "=COLUMN:UNIT; scans in one plane: " + quantity + "=@0:deg"
                    : "name it with --columns " + quantity + "=COLUMN:UNIT");
  }
  // f_550nm_sigma or sigma_550nm beside f_550nm; one sigma beside one f; or as many as there are, in order.
  void pair_sigmas() {
    const auto f = of("f"), sigma = of("sigma");
    if (sigma.empty()) return;
    if (f.size() != sigma.size())
      throw Error(Exit::data, table_.heading_place(),
                  "has " + std::to_string(f.size()) + " columns of values and " + std::to_string(sigma.size()) +
                      " of their sigma",
                  "give each value one, or none");
    sigmas_ = sigma;
  }

  const TextTable& table_;
  const TableOptions& options_;
  std::vector<Use> uses_;
  std::vector<std::string> stated_;
  std::vector<const Use*> sigmas_;
};

class Numbers {
 public:
  explicit Numbers(const TextTable& table) : table_(table) {}
  double at(std::size_t row, const Use& use) const {
    if (use.constant) return *use.constant;
    const std::string& cell = table_.rows[row][use.column];
    if (const std::string word = lower(cell); word == "nan" || word == "-nan") return std::nan("");
    return io::csv_number(cell, table_.place(row) + ": " + use.name);
  }

 private:
  const TextTable& table_;
};

std::string channel_text(double channel) {
  const long c = std::lround(channel);
  return c == 0 ? "r" : c == 1 ? "g" : c == 2 ? "b" : std::to_string(c);
}

std::string band_of_column(const Use& use, std::size_t count) {
  const Heading heading = heading_of(use.name);
  std::string name = lower(heading.name);
  if (name.starts_with("f_")) name = name.substr(2);
  if (name == "red" || name == "green" || name == "blue") return name.substr(0, 1);
  if (name == "r" || name == "g" || name == "b") return name;
  return count == 1 ? "" : heading.name;
}

void bands_by_column(const TextTable& table, const Columns& columns, Readings& out) {
  const auto f = columns.of("f");
  for (const Use* use : f)
    if (const auto wavelength = wavelength_in(use->name)) out.band_m.push_back(*wavelength);
  if (out.band_m.size() != f.size()) out.band_m.clear();
  for (std::size_t b = 0; b < f.size(); ++b)
    out.band_name.push_back(out.band_m.empty() ? band_of_column(*f[b], f.size()) : band_text(out.band_m[b]));
  const Numbers numbers(table);
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    for (std::size_t b = 0; b < f.size(); ++b) {
      out.f.push_back(numbers.at(r, *f[b]));
      if (!columns.sigmas().empty()) out.sigma.push_back(numbers.at(r, *columns.sigmas()[b]));
    }
}

// One value a row, its band in a column: rows of the same directions become one.
void bands_by_row(const TextTable& table, const Columns& columns, Readings& out) {
  const auto wavelength = columns.of("wavelength"), channel = columns.of("channel");
  const Use& which = wavelength.empty() ? *channel.front() : *wavelength.front();
  const Numbers numbers(table);
  const double scale = wavelength.empty() ? 1 : columns.length_factor(which) * 1e12;  // picometres
  std::map<long, std::size_t> bands;
  std::vector<long> key;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const double value = numbers.at(r, which) * scale;
    if (!wavelength.empty()) check_wavelength(value * 1e-12, out.place[r] + ": " + which.name);
    key.push_back(std::lround(value));
    bands.try_emplace(key.back(), 0);
  }
  if (bands.size() > 256)
    throw Error(Exit::data, table.heading_place(),
                "column \"" + which.name + "\" has " + std::to_string(bands.size()) + " different values",
                "keep at most 256 bands");
  for (std::size_t next = 0; auto& [k, place] : bands) {
    place = next++;
    if (!wavelength.empty()) out.band_m.push_back(static_cast<double>(k) * 1e-12);
    out.band_name.push_back(wavelength.empty() ? channel_text(static_cast<double>(k)) : band_text(out.band_m.back()));
  }
  const std::size_t n = bands.size();
  std::map<std::array<double, 4>, std::size_t> known;
  Readings merged = out;
  merged.angles.clear(), merged.place.clear(), merged.series.clear();
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto [found, fresh] = known.try_emplace(out.angles[r], merged.angles.size());
    if (fresh) {
      merged.angles.push_back(out.angles[r]), merged.place.push_back(out.place[r]);
      if (!out.series.empty()) merged.series.push_back(out.series[r]);
      merged.f.resize(merged.f.size() + n, std::nan(""));
      if (!columns.sigmas().empty()) merged.sigma.resize(merged.sigma.size() + n, std::nan(""));
    }
    const std::size_t cell = found->second * n + bands.at(key[r]);
    merged.f[cell] = numbers.at(r, *columns.of("f").front());
    if (!columns.sigmas().empty()) merged.sigma[cell] = numbers.at(r, *columns.sigmas().front());
  }
  out = std::move(merged);
}

}  // namespace

std::vector<ColumnUse> parse_columns(const std::string& text, const std::string& place) {
  std::vector<ColumnUse> uses;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string pair = text.substr(at, end - at);
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size())
      throw Error(Exit::usage, place, "\"" + pair + "\" is not QUANTITY=COLUMN[:UNIT]", "write theta_i=phi_in:deg");
    ColumnUse use{pair.substr(0, equals), pair.substr(equals + 1), {}};
    if (const auto colon = use.column.rfind(':'); colon != std::string::npos)
      use.unit = use.column.substr(colon + 1), use.column.resize(colon);
    if (std::ranges::find(quantities, use.quantity) == quantities.end())
      throw Error(Exit::usage, place, "\"" + use.quantity + "\" is no quantity of a table",
                  manifest::remedy_for(use.quantity, quantities));
    uses.push_back(std::move(use));
    at = end + 1;
  }
  return uses;
}

Readings column_readings(const TextTable& table, const TableOptions& options) {
  const Columns columns(table, options);
  Readings out{table.name, {}, {}, false, {}, {}, {}, {}, {}, {}};
  const Numbers numbers(table);
  std::array<double, 4> factor{};
  for (std::size_t k = 0; k < 4; ++k) {
    factor[k] = columns.factor(columns.angle(k));
    out.angle_name[k] = columns.angle(k).name;
    out.said_radians = out.said_radians || factor[k] == 1;
  }
  const auto series = columns.of("series");
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    std::array<double, 4> angles{};
    for (std::size_t k = 0; k < 4; ++k) angles[k] = factor[k] * numbers.at(r, columns.angle(k));
    out.angles.push_back(angles);
    out.place.push_back(table.place(r));
    if (!series.empty()) out.series.push_back(table.rows[r][series.front()->column]);
  }
  const bool by_row = columns.of("f").size() == 1 && columns.of("wavelength").size() + columns.of("channel").size() > 0;
  if (by_row)
    bands_by_row(table, columns, out);
  else
    bands_by_column(table, columns, out);
  return out;
}

}  // namespace gonio::goniometry
