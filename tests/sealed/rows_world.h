// Worlds of tables: one row per observation, known conditions as columns, one observed column. A derived world gives
// the columns and what an instrument reads in one row.
#pragma once
#include "sealed/camera_chain.h"
#include "sealed/recording.h"
#include "sealed/world.h"

namespace gonio::sealed {

class RowsWorld : public World {
 public:
  Numbers simulate(const Numbers& base, const Sizes& sizes) const override;
  Numbers sigma(const Numbers& clean) const override;
  Numbers noisy(const Numbers& clean, Random& random) const override;
  // Tables are scored by relative errors; dark readings by their noise.
  Numbers norm(const Numbers& observed) const override { return Numbers(observed.size(), 1.0); }
  Numbers reference(const Numbers& clean, const Numbers& sigma) const override;
  bool relative() const override { return true; }
  void write(const Numbers& observed, const Numbers& stated, Case& into) const override;

 protected:
  virtual double reading(const Numbers& base, const Sizes& sizes, std::size_t row) const = 0;
  virtual double noise_of(double reading) const = 0;
  virtual std::string observed_name() const { return "value"; }
  virtual std::string observed_unit() const { return "1"; }
  virtual std::string model() const = 0;
  virtual void describe(Value& manifest, Value& table) const = 0;  // what the base model believes
  double at(const std::string& column, std::size_t row) const;
  std::size_t rows() const { return columns_.empty() ? 0 : columns_[0].values.size(); }
  void add_column(const std::string& name, const std::string& unit) { columns_.push_back({name, unit, {}}); }
  void add_row(const Numbers& values);
  std::vector<Column> columns_;
};

}  // namespace gonio::sealed
