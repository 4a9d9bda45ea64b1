// A basis of isotropic BRDFs: which reflectance tables are likely, learnt from many of them.
//
// Every material gives three samples, its colour channels, each one vector x of mapped reflectances over the cells of a
// table (goniometry/mapping.h). Channels are separate samples as in Nielsen, Jensen & Ramamoorthi 2015: a joint vector
// would need three times the materials for the same span, and a grey measurement can use all of them; the price is that
// the hue of a reconstruction may wander between measured directions. With the mean m of n samples,
//   X - m = U S V',   Q = V S / sqrt(n - 1),   x = m + Q c + rest,   c ~ N(0, 1) component by component
// so that Q Q' is the samples' covariance. It comes from the Gram matrix (X - m)(X - m)' = U S^2 U', n x n, summed over
// rings of theta_h: Q = (X - m)' U / sqrt(n - 1), in two passes over the tables, of which no more is in memory than one
// block of rings. Components are kept until the rest's standard deviation is `truncation` of the whole's, or up to
// `most_components`.
//
// What no combination of other materials gives: `rest` per cell, of the remainders that are left when a class of
// materials is taken out and projected onto all others. With P = (Gram + lambda 1)^-1 and the rows J of one class they
// are P_JJ^-1 P_J X (the leave-one-out residual of a regression, for a group of rows at once), where P has the mean of
// all taken out of its rows and columns: otherwise weights of -1 on all other samples would give the class' own mean,
// which is a part of m. In a folder of tables every material is a class of its own, and few strange ones would rule the
// root mean square: rest is the 95 % quantile of the magnitude, over 1.96. Where models make classes of many materials,
// a material to be measured belongs to none of them, as if its class had been left out: rest^2 is the mean over classes
// of their mean squares. To either square the components that were not kept are added.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "goniometry/mapping.h"

namespace gonio::goniometry {

struct BasisOptions {
  std::size_t most_components = 48;
  double truncation = 0.003;
};

// Tables that are read ring by ring. Materials of `channels` channels each; values in 1/sr, negative where unknown.
class Tables {
 public:
  virtual ~Tables() = default;
  virtual const Cells& cells() const = 0;
  virtual std::size_t materials() const = 0;
  virtual std::size_t channels() const { return 3; }
  virtual const std::string& name(std::size_t material) const = 0;
  // Rings first <= ring < last of one channel into `f`, one number per cell.
  virtual void read(std::size_t material, std::size_t channel, std::size_t first, std::size_t last,
                    std::span<float> f) const = 0;
};

class Basis {
 public:
  // Error(data) for fewer than three materials.
  Basis(const Tables& tables, std::string description, const BasisOptions& options = {});

  const Cells& cells() const { return *cells_; }
  std::size_t components() const { return components_; }
  std::size_t samples() const { return material_of_.size(); }
  const std::string& description() const { return description_; }  // "100 tables of the folder merl/"
  const std::vector<std::string>& materials() const { return names_; }
  const std::vector<std::uint32_t>& material_of() const { return material_of_; }  // of a sample
  // Materials whose names differ by a number at their end after a blank, "metal 5", "metal 15", are of one class.
  // Tables of files have no blanks there: each is a class of its own, as all are where there would be one or two.
  std::size_t classes() const { return classes_; }
  std::uint32_t class_of(std::size_t sample) const { return class_of_[material_of_[sample]]; }
  // In units of ln: log_reference is ln(f_ref w + epsilon); rest a standard deviation.
  std::span<const float> log_reference() const { return log_reference_; }
  std::span<const float> mean() const { return mean_; }
  std::span<const float> rest() const { return rest_; }
  // `rest` as the other classes would give it; rest() where every material is a class of its own.
  double rest_without(std::size_t cell, std::uint32_t left_out) const;
  std::span<const float> q(std::size_t cell) const { return std::span(q_).subspan(cell * components_, components_); }
  std::span<const float> all_q() const { return q_; }                    // cell by cell
  std::span<const double> scores() const { return scores_; }             // c of every sample, sample by sample
  std::span<const double> singular_values() const { return singular_; }  // all n of them, falling
  double kept_share() const;                                             // of the variance

  // A binary of this program: head, version, numbers, SHA-256 of what precedes. Error(data) for foreign, older or
  // damaged files.
  void save(const std::filesystem::path& file) const;
  static Basis load(const std::filesystem::path& file);

 private:
  Basis() = default;
  friend class BasisBuilder;
  void classify();
  std::shared_ptr<const Cells> cells_;
  std::size_t components_ = 0;
  std::string description_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> material_of_, class_of_;  // of samples, of materials
  std::size_t classes_ = 0;
  std::vector<float> log_reference_, mean_, rest_, q_;
  std::vector<float> class_rest_;  // squares, cell by cell, class by class; empty where these are single materials
  std::vector<double> scores_, singular_;
};

// Every *.binary of a folder, in the order of their names. Error(no_input) for none, Error(data) at the file for tables
// that differ in their bins, are truncated or hold no reflectances.
Basis basis_of_folder(const std::filesystem::path& folder, const BasisOptions& options = {});

// Materials given by functions, for studies: f in 1/sr for red, green and blue.
struct Material {
  std::string name;
  std::function<Rgb(Vec3 wo, Vec3 wi)> brdf;
};
// Evaluates all cells of all materials with all threads; `channels` 1: red alone.
std::unique_ptr<Tables> tables_of(const std::vector<Material>& materials, const Bins& bins, std::size_t channels = 3);

// From analytic models, gonio's own and four laws of others, over a seeded spread of plausible parameters: matte,
// coated, glossy with haze, metals, fabrics. description() says so: it is no collection of measurements.
struct BuiltinOptions {
  Bins bins = merl_bins;
  std::size_t materials = 84;
  std::uint64_t seed = 1;
};
std::vector<Material> builtin_materials(const BuiltinOptions& options);
Basis builtin_basis(const BuiltinOptions& builtin = {}, const BasisOptions& options = {});

}  // namespace gonio::goniometry
