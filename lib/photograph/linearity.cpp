// See linearity.h.
#include "photograph/linearity.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "io/csv.h"

namespace gonio::photograph {
namespace {

constexpr const char* remedy = "a table from code 0 on, of codes above black and linear codes that rise together";

[[noreturn]] void refuse(const std::string& place, const std::string& what) {
  throw Error(Exit::data, place, what, remedy);
}

}  // namespace

Linearity::Linearity(std::vector<LinearityRow> rows, const std::string& place) : rows_(std::move(rows)), place_(place) {
  if (rows_.size() < 2) refuse(place, format("has %zu row(s) of a linearity table", rows_.size()));
  if (rows_[0].code > 0) refuse(place, format("begins at code %g", rows_[0].code));
  for (std::size_t i = 1; i < rows_.size(); ++i) {
    if (!(rows_[i].code > rows_[i - 1].code))
      refuse(place, format("has code %g behind code %g", rows_[i].code, rows_[i - 1].code));
    if (!(rows_[i].linear > rows_[i - 1].linear))
      refuse(place,
             format("has linear code %g behind %g, at code %g", rows_[i].linear, rows_[i - 1].linear, rows_[i].code));
  }
}

std::size_t Linearity::piece(double code) const {
  const auto above = std::ranges::upper_bound(rows_, code, {}, &LinearityRow::code);
  const auto last = static_cast<std::ptrdiff_t>(rows_.size()) - 2;
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - rows_.begin() - 1, 0, last));
}

double Linearity::operator()(double code) const {
  const LinearityRow &a = rows_[piece(code)], &b = (&a)[1];
  return a.linear + (code - a.code) * (b.linear - a.linear) / (b.code - a.code);
}

double Linearity::slope(double code) const {
  const auto of = [&](std::size_t i) {
    return (rows_[i + 1].linear - rows_[i].linear) / (rows_[i + 1].code - rows_[i].code);
  };
  const std::size_t i = piece(code);
  return i > 0 && code == rows_[i].code ? (of(i - 1) + of(i)) / 2 : of(i);
}

double Linearity::code_of(double linear) const {
  const auto above = std::ranges::upper_bound(rows_, linear, {}, &LinearityRow::linear);
  const auto last = static_cast<std::ptrdiff_t>(rows_.size()) - 2;
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - rows_.begin() - 1, 0, last));
  const LinearityRow &a = rows_[i], &b = rows_[i + 1];
  return a.code + (linear - a.linear) * (b.code - a.code) / (b.linear - a.linear);
}

NoiseModel Linearity::noise(const manifest::Noise& of_codes, double full) const {
  constexpr std::size_t nodes = 1024;
  NoiseModel model(of_codes);
  model.spacing = full / (nodes - 1);
  for (std::size_t i = 0; i < nodes; ++i) {
    const double code = code_of(static_cast<double>(i) * model.spacing), s = slope(code);
    model.variances.push_back(s * s * noise_variance(of_codes, code));
  }
  return model;
}

Linearity read_linearity(const std::filesystem::path& path) {
  const io::Csv csv = io::read_csv(path);
  const auto column = [&](const char* name) { return std::ranges::find(csv.header, name) - csv.header.begin(); };
  const auto code = column("code"), linear = column("linear"), sigma = column("sigma"),
             none = static_cast<std::ptrdiff_t>(csv.header.size());
  if (code == none || linear == none) refuse(csv.name, "has no columns \"code\" and \"linear\"");
  std::vector<LinearityRow> rows;
  for (std::size_t r = 0; r < csv.rows.size(); ++r) {
    const auto number = [&](std::ptrdiff_t at) {
      return at == none ? 0 : io::csv_number(csv.rows[r][static_cast<std::size_t>(at)], csv.place(r));
    };
    rows.push_back({number(code), number(linear), number(sigma)});
  }
  return {std::move(rows), csv.name};
}

std::string linearity_csv(const std::vector<LinearityRow>& rows) {
  std::string text = "code,linear,sigma\n";
  for (const LinearityRow& r : rows)
    text += shortest_text(r.code) + "," + shortest_text(r.linear) + "," + shortest_text(r.sigma) + "\n";
  return text;
}

}  // namespace gonio::photograph
