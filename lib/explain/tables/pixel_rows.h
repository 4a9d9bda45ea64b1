// What models of places in photographs share (markers.cpp, probe.cpp): a row is one pixel (u, v), seen by a camera of
// the manifest; parameters reach some rows and leave the others alone.
#pragma once
#include "explain/tables/table_model.h"
#include "geom/vector.h"

namespace gonio::explain::tables {

class PixelRows : public BoundModel {
 public:
  void predict(std::span<const double> values, std::size_t first, std::size_t last,
               std::span<double> prediction) const final;
  // Central differences, one-sided at bounds, in the rows that a parameter reaches.
  void jacobian(std::span<const double> values, std::size_t first, std::size_t last,
                std::span<const std::size_t> columns, std::span<double> derivatives) const final;
  // Half a square for each of two coordinates: the score is the RMS distance, in pixels.
  std::vector<double> norm() const final { return std::vector<double>(2 * rows_, 0.5); }

 protected:
  // Error(data) at the table where it does not observe two columns with their sigmas. `what`: "highlights".
  PixelRows(const Table& table, const std::string& model, const std::string& what);
  virtual Vec2 pixel_of(std::span<const double> values, std::size_t row) const = 0;
  virtual bool reaches(std::size_t parameter, std::size_t row) const = 0;
  // d pixel / d parameter; `at` is left as it was.
  Vec2 slope_of(std::vector<double>& at, std::size_t parameter, std::size_t row) const;

 private:
  std::size_t rows_ = 0;
};

}  // namespace gonio::explain::tables
