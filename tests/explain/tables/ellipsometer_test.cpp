// Ellipsometry: films by characteristic matrices against the model's sums of reflections, and a recorded wafer whose
// film was measured by X-rays and neutrons as well.
#include <gtest/gtest.h>

#include <complex>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "data.h"
#include "surface/thin_film.h"
#include "table_world.h"

namespace gonio::explain::tables::tests {
namespace {

using Complex = std::complex<double>;

// Abeles' characteristic matrix of one layer for either polarization (Born & Wolf 1999, section 1.6.2), waves
// exp(-i w t) and indices n + i k there: conjugated at the end. r_p of the sign of the Nebraska convention.
std::pair<double, double> psi_delta(double theta, double wavelength, Complex substrate, double eta, double film) {
  const double s = std::sin(theta), c0 = std::cos(theta);
  const Complex n2 = std::conj(substrate), c1 = std::sqrt(1.0 - s * s / Complex(eta * eta)),
                c2 = std::sqrt(1.0 - s * s / (n2 * n2)), beta = 2 * pi / wavelength * eta * film * c1, i(0, 1);
  const auto reflected = [&](Complex q0, Complex q1, Complex q2) {
    const Complex m11 = std::cos(beta), m12 = -i / q1 * std::sin(beta), m21 = -i * q1 * std::sin(beta);
    const Complex a = (m11 + m12 * q2) * q0, b = m21 + m11 * q2;
    return (a - b) / (a + b);
  };
  const Complex rs = reflected(c0, eta * c1, n2 * c2), rp = -reflected(1 / c0, eta / c1, n2 / c2);
  const Complex rho = std::conj(rp / rs);
  const double delta = std::arg(rho);
  return {std::atan(std::abs(rho)), delta < 0 ? delta + 2 * pi : delta};
}

TEST(FilmAmplitudes, AreThoseOfCharacteristicMatrices) {
  for (const double film : {1e-12, 2.8e-8, 1.5e-7})
    for (const double theta : {0.3, 0.9, 1.3})
      for (const double wavelength : {4e-7, 9e-7}) {
        const Complex silicon{3.9, -0.05};
        const auto [psi, delta] = psi_delta(theta, wavelength, silicon, 1.5, film);
        const surface::FilmAmplitudes r = surface::film_amplitudes(std::cos(theta), silicon, 1.5, film, wavelength);
        EXPECT_NEAR(std::atan(std::abs(r.p / r.s)), psi, 1e-9);
        EXPECT_NEAR(std::abs(std::polar(1.0, std::arg(r.p / r.s)) - std::polar(1.0, delta)), 0, 1e-8);
      }
}

TEST(FilmAmplitudes, SquareToTheReflectanceOfTheSameFilm) {
  for (const double cosine : {0.2, 0.6, 0.95}) {
    const surface::FilmAmplitudes r = surface::film_amplitudes(cosine, 1.7, 1.38, 1.2e-7, 5.5e-7);
    EXPECT_NEAR((std::norm(r.s) + std::norm(r.p)) / 2, surface::fresnel_film(cosine, 1.7, 1.38, 1.2e-7, 5.5e-7), 1e-12);
  }
}

World ellipsometer() {
  World w;
  w.columns = {{"theta_i", "rad"}, {"wavelength_m", "m"}, {"psi", "rad"},
               {"delta", "rad"},   {"substrate_n", "1"},  {"substrate_k", "1"}};
  w.rest = R"("model": "ellipsometer", "observed": ["psi", "delta"])";
  return w;
}

const Estimate* film_of(const TablesProblem& problem, const Explanation& e) {
  return estimate_of(problem, e, "surface.thin-film.film_m");
}

// Sixty conditions, each read twice, 0.1 degrees of noise.
World coated(std::uint64_t seed, double film, double eta) {
  World w = ellipsometer();
  Random random(seed, 4);
  for (int angle = 0; angle < 6; ++angle)
    for (int band = 0; band < 10; ++band)
      for (int take = 0; take < 2; ++take) {
        const double theta = 0.7 + 0.1 * angle, wavelength = 4e-7 + 5e-8 * band, n = 3.6 + 1e-7 / (wavelength - 2e-7);
        const auto [psi, delta] = psi_delta(theta, wavelength, {n, -0.02}, eta, film);
        w.rows.push_back(
            {theta, wavelength, psi + 0.0017 * random.normal(), delta + 0.0017 * random.normal(), n, 0.02});
      }
  return w;
}

TEST(Ellipsometer, ABareSubstrateHasNothingToExplain) {
  const World w = coated(1, 0, 1.5);
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_TRUE(e.named.empty()) << e.sentence;
}

TEST(Ellipsometer, FilmsAreNamedAndTheirIntervalsHold) {
  std::size_t covered = 0, asked = 0;
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const double film = (20 + 13 * static_cast<double>(seed)) * 1e-9,
                 eta = 1.38 + 0.02 * static_cast<double>(seed % 10);
    const World w = coated(seed, film, eta);
    const TablesProblem problem = w.problem();
    const Explanation e = explain(problem, {});
    ASSERT_EQ(named(problem, e), "surface.thin-film") << film << ": " << e.sentence;
    const Estimate* d = film_of(problem, e);
    ASSERT_NE(d, nullptr);
    EXPECT_NEAR(d->value, film, 0.05 * film + 1e-9) << e.sentence;
    covered += d->lower_95 <= film && film <= d->upper_95;
    ++asked;
  }
  EXPECT_GE(covered, 20u) << "of " << asked;  // fewer than that one time in eighty, at 95 %
}

TEST(Ellipsometer, AFilmInTheManifestIsNoMoreLeftOut) {
  const World w = coated(5, 1.3e-7, 1.46);  // in none of the first ranges of thickness
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {}), again = asked_again(w, problem, e);
  ASSERT_EQ(named(problem, e), "surface.thin-film") << e.sentence;
  EXPECT_TRUE(again.named.empty()) << again.sentence;
  EXPECT_NEAR(again.held_out_before, e.held_out_after, 0.1 * e.held_out_after);
}

TEST(Ellipsometer, OtherColumnsAreRefusedInOneLine) {
  World w = coated(1, 0, 1.5);
  w.rest = R"("model": "ellipsometer", "observed": ["substrate_n"])";
  EXPECT_THROW(w.problem(), Error);
}

// n and k of the substrate by wavelength, um, linear between.
std::pair<double, double> index_at(const std::filesystem::path& file, double um) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  double before = 0, n0 = 0, k0 = 0;
  while (std::getline(in, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    double at = 0, n = 0, k = 0;
    if (!(fields >> at >> n >> k)) continue;
    if (at >= um) {
      const double share = before > 0 ? (um - before) / (at - before) : 1;
      return {n0 + share * (n - n0), k0 + share * (k - k0)};
    }
    before = at, n0 = n, k0 = k;
  }
  return {n0, k0};
}

// A wafer with 28.11 +- 0.04 nm of polymer on 1.17 +- 0.04 nm of oxide by reflectometry: 29.28 nm together.
TEST(Ellipsometer, ARecordedFilmIsAsThickAsXRaysAndNeutronsSay) {
  constexpr const char* set = "explain/thin_film_ellipsometry";
  GONIO_NEEDS_DATA(set);
  World w = ellipsometer();
  std::ifstream in(gonio::tests::data(set) / "corefine_PNIPAM_ellipsometry.dat");
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    double nm = 0, width = 0, incidence = 0, delta = 0, psi = 0;
    if (line.starts_with('#') || !(fields >> nm >> width >> incidence >> delta >> psi)) continue;
    const auto [n, k] = index_at(gonio::tests::data(set) / "silicon.csv", nm / 1000);
    w.rows.push_back({incidence * pi / 180, nm * 1e-9, psi * pi / 180, delta * pi / 180, n, k});
  }
  ASSERT_EQ(w.rows.size(), 308u);
  const TablesProblem problem = w.problem();
  const Explanation e = explain(problem, {});
  EXPECT_EQ(named(problem, e), "surface.thin-film") << e.sentence;
  const Estimate* film = film_of(problem, e);
  ASSERT_NE(film, nullptr);
  EXPECT_NEAR(film->value, 29.28e-9, 1e-9) << e.sentence;
  EXPECT_LT(e.held_out_after, 0.3 * pi / 180);  // the peer's fits leave 0.22 in Psi and 0.30 in Delta
  EXPECT_NE(e.sentence.find("nearly tied"), std::string::npos) << e.sentence;
}

}  // namespace
}  // namespace gonio::explain::tables::tests
