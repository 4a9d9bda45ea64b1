// Bases: the components against a dense decomposition, what is left, folders, files.
#include "goniometry/basis/basis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "data.h"
#include "goniometry/reconstruction/small_basis.h"
#include "io/merl.h"
#include "linear/svd.h"

namespace gonio::tests {
namespace {

using goniometry::Basis;
using goniometry::BasisOptions;
using goniometry::Cells;
using testing::HasSubstr;

// ln(f w + epsilon), sample by sample.
Eigen::MatrixXd levels_of(const goniometry::Tables& tables) {
  const Cells& cells = tables.cells();
  Eigen::MatrixXd levels(tables.materials() * tables.channels(), cells.count());
  std::vector<float> f(cells.count());
  for (Eigen::Index s = 0; s < levels.rows(); ++s) {
    tables.read(s / tables.channels(), s % tables.channels(), 0, cells.bins()[0], f);
    for (std::size_t c = 0; c < f.size(); ++c) levels(s, c) = goniometry::log_level(f[c], cells.weight(c));
  }
  return levels;
}

TEST(Basis, IsTheSingularValueDecomposition) {
  const auto tables = goniometry::tables_of(some_materials(12), small_bins);
  const Basis basis(*tables, "test", {.most_components = 10, .truncation = 0});
  const Eigen::MatrixXd levels = levels_of(*tables);
  const Eigen::RowVectorXd mean = levels.colwise().mean();
  const Eigen::MatrixXd centred = levels.rowwise() - mean;
  const linear::DividedSvd svd(centred, Eigen::ComputeThinU | Eigen::ComputeThinV);
  ASSERT_EQ(basis.components(), 10u);
  ASSERT_EQ(basis.samples(), 36u);
  const double first = svd.singularValues()[0];
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(basis.singular_values()[i], svd.singularValues()[i], 1e-6 * first);
  for (std::size_t c = 0; c < tables->cells().count(); c += 7) {
    ASSERT_NEAR(basis.log_reference()[c] + basis.mean()[c], mean[c], 1e-5);
    for (int i = 0; i < 4; ++i) {  // well apart: the vectors are theirs up to the sign
      const double q = svd.matrixV()(c, i) * svd.singularValues()[i] / std::sqrt(35.0);
      const double sign = svd.matrixV().col(i).dot(Eigen::VectorXd::Ones(levels.cols())) > 0 ? 1 : -1;
      double total = 0;
      for (std::size_t k = 0; k < tables->cells().count(); ++k) total += basis.q(k)[i];
      ASSERT_NEAR(basis.q(c)[i] * (total > 0 ? 1 : -1), q * sign, 1e-4 * svd.singularValues()[i]) << i;
    }
  }
  // Samples are mean and scores to the last component kept.
  Eigen::MatrixXd rebuilt = Eigen::MatrixXd::Zero(levels.rows(), levels.cols());
  for (Eigen::Index s = 0; s < levels.rows(); ++s)
    for (Eigen::Index c = 0; c < levels.cols(); ++c)
      for (std::size_t i = 0; i < 10; ++i) rebuilt(s, c) += basis.scores()[s * 10 + i] * basis.q(c)[i];
  const double left = svd.singularValues().tail(26).norm();
  EXPECT_NEAR((centred - rebuilt).norm(), left, 0.02 * left + 1e-3);
}

// Remainders of every sample when its group is left out: the group less the others' mean, projected on the others less
// theirs, with a ridge; brute force.
Eigen::MatrixXd brute_remainders(const Eigen::MatrixXd& levels, const std::vector<int>& group) {
  const Eigen::Index n = levels.rows();
  const Eigen::MatrixXd centred = levels.rowwise() - levels.colwise().mean();
  const double lambda = 1e-6 * centred.squaredNorm() / (n - 1);
  Eigen::MatrixXd remainders(n, levels.cols());
  for (Eigen::Index s = 0; s < n; ++s) {
    std::vector<Eigen::Index> others;
    for (Eigen::Index o = 0; o < n; ++o)
      if (group[o] != group[s]) others.push_back(o);
    const Eigen::MatrixXd rows = levels(others, Eigen::all);
    const Eigen::RowVectorXd mean = rows.colwise().mean();
    const Eigen::MatrixXd off = rows.rowwise() - mean;
    Eigen::MatrixXd gram = off * off.transpose();
    gram.diagonal().array() += lambda;
    const Eigen::RowVectorXd own = levels.row(s) - mean;
    remainders.row(s) = own - gram.ldlt().solve(off * own.transpose()).transpose() * off;
  }
  return remainders;
}

TEST(Basis, RestIsWhatOtherMaterialsDoNotGive) {
  auto materials = some_materials(8);
  for (auto& material : materials) std::ranges::replace(material.name, ' ', '-');
  const auto tables = goniometry::tables_of(materials, small_bins);
  const Basis basis(*tables, "test", {.most_components = 6, .truncation = 0});
  const Eigen::MatrixXd levels = levels_of(*tables);
  std::vector<int> group;
  for (Eigen::Index s = 0; s < levels.rows(); ++s) group.push_back(static_cast<int>(s / 3));
  const Eigen::MatrixXd remainders = brute_remainders(levels, group).cwiseAbs();
  const Eigen::MatrixXd centred = levels.rowwise() - levels.colwise().mean();
  for (std::size_t c = 0; c < basis.cells().count(); c += 5) {
    double kept = 0;
    for (const float q : basis.q(c)) kept += q * q;
    const double all = centred.col(c).squaredNorm() / (levels.rows() - 1);
    std::vector<double> sorted(remainders.col(c).begin(), remainders.col(c).end());
    std::ranges::sort(sorted);
    const double unexplained = sorted[levels.rows() * 95 / 100] / 1.96;
    ASSERT_NEAR(basis.rest()[c], std::sqrt(unexplained * unexplained + std::max(0.0, all - kept)),
                0.02 * basis.rest()[c] + 1e-3);
    ASSERT_EQ(basis.rest_without(c, 2), basis.rest()[c]);
  }
}

// Where classes hold several materials: the mean over classes of what the other classes do not give them.
TEST(Basis, RestIsWhatOtherClassesDoNotGive) {
  const auto tables = goniometry::tables_of(some_materials(18), small_bins);
  const Basis basis(*tables, "test", {.most_components = 8, .truncation = 0});
  ASSERT_EQ(basis.classes(), 11u);
  const Eigen::MatrixXd levels = levels_of(*tables);
  std::vector<int> group;
  for (Eigen::Index s = 0; s < levels.rows(); ++s) group.push_back(static_cast<int>(basis.class_of(s)));
  const Eigen::MatrixXd remainders = brute_remainders(levels, group);
  const Eigen::MatrixXd centred = levels.rowwise() - levels.colwise().mean();
  for (std::size_t c = 0; c < basis.cells().count(); c += 5) {
    double kept = 0;
    for (const float q : basis.q(c)) kept += q * q;
    const double dropped = std::max(0.0, centred.col(c).squaredNorm() / (levels.rows() - 1) - kept);
    std::vector<double> squares(11), counts(11);
    for (Eigen::Index s = 0; s < levels.rows(); ++s)
      squares[group[s]] += remainders(s, c) * remainders(s, c), ++counts[group[s]];
    double all = 0, without = 0;
    for (int k = 0; k < 11; ++k) {
      all += squares[k] / counts[k] / 11;
      if (k != 3) without += squares[k] / counts[k] / 10;
    }
    ASSERT_NEAR(basis.rest()[c], std::sqrt(all + dropped), 0.02 * basis.rest()[c] + 1e-3);
    ASSERT_NEAR(basis.rest_without(c, 3), std::sqrt(without + dropped), 0.02 * basis.rest()[c] + 1e-3);
  }
}

TEST(Basis, DoesNotDependOnThreads) {
  const auto materials = some_materials(9);
  set_threads(1);
  const Basis one = basis_of(materials);
  set_threads(3);
  const Basis three = basis_of(materials);
  set_threads(0);
  ASSERT_EQ(one.components(), three.components());
  EXPECT_TRUE(std::ranges::equal(one.all_q(), three.all_q()));
  EXPECT_TRUE(std::ranges::equal(one.rest(), three.rest()));
}

TEST(Basis, BuiltInSaysSo) {
  const Basis basis = goniometry::builtin_basis({.bins = small_bins, .materials = 10});
  EXPECT_THAT(basis.description(), HasSubstr("no measurements"));
  EXPECT_EQ(basis.materials().size(), 10u);
  EXPECT_GT(basis.kept_share(), 0.99);
}

void write_table(const std::filesystem::path& file, const goniometry::Material& material,
                 const goniometry::Bins& bins) {
  const Cells cells(bins);
  io::MerlTable table{bins, {}};
  for (std::size_t place = 0; place < bins[0] * bins[1] * bins[2]; ++place) {
    const auto cell = cells.cell_of(place / bins[2] / bins[1], place / bins[2] % bins[1], place % bins[2]);
    const bool seen = cell != Cells::none;
    const auto pair = seen ? cells.directions(cell) : Cells::Pair{};
    const Rgb f = seen ? material.brdf(pair.wo, pair.wi) : Rgb{-1, -1, -1};
    for (int band = 0; band < 3; ++band) table.brdf_per_sr.push_back(static_cast<float>(f[band]));
  }
  io::write_merl(file, table);
}

class BasisFolder : public testing::Test {
 protected:
  void SetUp() override {
    const auto materials = some_materials(5);
    for (std::size_t i = 0; i < materials.size(); ++i)
      write_table(folder.path() / (std::to_string(i) + ".binary"), materials[i], small_bins);
  }
  std::string refusal() const {
    try {
      goniometry::basis_of_folder(folder.path());
    } catch (const Error& error) {
      code = error.code();
      return error.what();
    }
    return "";
  }
  ScratchFolder folder;
  mutable Exit code = Exit::done;
};

TEST_F(BasisFolder, IsThatOfItsTables) {
  auto materials = some_materials(5);
  for (auto& material : materials) std::ranges::replace(material.name, ' ', '-');  // classes of their own, as files are
  const Basis read = goniometry::basis_of_folder(folder.path()), made = basis_of(materials);
  ASSERT_EQ(read.components(), made.components());
  for (std::size_t c = 0; c < read.cells().count(); ++c) {
    ASSERT_NEAR(read.mean()[c] + read.log_reference()[c], made.mean()[c] + made.log_reference()[c], 1e-4);
    ASSERT_NEAR(read.rest()[c], made.rest()[c], 0.02 * made.rest()[c] + 1e-3);
  }
  EXPECT_THAT(read.description(), HasSubstr("5 tables of the folder"));
}

// A cell that was not measured takes its mirror image, else its neighbour.
TEST_F(BasisFolder, FillsWhatWasNotMeasured) {
  io::MerlTable table = io::read_merl(folder.path() / "0.binary");
  for (std::size_t d = 0; d < small_bins[1]; ++d)
    for (int band = 0; band < 3; ++band)
      table.brdf_per_sr[3 * ((3 * small_bins[1] + d) * small_bins[2] + 1) + band] = -1;
  io::write_merl(folder.path() / "0.binary", table);
  const Basis whole = basis_of(some_materials(5)), holed = goniometry::basis_of_folder(folder.path());
  for (std::size_t c = 0; c < whole.cells().count(); ++c)
    ASSERT_NEAR(whole.mean()[c] + whole.log_reference()[c], holed.mean()[c] + holed.log_reference()[c], 1e-4);
}

TEST_F(BasisFolder, RefusesOtherBins) {
  write_table(folder.path() / "odd.binary", some_materials(1)[0], {24, 12, 10});
  EXPECT_THAT(refusal(), testing::AllOf(HasSubstr("odd.binary"), HasSubstr("24 x 12 x 10"), HasSubstr("24 x 12 x 12")));
  EXPECT_EQ(code, Exit::data);
}

TEST_F(BasisFolder, RefusesATruncatedTable) {
  std::filesystem::resize_file(folder.path() / "2.binary", 5000);
  EXPECT_THAT(refusal(), testing::AllOf(HasSubstr("2.binary"), HasSubstr("5000 bytes")));
  EXPECT_EQ(code, Exit::data);
}

TEST_F(BasisFolder, RefusesNumbersThatAreNone) {
  std::string bytes = read_file(folder.path() / "1.binary");
  const double nan = std::nan("");
  std::memcpy(bytes.data() + 12 + 8 * 100, &nan, 8);
  write_file(folder.path() / "1.binary", bytes);
  EXPECT_THAT(refusal(), testing::AllOf(HasSubstr("1.binary"), HasSubstr("entry 100")));
  EXPECT_EQ(code, Exit::data);
}

TEST_F(BasisFolder, RefusesImpossibleBins) {
  std::string bytes = read_file(folder.path() / "1.binary");
  const std::int32_t bins = -7;
  std::memcpy(bytes.data() + 4, &bins, 4);
  write_file(folder.path() / "1.binary", bytes);
  EXPECT_THAT(refusal(), HasSubstr("claims -7 bins"));
}

TEST_F(BasisFolder, NeedsTables) {
  const ScratchFolder empty;
  EXPECT_THROW(goniometry::basis_of_folder(empty.path()), Error);
  EXPECT_THROW(goniometry::basis_of_folder(empty.path() / "nowhere"), Error);
  for (const char* name : {"0", "1", "2"}) std::filesystem::remove(folder.path() / (std::string(name) + ".binary"));
  EXPECT_THAT(refusal(), HasSubstr("needs 3 or more"));
}

class SavedBasis : public testing::Test {
 protected:
  void expect_refused(const std::string& bytes, const char* words) const {
    write_file(file, bytes);
    try {
      Basis::load(file);
      ADD_FAILURE() << "was read: " << words;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("small.basis"), HasSubstr(words)));
      EXPECT_EQ(error.code(), Exit::data);
    }
  }
  ScratchFolder folder;
  std::filesystem::path file = folder.path() / "small.basis";
  Basis basis = basis_of(some_materials(12));
};

TEST_F(SavedBasis, ComesBackWhole) {
  basis.save(file);
  const Basis read = Basis::load(file);
  EXPECT_EQ(read.cells().bins(), basis.cells().bins());
  EXPECT_EQ(read.description(), basis.description());
  EXPECT_EQ(read.materials(), basis.materials());
  EXPECT_EQ(read.material_of(), basis.material_of());
  EXPECT_TRUE(std::ranges::equal(read.mean(), basis.mean()));
  EXPECT_TRUE(std::ranges::equal(read.log_reference(), basis.log_reference()));
  EXPECT_TRUE(std::ranges::equal(read.rest(), basis.rest()));
  for (std::size_t c = 0; c < read.cells().count(); c += 50)
    EXPECT_EQ(read.rest_without(c, 1), basis.rest_without(c, 1));
  EXPECT_TRUE(std::ranges::equal(read.all_q(), basis.all_q()));
  EXPECT_TRUE(std::ranges::equal(read.scores(), basis.scores()));
  EXPECT_EQ(read.kept_share(), basis.kept_share());
}

TEST_F(SavedBasis, RefusesForeignAndDamagedFiles) {
  basis.save(file);
  const std::string good = read_file(file);
  expect_refused("", "is no saved basis");
  expect_refused("PNG and more", "is no saved basis");
  expect_refused(std::string(500, 'x'), "is no saved basis");
  expect_refused(good.substr(0, good.size() / 2), "damaged");
  std::string flipped = good;
  flipped[good.size() / 2] ^= 4;
  expect_refused(flipped, "damaged");
  std::string later = good;
  later[16] = 9;
  expect_refused(later, "has version 9");
}

}  // namespace
}  // namespace gonio::tests
