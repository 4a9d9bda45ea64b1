// See pixel_rows.h.
#include "explain/tables/pixel_rows.h"

#include <algorithm>

#include "base/error.h"

namespace gonio::explain::tables {

PixelRows::PixelRows(const Table& table, const std::string& model, const std::string& what) : rows_(table.rows()) {
  if (table.observed.size() != 2)
    throw Error(Exit::data, table.place + "/observed", "names " + std::to_string(table.observed.size()) + " columns",
                "model " + model + " predicts two: u_px and v_px");
  if (table.sigma.empty())
    throw Error(Exit::data, table.place, "does not say how well the " + what + " were found",
                "give columns u_sigma_px and v_sigma_px");
}

void PixelRows::predict(std::span<const double> values, std::size_t first, std::size_t last,
                        std::span<double> prediction) const {
  for (std::size_t r = first; r < last; ++r) {
    const Vec2 pixel = pixel_of(values, r);
    prediction[2 * (r - first)] = pixel.x;
    prediction[2 * (r - first) + 1] = pixel.y;
  }
}

Vec2 PixelRows::slope_of(std::vector<double>& at, std::size_t parameter, std::size_t row) const {
  const Parameter& p = parameters_[parameter];
  const double centre = at[parameter], step = 1e-4 * p.size, above = std::min(centre + step, p.upper),
               below = std::max(centre - step, p.lower);
  at[parameter] = above;
  const Vec2 after = pixel_of(at, row);
  at[parameter] = below;
  const Vec2 before = pixel_of(at, row);
  at[parameter] = centre;
  return (after - before) * (1 / (above - below));
}

void PixelRows::jacobian(std::span<const double> values, std::size_t first, std::size_t last,
                         std::span<const std::size_t> columns, std::span<double> derivatives) const {
  std::vector<double> at(values.begin(), values.end());
  const std::size_t height = 2 * (last - first);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t r = first; r < last; ++r) {
      const Vec2 slope = reaches(columns[c], r) ? slope_of(at, columns[c], r) : Vec2{};
      derivatives[c * height + 2 * (r - first)] = slope.x;
      derivatives[c * height + 2 * (r - first) + 1] = slope.y;
    }
}

}  // namespace gonio::explain::tables
