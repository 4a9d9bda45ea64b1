// scripts/proofs/contrast-burrs: does residue of burrs on the ridges move the ridge angle of greatest contrast from 5
// to 10 degrees, as measured on samples (Luongo et al. 2017, section 5, who conjecture it)? Ridges are traced as
// geometry, with burrs of growing size; the roughness of facets is set beside them as the other explanation. Writes a
// page, the table of contrasts, and tables of reflectances for `explain` (tables.csv lists them), with the standard
// errors over patches as their sigma. No outcome is required of the conjecture; required is that clean ridges agree
// with the model and its walls, and that the differences stated are resolved.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "base/atomic_file.h"
#include "base/text.h"
#include "contrast/predict/brute_force.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "report/number_text.h"
#include "report/page.h"

namespace {

using namespace gonio;
using namespace gonio::contrast;

constexpr double um = 1e-6;

struct Case {
  std::string name;
  TracedRidges ridges;
  Prediction prediction{};
  Estimate covered{};  // at 5 degrees
  std::string roughness() const {
    return ridges.alpha_u == ridges.alpha_v ? format("%g", ridges.alpha_u)
                                            : format("%g, %g", ridges.alpha_u, ridges.alpha_v);
  }
  std::string full_name() const { return "roughness " + roughness() + ", burrs " + name; }
};

TracedRidges with_burrs(double width_m, double height_m, double share, double alpha_u, double alpha_v) {
  TracedRidges t{.shape = {.pitch_m = 100 * um}, .alpha_u = alpha_u, .alpha_v = alpha_v};
  if (width_m > 0) {
    t.shape.burr_share = share;
    t.shape.burr_width_m = width_m;
    t.shape.burr_height_m = height_m;
    t.shape.burr_length_m = 2 * width_m;
  }
  t.ridges = 2;
  t.patches = 8;
  return t;
}

struct Burr {
  double width_um, height_um, share;
};

// Lumps as high as half their width, on and on larger; then flat residue, whose slopes are those of facets; both on
// facets of three roughnesses, each group led by clean ridges. Then rougher facets without any burr.
std::vector<Case> cases() {
  std::vector<Case> all;
  const std::vector<Burr> lumps{{0, 0, 0}, {10, 5, 0.8}, {20, 10, 0.8}, {30, 15, 0.8}, {45, 22.5, 0.8}, {80, 40, 0.8}},
      few{{0, 0, 0}, {45, 22.5, 0.8}},
      flat{{60, 1, 0.8}, {60, 3, 0.8}, {60, 6, 0.8}, {90, 2, 0.95}, {90, 4, 0.95}, {90, 6, 0.95}};
  for (const double alpha : {0.03, 0.05, 0.08})
    for (const auto* group : {alpha == 0.05 ? &lumps : &few, &flat})
      for (const Burr& b : *group)
        all.push_back({b.width_um > 0 ? format("%g x %g um on %g %%", b.width_um, b.height_um, 100 * b.share) : "none",
                       with_burrs(b.width_um * um, b.height_um * um, b.share, alpha, alpha)});
  for (const auto& [alpha_u, alpha_v] : {std::pair{0.08, 0.1}, {0.08, 0.15}, {0.1, 0.1}})
    all.push_back({"none", with_burrs(0, 0, 0, alpha_u, alpha_v)});
  return all;
}

const Means& over(const Prediction& p, const std::string& what) {
  for (const Means& m : p.means)
    if (m.over == what) return m;
  std::abort();
}

// How much the best angle exceeds 5 degrees' contrast, in its standard errors; angles are traced independently.
double lead(const Means& ridge) {
  const Estimate five = ridge.mean[0], best = ridge.mean[largest(ridge)];
  return largest(ridge) == 0 ? 0 : (best.value - five.value) / std::hypot(best.sigma, five.sigma);
}

std::string ratio(const Means& ridge, std::size_t i) {
  const Estimate a = ridge.mean[i], b = ridge.mean[0];
  const double r = a.value / b.value;
  return report::with_sigma(r, r * std::hypot(a.sigma / a.value, b.sigma / b.value));
}

// For the page: in one line.
std::string unbroken(const std::string& name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool times = name.substr(i, 3) == " x ", micro = name.substr(i, 3) == " um";
    text += times ? "\u00d7" : micro ? "\u00a0\u00b5m" : name[i] == ' ' ? "\u00a0" : std::string(1, name[i]);
    i += times || micro ? 2 : 0;
  }
  return text;
}

report::Plot plot_of(const std::string& title, const std::vector<Case>& all,
                     const std::function<bool(const Case&)>& shown) {
  report::Plot plot{
      .title = title, .x_label = "ridge angle / degrees", .y_label = "mean contrast over that at 5 degrees"};
  for (const Case& c : all) {
    if (!shown(c)) continue;
    const Means& ridge = over(c.prediction, "ridge_rad");
    report::Series line{.kind = report::Series::Kind::line,
                        .name = c.ridges.shape.burr_share > 0 ? unbroken(c.name) : "none, " + c.roughness()};
    for (std::size_t i = 0; i < ridge.mean.size(); ++i) {
      line.x.push_back(ridge.at[i] / degree);
      line.y.push_back(ridge.mean[i].value / ridge.mean[0].value);
    }
    plot.series.push_back(line);
  }
  plot.zero_y = true;
  return plot;
}

std::string page_of(const std::vector<Case>& all, const std::string& headline) {
  report::Page page(
      "Burrs and the best ridge angle", headline,
      "Ridges of 100 um pitch traced as geometry, in the experiment of Luongo et al. 2017; contrast is the "
      "difference of signals. Standard errors over patches with burrs of their own.");
  page.paragraph(
      "Burrs: width x height, and the share of the crests that they cover, twice as long as wide. Contrasts at 10, 15 "
      "and "
      "20 degrees are over that at 5. Best: ridge angle, and tilt, of greatest mean contrast. Pairs: contrast of 0-90 "
      "over that of 90-180.");
  report::TableText table{.caption = "Mean contrast over that at a ridge angle of 5 degrees",
                          .columns = {{"Roughness", "", false},
                                      {"Burrs", "", false},
                                      {"Covered", "%"},
                                      {"At 5\u00b0", "1/sr"},
                                      {"10\u00b0", ""},
                                      {"15\u00b0", ""},
                                      {"20\u00b0", ""},
                                      {"Best", "\u00b0"},
                                      {"Tilt", "\u00b0"},
                                      {"Pairs", ""}},
                          .rows = {}};
  for (const Case& c : all) {
    const Means &ridge = over(c.prediction, "ridge_rad"), &tilt = over(c.prediction, "tilt"),
                &pair = over(c.prediction, "rotation");
    table.rows.push_back({unbroken(c.roughness()), unbroken(c.name), report::number_text(100 * c.covered.value, 3),
                          report::number_text(ridge.mean[0].value, 3), ratio(ridge, 1), ratio(ridge, 2),
                          ratio(ridge, 3), ridge.label[largest(ridge)], tilt.label[largest(tilt)],
                          report::number_text(pair.mean[0].value / pair.mean[1].value, 3)});
  }
  page.section("What moves the best ridge angle");
  page.table(table);
  std::vector<report::Plot> plots;
  for (const double alpha : {0.03, 0.05, 0.08})
    plots.push_back(plot_of(format("Burrs on facets of roughness %g", alpha), all,
                            [alpha](const Case& c) { return c.ridges.alpha_u == alpha && c.ridges.alpha_v == alpha; }));
  plots.push_back(
      plot_of("Rougher facets without burrs", all, [](const Case& c) { return c.ridges.shape.burr_share == 0; }));
  page.plots(plots);
  return page.html();
}

// Directions of a goniometer: incidences in and across the plane of the ridges, a hemisphere of exits around the
// mirror. Sigma: the standard errors over patches, pooled over all rows on the scale log(1 + 100 f cos cos) on which
// explain compares. Single rows' own, of eight patches each, scatter by a quarter; as weights they let the few rows
// that happen to look exact decide over a model that is 5 % off.
void write_reflectances(const std::filesystem::path& path, const TracedRidges& ridges, double ridge_rad) {
  std::vector<View> views;
  std::string text = "theta_i,phi_i,theta_o,phi_o,f,f_sigma\n";
  std::vector<std::array<double, 4>> rows;
  const auto direction = [](double t, double p) {
    return Vec3{std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
  };
  for (const double theta_i : {5.0, 20.0, 35.0, 50.0})
    for (const double phi_i : {0.0, 90.0, 180.0, 270.0})
      for (const double theta_o : {0.0, 10.0, 20.0, 30.0, 45.0, 60.0})
        for (double phi_o = 0; phi_o < 360; phi_o += theta_o == 0 ? 360 : 45) {
          rows.push_back({theta_i * degree, phi_i * degree, theta_o * degree, phi_o * degree});
          views.push_back({direction(rows.back()[2], rows.back()[3]), direction(rows.back()[0], rows.back()[1])});
        }
  const std::vector<Estimate> f = traced_lobe(ridges, ridge_rad, views);
  const auto weight = [&](std::size_t i) { return 100 * views[i].wi.z * views[i].wo.z; };
  double square = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    square += std::pow(f[i].sigma / (1 / weight(i) + f[i].value), 2) / static_cast<double>(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    text += format("%.6f,%.6f,%.6f,%.6f,%.6g,%.3g\n", rows[i][0], rows[i][1], rows[i][2], rows[i][3], f[i].value,
                   std::sqrt(square) * (1 / weight(i) + f[i].value));
  write_file(path, text);
}

// The first with burrs is the one after which surface.residue was written; all others are new to it.
void write_tables(const std::filesystem::path& out, std::int64_t paths) {
  struct Sample {
    double width_um, height_um, share, alpha, ridge_deg;
  };
  const std::vector<Sample> samples{{30, 15, 0.8, 0.15, 10}, {30, 15, 0.8, 0.15, 10}, {30, 15, 0.3, 0.15, 10},
                                    {20, 10, 0.6, 0.1, 8},   {40, 20, 0.6, 0.1, 12},  {45, 22.5, 0.8, 0.2, 15},
                                    {60, 6, 0.8, 0.12, 10},  {30, 30, 0.5, 0.15, 6},  {90, 4, 0.95, 0.08, 10},
                                    {0, 0, 0, 0.15, 10},     {0, 0, 0, 0.1, 8},       {0, 0, 0, 0.1, 12},
                                    {0, 0, 0, 0.2, 15},      {0, 0, 0, 0.12, 6},      {0, 0, 0, 0.08, 10}};
  std::string list = "table,width_um,height_um,crest_share,alpha,ridge_deg,cover,cover_sigma\n";
  int number = 0;
  for (const Sample& s : samples) {
    TracedRidges ridges = with_burrs(s.width_um * um, s.height_um * um, s.share, s.alpha, s.alpha);
    ridges.paths = std::max<std::int64_t>(64, paths / 4);
    ridges.seed = static_cast<std::uint64_t>(number);
    const std::string name = format("%s-%02d", s.width_um > 0 ? "burrs" : "clean", number++);
    write_reflectances(out / (name + ".csv"), ridges, s.ridge_deg * degree);
    const Estimate cover = s.width_um > 0 ? covered_share(ridges, s.ridge_deg * degree) : Estimate{};
    list += name + format(",%g,%g,%g,%g,%g,%.4f,%.4f\n", s.width_um, s.height_um, s.share, s.alpha, s.ridge_deg,
                          cover.value, cover.sigma);
  }
  write_file(out / "tables.csv", list);
}

bool claim(const std::string& what, double measured, const char* sign, double required) {
  const bool met = *sign == '<' ? measured <= required : measured >= required;
  std::printf("contrast-burrs %s: measured %.3g required %s= %.3g%s\n", what.c_str(), measured, sign, required,
              met ? "" : "  NOT MET");
  return met;
}

// Of clean ridges from the model with a share of its walls: the largest deviation of a mean contrast by ridge angle,
// over the largest, and the rms of all signals' deviations over their rms.
struct Deviation {
  double contrast = 0, square = 0, noise = 0, all = 0;  // sums over signals; noise: of the tracing's own variances
  double rms() const { return std::sqrt(square / all); }
};
Deviation deviation(const Case& clean, double walls) {
  manifest::Document d;
  manifest::Surface s;
  s.model = "ridged";
  s.parameters = {
      {"ridge_rad", 0.1}, {"alpha_u", clean.ridges.alpha_u}, {"alpha_v", clean.ridges.alpha_v}, {"walls", walls}};
  d.surfaces["s"] = s;
  const Means traced = over(clean.prediction, "ridge_rad");
  const Prediction p = predict(Specimen(d, "s"), {.experiment = {}, .varied = {{"ridge_rad", traced.at}}});
  const Means model = over(p, "ridge_rad");
  Deviation off;
  const double top = model.mean[largest(model)].value;
  for (std::size_t i = 0; i < traced.mean.size(); ++i)
    off.contrast = std::max(off.contrast, std::abs(traced.mean[i].value - model.mean[i].value) / top);
  for (std::size_t i = 0; i < p.combinations.size(); ++i)
    for (const auto signal : {&Combination::first, &Combination::second}) {
      const Estimate is = clean.prediction.combinations[i].*signal;
      const double expected = (p.combinations[i].*signal).value;
      off.square += (is.value - expected) * (is.value - expected);
      off.noise += is.sigma * is.sigma;
      off.all += is.value * is.value;
    }
  return off;
}

// Clean ridges against the model without its walls, as published, and with them.
bool agree(const std::vector<Case>& all) {
  double worst = 0, shares_without = 0, shares_with = 0;
  for (const Case& c : all) {
    if (c.ridges.shape.burr_share > 0) continue;
    const Deviation without = deviation(c, 0), with = deviation(c, 1);
    std::printf(
        "clean ridges of roughness %s against the model: rms of signals %.2f %% without walls, %.2f %% with "
        "(tracing noise %.2f %%); mean contrasts within %.2f %%, %.2f %%\n",
        c.roughness().c_str(), 100 * without.rms(), 100 * with.rms(), 100 * std::sqrt(with.noise / with.all),
        100 * without.contrast, 100 * with.contrast);
    worst = std::max(worst, with.contrast);
    shares_without += without.square / without.all, shares_with += with.square / with.all;
  }
  const bool met = claim("clean ridges against the model with walls, share of the largest contrast", worst, "<", 0.02);
  return claim("rms of signals without walls over that with walls", std::sqrt(shares_without / shares_with), ">",
               1.5) &&
         met;
}

// Names of the cases whose best ridge angle has left 5 degrees.
std::string verdict_of(const std::vector<std::string>& by_burrs, const std::vector<std::string>& by_roughness,
                       long burred) {
  std::string verdict = format("The ridge angle of greatest contrast leaves 5 degrees in %zu of %ld cases with burrs",
                               by_burrs.size(), burred);
  for (std::size_t i = 0; i < by_burrs.size(); ++i) verdict += (i == 0 ? " (" : "; ") + by_burrs[i];
  verdict += by_burrs.empty() ? ", and without any burr with" : "), and without any burr with";
  for (std::size_t i = 0; i < by_roughness.size(); ++i) verdict += (i == 0 ? " " : "; ") + by_roughness[i];
  verdict += by_roughness.empty() ? " none." : ".";
  return verdict;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path out = argc > 1 ? argv[1] : ".";
  const std::int64_t paths = argc > 2 ? std::atoll(argv[2]) : 2048;
  if (argc > 3 && std::string(argv[3]) == "tables") {  // and nothing else
    write_tables(out, paths);
    return 0;
  }
  const std::vector<double> angles{5 * degree, 10 * degree, 15 * degree, 20 * degree};
  std::vector<Case> all = cases();
  std::string table = "ridges,covered_share,ridge_deg,mean_contrast_per_sr,sigma\n";
  std::vector<std::string> by_burrs, by_roughness;  // cases whose best angle leads 5 degrees by 3 sigma
  for (Case& c : all) {
    c.ridges.paths = paths;
    c.prediction = traced_prediction({}, angles, c.ridges);
    if (c.ridges.shape.burr_share > 0) c.covered = covered_share(c.ridges, angles[0]);
    const Means& ridge = over(c.prediction, "ridge_rad");
    std::printf("%-48s covers %4.1f %%: at 5, 10, 15, 20 degrees", c.full_name().c_str(), 100 * c.covered.value);
    for (std::size_t i = 0; i < angles.size(); ++i) {
      std::printf(" %.4f+-%.4f", ridge.mean[i].value, ridge.mean[i].sigma);
      table += "\"" + c.full_name() + "\"" +
               format(",%.4f,%s,%.6g,%.3g\n", c.covered.value, ridge.label[i].c_str(), ridge.mean[i].value,
                      ridge.mean[i].sigma);
    }
    const Means &tilt = over(c.prediction, "tilt"), &pair = over(c.prediction, "rotation");
    std::printf("  best %s (%.1f sigma over 5), tilt %s, 0-90/90-180 %.2f\n", ridge.label[largest(ridge)].c_str(),
                lead(ridge), tilt.label[largest(tilt)].c_str(), pair.mean[0].value / pair.mean[1].value);
    std::fflush(stdout);
    if (lead(ridge) > 3) (c.ridges.shape.burr_share > 0 ? by_burrs : by_roughness).push_back(c.full_name());
  }
  write_file(out / "contrast-burrs.csv", table);
  const auto burred = std::ranges::count_if(all, [](const Case& c) { return c.ridges.shape.burr_share > 0; });
  const std::string headline =
      format("The best ridge angle leaves 5 degrees in %zu of %ld cases with burrs, and on %zu facets without.",
             by_burrs.size(), static_cast<long>(burred), by_roughness.size());
  write_file(out / "contrast-burrs.html", page_of(all, headline));
  std::printf("contrast-burrs: %s\n", verdict_of(by_burrs, by_roughness, static_cast<long>(burred)).c_str());
  write_tables(out, paths);
  bool met = agree(all);
  const Means& ten = over(all.back().prediction, "ridge_rad");
  met = claim("roughness 0.1 alone: best angle over 5 degrees, in sigma", lead(ten), ">", 3) && met;
  return met ? 0 : 1;
}
