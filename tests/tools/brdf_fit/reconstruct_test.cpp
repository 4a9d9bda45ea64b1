// brdf-fit --reconstruct, and what --merl writes, as a person runs them, with a small basis that was saved.
// One process: Reconstruct.*
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "geom/vector.h"
#include "goniometry/reconstruct/reconstruction.h"
#include "io/merl.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "process.h"

namespace gonio {
namespace {

using testing::Contains;
using testing::HasSubstr;
using tests::Ended;

class Reconstruct : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    goniometry::builtin_basis({.bins = {24, 12, 12}, .materials = 30}).save(shared().path() / "small.basis");
  }
  static const tests::ScratchFolder& shared() {
    static const tests::ScratchFolder folder;
    return folder;
  }
  Ended run(std::vector<std::string> words) {
    words.insert(words.begin(), "brdf-fit");
    return tests::Process(words, folder_.path()).end();
  }
  Ended reconstruct(std::vector<std::string> more) {
    std::vector<std::string> words = {"--reconstruct", "--basis", (shared().path() / "small.basis").string()};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  tests::ScratchFolder folder_;
};

TEST_F(Reconstruct, WritesTheTableItsSigmaAndTheSurface) {
  write_file(folder_.path() / "paint.csv", run({"--example"}).out);
  const Ended ended = reconstruct({"--merl", "paint.binary", "--merl-sigma", "sigma.binary", "paint.csv"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const io::MerlTable table = io::read_merl(folder_.path() / "paint.binary"),
                      sigma = io::read_merl(folder_.path() / "sigma.binary");
  ASSERT_EQ(table.bins, sigma.bins);
  std::size_t above = 0;
  for (std::size_t i = 0; i < table.brdf_per_sr.size(); ++i) {
    EXPECT_EQ(table.brdf_per_sr[i] < 0, sigma.brdf_per_sr[i] < 0);
    if (table.brdf_per_sr[i] < 0) continue;
    EXPECT_GT(sigma.brdf_per_sr[i], 0);
    ++above;
  }
  EXPECT_GT(above, table.brdf_per_sr.size() / 2);
  const auto document = manifest::parse_document(ended.out, "out.json", folder_.path());
  EXPECT_EQ(document.surfaces.at("paint").model, "merl");
  const auto& fit = document.surface_fits.at("paint");
  EXPECT_EQ(fit.verdict, "good");
  EXPECT_THAT(fit.basis, HasSubstr("no measurements"));
  EXPECT_THAT(fit.notes, Contains(HasSubstr("with all of their class")));
  EXPECT_EQ(fit.files.count("merl_sigma"), 1u);
}

// Six bands become three, and the manifest says that they are means and of what.
TEST_F(Reconstruct, NamesTheBandsThatItAverages) {
  std::string text = "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],wavelength [nm],f\n";
  for (const double to : {10.0, 30.0, 50.0})
    for (const int nm : {440, 470, 520, 560, 620, 680}) text += format("30,0,%g,180,%d,%g\n", to, nm, nm / 2000.0);
  write_file(folder_.path() / "six.csv", text);
  const Ended ended = reconstruct({"--mirror", "180", "--merl", "six.binary", "six.csv"});
  ASSERT_TRUE(ended.status == 0 || ended.status == 2) << ended.err;
  const auto bands = manifest::parse_document(ended.out, "out", folder_.path()).surface_fits.at("six").written_bands;
  ASSERT_EQ(bands.size(), 3u);
  EXPECT_THAT(bands[0], HasSubstr("mean of 2 bands"));
  EXPECT_THAT(bands[0], testing::AllOf(HasSubstr("620"), HasSubstr("680")));
  EXPECT_THAT(bands[2], testing::AllOf(HasSubstr("440"), HasSubstr("470")));
}

// Reflectances ten times those of a white sheet: written, doubted in clear words, status 2, and no surface that render
// would refuse.
TEST_F(Reconstruct, DoubtsATableThatReflectsMoreThanItReceives) {
  std::string text = "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],f\n";
  for (const double ti : {10.0, 40.0, 65.0})
    for (const double to : {5.0, 30.0, 60.0})
      for (const double po : {0.0, 180.0}) text += format("%g,0,%g,%g,3.2\n", ti, to, po);
  write_file(folder_.path() / "bright.csv", text);
  const Ended ended =
      reconstruct({"--mirror", "180", "--merl", "bright.binary", "--html", "bright.html", "bright.csv"});
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("times the light that it receives"));
  const auto document = manifest::parse_document(ended.out, "out", folder_.path());
  EXPECT_EQ(document.surface_fits.at("bright").verdict, "doubtful");
  EXPECT_GT(*document.surface_fits.at("bright").energy, 2);
  EXPECT_FALSE(document.surfaces.contains("bright"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "bright.binary"));
}

// --plan with a table names pairs that add to it; other pairs than without.
TEST_F(Reconstruct, PlansWhatWouldAdd) {
  write_file(folder_.path() / "paint.csv", run({"--example"}).out);
  const std::string basis = (shared().path() / "small.basis").string();
  const Ended fresh = run({"--plan", "3", "--basis", basis}),
              added = run({"--plan", "3", "--basis", basis, "paint.csv"});
  ASSERT_EQ(fresh.status, 0) << fresh.err;
  ASSERT_EQ(added.status, 0) << added.err;
  EXPECT_EQ(std::ranges::count(added.out, '\n'), 4);
  EXPECT_NE(fresh.out, added.out);
  EXPECT_THAT(added.err, HasSubstr("with what is measured, sigma_ln is"));
  EXPECT_EQ(run({"--plan", "3", "--basis", basis, "paint.csv", "paint.csv"}).status, 64);
}

// A plan is measured by adding a column: its headings are those that tables have, its mirror direction at 180 degrees.
TEST_F(Reconstruct, PlansAreReadOnceTheyAreMeasured) {
  const Ended plan = run({"--plan", "8", "--basis", (shared().path() / "small.basis").string()});
  ASSERT_EQ(plan.status, 0) << plan.err;
  std::istringstream lines(plan.out);
  std::string line, text;
  std::getline(lines, line);
  text = line + ",f\n";
  while (std::getline(lines, line)) {
    double ti = 0, pi_ = 0, to = 0, po = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &ti, &pi_, &to, &po), 4) << line;
    const auto at = [](double t, double p) {
      return Vec3{std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
    };
    const Vec3 h = normalized(at(ti, pi_) + at(to, po));
    text += line + format(",%.6g\n", 0.1 + std::exp(-(1 - h.z) / 0.02));
  }
  write_file(folder_.path() / "measured.csv", text);
  const Ended ended = reconstruct({"--mirror", "180", "--merl", "m.binary", "measured.csv"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out", folder_.path());
  EXPECT_EQ(document.surface_fits.at("measured").rows, 8);
  // Planned pairs about the mirror direction are the bright ones: had the plan meant the other side, they would not be.
  EXPECT_THAT(ended.err, testing::Not(HasSubstr("looks like the other convention")));
}

// A fit written as a table and read again tells the same numbers.
TEST_F(Reconstruct, TablesOfFitsComeBack) {
  write_file(folder_.path() / "paint.csv", run({"--example"}).out);
  ASSERT_EQ(run({"--model", "coated-diffuse", "--merl", "again.binary", "-o", "a.json", "paint.csv"}).status, 0);
  const Ended again = run({"--model", "coated-diffuse", "--starts", "0", "--folds", "0", "again.binary"});
  ASSERT_EQ(again.status, 0) << again.err;
  const auto first = manifest::read_document(folder_.path() / "a.json").surfaces.at("paint").parameters,
             second = manifest::parse_document(again.out, "b", folder_.path()).surfaces.at("again").parameters;
  EXPECT_NEAR(first.at("alpha").scalar(), second.at("alpha").scalar(), 1e-3);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(first.at("albedo").value.at(c), second.at("albedo").value.at(c), 2e-3);
}

TEST_F(Reconstruct, OptionsOfTheTableNeedReconstruct) {
  const Ended ended = run({"--merl-sigma", "s.binary", "paint.csv"});
  EXPECT_EQ(ended.status, 64);
  EXPECT_THAT(ended.err, HasSubstr("--reconstruct"));
}

}  // namespace
}  // namespace gonio
