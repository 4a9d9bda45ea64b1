// Fits of many bands: spectra, tables of numbers, and the covariance that the manifest holds.
// One process: FitOfManyBands.*
#include "goniometry/spectra.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "base/random.h"
#include "goniometry/document.h"
#include "goniometry/plots.h"
#include "manifest/document.h"
#include "manifest/sections/surface_fit.h"
#include "report/heat_drawing.h"
#include "tools/brdf-fit/page.h"

namespace gonio::goniometry {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t bands = 9;

double albedo_of(std::size_t band) {
  return band < 4 ? 0 : 0.05 * static_cast<double>(band);  // black at the start: at its bound
}

// Varnish over matte of a colour that rises with the wavelength; bands stand from long to short waves.
Samples varnish() {
  Samples s{.name = "varnish"};
  for (std::size_t b = 0; b < bands; ++b) {
    s.band_m.push_back((700 - 30 * static_cast<double>(b)) * 1e-9);
    s.band_name.push_back(std::to_string(700 - 30 * b) + " nm");
  }
  const surface::Model& model = *surface::find("coated-diffuse");
  std::vector<surface::Values> of;
  for (std::size_t b = 0; b < bands; ++b)
    of.push_back(surface::values_of(
        model, {{"albedo", std::vector<double>(3, albedo_of(bands - 1 - b))}, {"f0", 0.05}, {"alpha", 0.25}}, "v"));
  Random random(5);
  const auto at = [](double theta, double phi) {
    const double t = theta * pi / 180, p = phi * pi / 180;
    return Vec3{std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
  };
  for (const double ti : {15.0, 35.0, 55.0, 65.0})
    for (double to = 5; to <= 75; to += 10)
      for (const double po : {0.0, 90.0, 180.0}) {
        s.wi.push_back(at(ti, 0)), s.wo.push_back(at(to, po));
        s.series.push_back(static_cast<std::uint32_t>(ti));
        for (const auto& values : of) {
          const double f = model.evaluate(values, s.wo.back(), s.wi.back()).x;
          s.f.push_back(f * (1 + 0.02 * random.normal()));
        }
      }
  return s;
}

class FitOfManyBands : public testing::Test {
 protected:
  static const Outcome& outcome() {
    static const Outcome made = [] {
      Outcome o{.name = "varnish", .source = "a test"};
      o.read.samples = varnish();
      FitOptions options;
      options.models = {"coated-diffuse"};
      options.lobes = 1, options.anisotropic = false, options.random_starts = 0;
      o.fits = fit_surfaces(o.read.samples, options);
      return o;
    }();
    return made;
  }
  const Fit& fit() const { return *outcome().chosen(); }
};

TEST_F(FitOfManyBands, IsDrawnOverWavelength) {
  const auto spectra = spectra_of(outcome());
  ASSERT_EQ(spectra.size(), 1u);  // f0 and alpha are shared
  EXPECT_EQ(spectra[0].number, "albedo");
  const auto& series = spectra[0].plot.series;
  ASSERT_EQ(series.size(), 3u);
  const auto &range = series[0], &value = series[1], &bound = series[2];
  ASSERT_EQ(value.x.size(), bands);
  for (std::size_t k = 0; k < bands; ++k) {
    EXPECT_NEAR(value.x[k], 460 + 30 * static_cast<double>(k), 1e-9);  // short waves first
    const FittedNumber& n = *fit().number("albedo", bands - 1 - k);
    EXPECT_EQ(value.y[k], n.value);
    EXPECT_NEAR(range.y[k] - range.sigma[k], n.low, 1e-12);
    EXPECT_NEAR(range.y[k] + range.sigma[k], n.high, 1e-12);
    EXPECT_NEAR(value.y[k], albedo_of(k), 0.02);
  }
  EXPECT_FALSE(bound.x.empty());
  for (const double x : bound.x) EXPECT_LE(x, 560);
  EXPECT_EQ(band_error_plot(outcome()).series[0].y.size(), bands);
}

TEST_F(FitOfManyBands, IsDrawnOnThePageAndNotListed) {
  const std::string page = gonio::tools::brdf_fit::page_of(outcome(), {});
  EXPECT_THAT(page, HasSubstr("albedo of the bands"));
  EXPECT_THAT(page, HasSubstr("wavelength / nm"));
  EXPECT_THAT(page, HasSubstr("albedo[610 nm]"));  // red
  EXPECT_THAT(page, Not(HasSubstr("albedo[640 nm]")));
}

TEST_F(FitOfManyBands, NumbersAreATable) {
  std::istringstream lines(numbers_csv(outcome()));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "number,band,wavelength_m,value,sigma,low,high,bound");
  std::size_t rows = 0, at_bounds = 0;
  while (std::getline(lines, line)) {
    const FittedNumber& n = fit().numbers.at(rows++);
    std::vector<std::string> fields;
    std::istringstream text(line);
    for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
    ASSERT_GE(fields.size(), 7u) << line;
    EXPECT_EQ(fields[0], n.name);
    EXPECT_EQ(fields[1], n.band == whole_sample ? "" : outcome().read.samples.band_name[n.band]);
    EXPECT_NEAR(std::stod(fields[3]), n.value, 1e-8);
    at_bounds += fields.size() > 7 && fields[7] == "lower";
  }
  EXPECT_EQ(rows, fit().numbers.size());
  EXPECT_GE(at_bounds, 1u);
}

// The manifest's covariance is the fit's, number by number, and its diagonal the squares of the stated sigmas.
TEST_F(FitOfManyBands, CovarianceIsWhole) {
  manifest::Document document;
  enter(document, outcome());
  const manifest::SurfaceFit& out = document.surface_fits.at("varnish");
  const auto& order = out.covariance.find("order")->as_array();
  const auto& values = out.covariance.find("values")->as_array();
  const std::size_t n = fit().numbers.size();
  ASSERT_EQ(n, bands + 2);
  ASSERT_EQ(order.size(), n);
  ASSERT_EQ(values.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(order[i].as_string(), number_name(fit().numbers[i], outcome().read.samples));
    for (std::size_t k = 0; k < n; ++k) EXPECT_EQ(values[i].as_array().at(k).as_number(), fit().covariance[i * n + k]);
    if (fit().numbers[i].at == FittedNumber::At::inside)
      EXPECT_NEAR(std::sqrt(fit().covariance[i * n + i]), fit().numbers[i].sigma, 1e-9 * fit().numbers[i].sigma);
    else
      EXPECT_EQ(fit().covariance[i * n + i], 0);
  }
}

// 240 bands of one number each would be 57600 values.
TEST(FitOfHundredsOfBands, StatesTheCovarianceOfTheWrittenOnes) {
  Outcome outcome{.name = "many", .source = "a test"};
  Samples& s = outcome.read.samples;
  Fit fit;
  fit.model = surface::find("diffuse");
  constexpr std::size_t n = 240;
  for (std::size_t b = 0; b < n; ++b) {
    s.band_m.push_back((400 + static_cast<double>(b)) * 1e-9);
    s.band_name.push_back(std::to_string(400 + b) + " nm");
    fit.numbers.push_back({.name = "albedo", .band = b, .value = 0.5, .sigma = 0.1});
  }
  for (std::size_t t = 0; t < n / 3; ++t)
    fit.triples.push_back(surface::values_of(*fit.model, {{"albedo", std::vector<double>(3, 0.5)}}, "m"));
  fit.covariance.assign(n * n, 0);
  for (std::size_t b = 0; b < n; ++b) fit.covariance[b * n + b] = 0.01 + 1e-6 * static_cast<double>(b);
  fit.converged = true;
  outcome.fits.candidates.push_back(fit), outcome.fits.chosen = 0;
  manifest::Document document;
  enter(document, outcome);
  const manifest::SurfaceFit& out = document.surface_fits.at("many");
  EXPECT_EQ(out.covariance.find("order")->as_array().size(), 3u);
  EXPECT_EQ(out.covariance.find("values")->as_array().at(0).as_array().at(0).as_number(), 0.01 + 1e-6 * 55);  // 455 nm
  EXPECT_THAT(out.notes, Contains(HasSubstr("covariance of 240 numbers")));
}

TEST(BoundNotes, AreOneSentenceForManyBands) {
  Outcome outcome{.name = "many", .source = "a test"};
  Fit fit;
  fit.model = surface::find("diffuse");
  for (std::size_t b = 0; b < 8; ++b) {
    outcome.read.samples.band_name.push_back("b" + std::to_string(b));
    fit.numbers.push_back({.name = "albedo",
                           .band = b,
                           .at = b < 6    ? FittedNumber::At::lower
                                 : b == 6 ? FittedNumber::At::upper
                                          : FittedNumber::At::inside});
  }
  const auto notes = bound_notes(outcome, fit);
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[0], "albedo is at its lower bound in 6 of 8 bands: b0, b1, b2, b3, b4, b5.");
  EXPECT_THAT(notes[1], HasSubstr("albedo[b6] is at its upper bound"));
}

// Measured points stand beside the lines, in scans and around the normal, with the same radius law.
TEST_F(FitOfManyBands, LobesShowWhatWasMeasured) {
  const report::Plot scans = *scan_plot(outcome(), 4), lobes = lobe_plot(outcome(), 4);
  std::size_t drawn = 0;
  for (const report::Series& series : lobes.series) {
    if (series.kind != report::Series::Kind::points) continue;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const double radius = std::hypot(series.x[i], series.y[i]), zenith = std::atan2(series.x[i], series.y[i]);
      const double f = (std::pow(10, radius) - 1) / 100;
      bool found = false;
      for (const report::Series& scan : scans.series)
        if (scan.kind == report::Series::Kind::points)
          for (std::size_t k = 0; k < scan.x.size(); ++k)
            found |= std::abs(scan.x[k] - zenith * 180 / pi) < 1e-6 && std::abs(scan.y[k] - f) < 1e-9;
      EXPECT_TRUE(found) << zenith << " " << f;
      ++drawn;
    }
  }
  EXPECT_GE(drawn, 60u);
}

TEST(HeatDrawing, NumbersHaveTheDigitsThatTheirColourNeeds) {
  EXPECT_EQ(report::cell_text(0.37, 0.6), "0.37");
  EXPECT_EQ(report::cell_text(12.5, 20), "12.50");
  EXPECT_EQ(report::cell_text(-0.0004, 0.6), "0.00");
  EXPECT_EQ(report::cell_text(-0.00042, 0.0013), "-0.0004");
  EXPECT_EQ(report::cell_text(0.0013, 0.0013), "0.0013");
}

TEST(HeatDrawing, HasEveryCellOnce) {
  const report::HeatStrip strip{.title = "a<b",
                                .label = "l",
                                .columns = {"x", "y"},
                                .rows = {"p", "q"},
                                .values = {0.25, std::nan(""), -0.5, 0.125},
                                .diverging = true};
  const std::string svg = report::standalone_svg(strip);
  EXPECT_THAT(svg, testing::StartsWith("<svg xmlns"));
  for (const char* text : {"a&lt;b", ">0.25<", ">-0.50<", ">\u2013<", ">p<", ">y<"}) EXPECT_THAT(svg, HasSubstr(text));
  std::size_t cells = 0;
  for (std::size_t at = svg.find("<rect"); at != std::string::npos; at = svg.find("<rect", at + 1)) ++cells;
  EXPECT_EQ(cells, 3u);
}

}  // namespace
}  // namespace gonio::goniometry
