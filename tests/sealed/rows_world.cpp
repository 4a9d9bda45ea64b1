#include "sealed/rows_world.h"

#include <cmath>
#include <stdexcept>

namespace gonio::sealed {

Numbers RowsWorld::simulate(const Numbers& base, const Sizes& sizes) const {
  Numbers values(rows());
  for (std::size_t r = 0; r < values.size(); ++r) values[r] = reading(base, sizes, r);
  return values;
}

Numbers RowsWorld::sigma(const Numbers& clean) const {
  Numbers s(clean.size());
  for (std::size_t r = 0; r < s.size(); ++r) s[r] = noise_of(clean[r]);
  return s;
}

Numbers RowsWorld::noisy(const Numbers& clean, Random& random) const {
  Numbers values = clean;
  for (double& v : values) v += noise_of(v) * random.normal();
  return values;
}

Numbers RowsWorld::reference(const Numbers& clean, const Numbers& sigma) const {
  Numbers r(clean.size());
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = std::hypot(clean[i], 10 * sigma[i]);
  return r;
}

double RowsWorld::at(const std::string& column, std::size_t row) const {
  for (const Column& c : columns_)
    if (c.name == column) return c.values[row];
  throw std::runtime_error("no column " + column);
}

void RowsWorld::add_row(const Numbers& values) {
  for (std::size_t c = 0; c < columns_.size(); ++c) columns_[c].values.push_back(values.at(c));
}

void RowsWorld::write(const Numbers& observed, const Numbers& stated, Case& into) const {
  std::vector<Column> columns = columns_;
  columns.push_back({observed_name(), observed_unit(), observed});
  columns.push_back({observed_name() + "_sigma", observed_unit(), stated});
  into.files["table.csv"] = csv(columns);
  Value manifest = Value::object();
  Value table = table_section(model(), columns, {observed_name()}, {observed_name() + "_sigma"});
  describe(manifest, table);
  manifest["tables"]["t"] = table;
  finish(manifest, into);
}

}  // namespace gonio::sealed
