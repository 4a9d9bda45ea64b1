// Readers of reflectance tables: the same samples from every format, conventions found, rows left out, recorded files.
#include "goniometry/tables/tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "data.h"
#include "goniometry/tables/sample_table.h"
#include "goniometry/tables/tables_text.h"
#include "io/merl.h"
#include "manifest/document.h"
#include "manifest/sections/table.h"

namespace gonio::goniometry {
namespace {

using testing::HasSubstr;

Vec3 direction(double theta_deg, double phi_deg) {
  const double t = theta_deg * pi / 180, p = phi_deg * pi / 180;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

// A matte floor and a lobe about the mirror direction (phi_i + 180).
double glossy(Vec3 wi, Vec3 wo) {
  const Vec3 h = normalized(wi + wo);
  const double t = (1 - h.z * h.z) / (h.z * h.z);
  return 0.1 + 0.4 * std::exp(-t / 0.04);
}

struct Row {
  double theta_i, phi_i, theta_o, phi_o, f;
};
std::vector<Row> grid() {
  std::vector<Row> rows;
  for (const double ti : {20.0, 40.0, 60.0})
    for (double to = 10; to <= 70; to += 10)
      for (const double po : {0.0, 90.0, 180.0, 270.0})
        rows.push_back({ti, 0, to, po, glossy(direction(ti, 0), direction(to, po))});
  return rows;
}

class Tables : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& text) {
    write_file(folder_.path() / name, text);
    return folder_.path() / name;
  }
  ReadTable read(const std::string& name, const std::string& text, const TableOptions& options = {}) {
    return read_table(file(name, text), options);
  }
  std::string refusal(const std::string& name, const std::string& text, const TableOptions& options = {}) {
    try {
      read(name, text, options);
    } catch (const Error& e) {
      return e.what();
    }
    return "(accepted)";
  }
  tests::ScratchFolder folder_;
};

std::string csv_of(const std::vector<Row>& rows,
                   const std::string& header = "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],f",
                   char separator = ',') {
  std::string text = header + "\n";
  for (const Row& r : rows)
    text += format("%.9g%c%.9g%c%.9g%c%.9g%c%.12g\n", r.theta_i, separator, r.phi_i, separator, r.theta_o, separator,
                   r.phi_o, separator, r.f);
  return text;
}

void expect_grid(const Samples& s, double tolerance = 1e-6) {
  const std::vector<Row> rows = grid();
  ASSERT_EQ(s.rows(), rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    EXPECT_LT(norm(s.wi[r] - direction(rows[r].theta_i, rows[r].phi_i)), tolerance);
    EXPECT_LT(norm(s.wo[r] - direction(rows[r].theta_o, rows[r].phi_o)), tolerance);
    EXPECT_NEAR(s.f[r * s.bands()], rows[r].f, 1e-9);
  }
}

TEST_F(Tables, EveryFormatGivesTheSameSamples) {
  expect_grid(read("a.csv", csv_of(grid())).samples);
  expect_grid(read("a.txt", csv_of(grid(), "# theta_i phi_i theta_o phi_o f", ' '), {.angles = "deg"}).samples);
  expect_grid(read("b.txt", csv_of(grid(), "theta_i_deg;phi_i_deg;theta_s_deg;phi_s_deg;brdf", ';')).samples);
  std::vector<Row> radians = grid();
  for (Row& r : radians)
    for (double* a : {&r.theta_i, &r.phi_i, &r.theta_o, &r.phi_o}) *a *= pi / 180;
  expect_grid(read("c.astm", csv_of(radians, "ASTM E1392\nNUM_POINTS 84\nVARS theta_i,phi_i,theta_s,phi_s,550nm"),
                   {.angles = "rad"})
                  .samples,
              1e-6);
  expect_grid(read("d.brdf", csv_of(radians, "# paint\n1\n550", ' ')).samples, 1e-6);
  std::vector<ColumnUse> columns = parse_columns("theta_i=#1:deg,phi_i=#2:deg,theta_o=#3:deg,phi_o=#4:deg,f=#5", "");
  std::string headless = csv_of(grid());
  expect_grid(read("e.csv", headless.substr(headless.find('\n') + 1), {.columns = columns}).samples);
}

TEST_F(Tables, ManifestTablesKeepTheirColumns) {
  std::string rows;
  for (const Row& r : grid())
    rows += (rows.empty() ? "" : ",") + format("[%.17g,%.17g,%.17g,%.17g,%.17g]", r.theta_i * pi / 180,
                                               r.phi_i * pi / 180, r.theta_o * pi / 180, r.phi_o * pi / 180, r.f);
  const auto document = manifest::parse_document(
      R"({"gonio": 1, "tables": {"t": {"model": "surface", "columns": {"theta_i_rad": "rad", "phi_i_rad": "rad",
          "theta_o_rad": "rad", "phi_o_rad": "rad", "f": "1/sr"}, "observed": ["f"], "rows": [)" +
          rows + "]}}}",
      "m.json", folder_.path());
  const ReadTable table = read_table(document, "t");
  expect_grid(table.samples, 1e-12);
  EXPECT_EQ(table.samples.name, "t");
}

TEST_F(Tables, RowsOfOneBandEachAreJoined) {
  std::string text = "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],wavelength [nm],f,sigma\n";
  for (const Row& r : grid())
    for (const int nm : {450, 550, 650})
      text += format("%g,%g,%g,%g,%d,%.9g,0.001\n", r.theta_i, r.phi_i, r.theta_o, r.phi_o, nm, r.f * nm / 450.0);
  Samples s = read("w.csv", text).samples;
  EXPECT_EQ(s.rows(), grid().size());
  EXPECT_EQ(s.band_name, (std::vector<std::string>{"450 nm", "550 nm", "650 nm"}));
  EXPECT_NEAR(s.band_m.at(1), 550e-9, 1e-15);
  EXPECT_EQ(s.sigma.size(), s.f.size());
  EXPECT_NEAR(s.f[4], s.f[3] * 550 / 450, 1e-6);
  keep_bands(s, {"500nm:600nm"}, "--bands");
  EXPECT_EQ(s.band_name, std::vector<std::string>{"550 nm"});
  EXPECT_THROW(keep_bands(s, {"red"}, "--bands"), Error);
}

TEST_F(Tables, MirrorIsFoundFromTheLobe) {
  EXPECT_EQ(read("a.csv", csv_of(grid())).convention.mirror, Mirror::opposite);
  std::vector<Row> turned = grid();
  for (Row& r : turned) r.phi_o = std::fmod(r.phi_o + 180, 360);
  const ReadTable table = read("b.csv", csv_of(turned));
  EXPECT_EQ(table.convention.mirror, Mirror::same);
  EXPECT_LT(table.convention.brightness_ratio, 0.7);
  expect_grid(table.samples);
  const ReadTable stated = read("c.csv", csv_of(turned), {.mirror = Mirror::opposite});
  EXPECT_TRUE(stated.convention.contradicted);
}

// Over 60 matte samples with 3 % of noise none may be given a convention that the noise suggests.
TEST_F(Tables, MatteSamplesAreAskedAboutTheirMirror) {
  Random random(5);
  for (int repeat = 0; repeat < 60; ++repeat) {
    std::vector<Row> rows = grid();
    for (Row& r : rows) r.f = 0.2 * (1 + 0.03 * random.normal());
    EXPECT_THAT(refusal("m.csv", csv_of(rows)), HasSubstr("--mirror 180"));
  }
  std::vector<Row> rows = grid();
  for (Row& r : rows) r.f = 0.2, r.theta_i = 0;
  EXPECT_EQ(read("n.csv", csv_of(rows)).convention.from, Convention::From::indifferent);
}

TEST_F(Tables, BadRowsAmongManyAreLeftOutWithTheirReason) {
  std::vector<Row> rows = grid();
  rows.push_back({30, 0, 95, 180, 0.1});
  rows.push_back({30, 0, 89, 180, 0.1});
  rows.push_back({30, 0, 30, 90, -0.01});
  const std::string text = csv_of(rows) + "30,0,35,90,nan\n";
  const ReadTable table = read("a.csv", text);
  EXPECT_EQ(table.samples.rows(), grid().size());
  std::vector<std::string> reasons;
  for (const Dropped& d : table.dropped) reasons.push_back(d.reason);
  EXPECT_THAT(reasons, testing::ElementsAre("below the horizon", "beyond the grazing limit", "with a negative value",
                                            "without a number"));
  EXPECT_EQ(table.dropped.front().place, "a.csv:86");
}

TEST_F(Tables, NegativeZenithsLieOnTheOtherSide) {
  std::vector<Row> rows = grid();
  for (Row& r : rows)
    if (r.phi_o == 180) r.theta_o = -r.theta_o, r.phi_o = 0;
  expect_grid(read("a.csv", csv_of(rows)).samples);
}

TEST_F(Tables, MerlCellsLieWhereTheFormatSays) {
  io::MerlTable table;
  table.bins = {30, 30, 60};
  table.brdf_per_sr.resize(3 * table.cells());
  for (std::size_t i = 0; i < table.cells(); ++i)
    for (std::size_t c = 0; c < 3; ++c) table.brdf_per_sr[3 * i + c] = static_cast<float>(i / 1800);  // theta_h's bin
  io::write_merl(folder_.path() / "t.binary", table);
  const ReadTable read = read_table(folder_.path() / "t.binary", {.most_rows = 2000});
  ASSERT_GT(read.samples.rows(), 500u);
  EXPECT_LE(read.samples.rows(), 2000u);
  for (std::size_t r = 0; r < read.samples.rows(); ++r) {
    const Vec3 h = normalized(read.samples.wi[r] + read.samples.wo[r]);
    const double root = std::sqrt(std::acos(std::min(1.0, h.z)) / (pi / 2));
    EXPECT_NEAR(read.samples.f[3 * r], root * 30 - 0.5, 1e-3);
  }
  EXPECT_THAT(read.notes.front(), HasSubstr("54000 cells"));
}

TEST_F(Tables, RecordedTables) {
  GONIO_NEEDS_DATA("brdf");
  const ReadTable garnet = read_table(tests::data("brdf") / "cornell/garnet_red.brdf");
  EXPECT_EQ(garnet.samples.rows() + garnet.dropped.size(), 1439u);
  EXPECT_EQ(garnet.samples.bands(), 31u);
  EXPECT_EQ(garnet.convention.mirror, Mirror::opposite);
  EXPECT_EQ(garnet.convention.from, Convention::From::data);
  const auto columns_text = [](const char* ti, const char* pi_, const char* to, const char* po) {
    return format("theta_i=%s:deg,phi_i=%s:deg,theta_o=%s:deg,phi_o=%s:deg,f=brdf", ti, pi_, to, po);
  };
  const ReadTable starlink =
      read_table(tests::data("brdf") / "starlink-lab/chassis_brdf.csv",
                 {.columns = parse_columns(columns_text("phi_i", "theta_i", "phi_o", "theta_o"), "")});
  EXPECT_EQ(starlink.samples.rows() + starlink.dropped.size(), 724u);
  EXPECT_EQ(starlink.convention.mirror, Mirror::opposite);
  const ReadTable aluminium =
      read_table(tests::data("brdf") / "merl-aluminium-slices/aluminum_brdf.csv",
                 {.columns = parse_columns(columns_text("phi_in", "theta_in", "phi_out", "theta_out"), "")});
  EXPECT_EQ(aluminium.samples.rows() + aluminium.dropped.size(), 1785u);
  EXPECT_EQ(aluminium.convention.mirror, Mirror::opposite);
}

// What brdf-fit hands on is read again as the same samples: bands by wavelength, holes, noise.
TEST(SampleTable, RoundTrip) {
  Samples samples;
  samples.name = "t";
  samples.band_name = {"650 nm", "450 nm"}, samples.band_m = {650e-9, 450e-9};
  Random random(5);
  for (const Row& row : grid()) {
    samples.wi.push_back(direction(row.theta_i, row.phi_i)), samples.wo.push_back(direction(row.theta_o, row.phi_o));
    samples.series.push_back(0), samples.place.push_back("");
    for (int b = 0; b < 2; ++b)
      samples.f.push_back(row.f * (1 + b)), samples.sigma.push_back(0.01 + 0.01 * random.uniform());
  }
  samples.f[3] = std::nan("");
  manifest::Document document;
  document.tables["t"] = sample_table(samples);
  const std::string text = manifest::print_document(document, ".");
  const Samples back = read_table(manifest::parse_document(text, "again", "."), "t").samples;
  ASSERT_EQ(back.rows(), samples.rows());
  ASSERT_EQ(back.bands(), 2u);
  EXPECT_NEAR(back.band_m[0], 450e-9, 1e-15);
  for (std::size_t r = 0; r < back.rows(); ++r) {
    EXPECT_LT(norm(back.wi[r] - samples.wi[r]), 1e-12);
    EXPECT_LT(norm(back.wo[r] - samples.wo[r]), 1e-12);
    for (std::size_t b = 0; b < 2; ++b) {
      const std::size_t here = 2 * r + b, there = 2 * r + 1 - b;
      if (there == 3) {
        EXPECT_TRUE(std::isnan(back.f[here]));
        continue;
      }
      EXPECT_EQ(back.f[here], samples.f[there]);
      EXPECT_EQ(back.sigma[here], samples.sigma[there]);
    }
  }
}

}  // namespace
}  // namespace gonio::goniometry
