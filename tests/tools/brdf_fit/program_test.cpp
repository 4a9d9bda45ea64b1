// brdf-fit as a person runs it: its own example from end to end, and bad input of every kind in clear words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/atomic_file.h"
#include "base/text.h"
#include "data.h"
#include "geom/vector.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "process.h"

namespace gonio {
namespace {

using testing::HasSubstr;
using tests::Ended;

class BrdfFit : public testing::Test {
 protected:
  Ended run(std::vector<std::string> words) {
    words.insert(words.begin(), "brdf-fit");
    return tests::Process(words, folder_.path()).end();
  }
  void write(const std::string& name, const std::string& text) { write_file(folder_.path() / name, text); }
  // Runs on bad.csv with `text` in it (or another name) and expects the status and the words.
  void refused(const std::string& what, const std::string& name, const std::string& text,
               const std::vector<std::string>& options, int status, const std::vector<std::string>& words) {
    SCOPED_TRACE(what);
    write(name, text);
    std::vector<std::string> all = options;
    all.push_back(name);
    const Ended ended = run(all);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(ended.out, "");
    for (const std::string& word : words) EXPECT_THAT(ended.err, HasSubstr(word));
  }
  tests::ScratchFolder folder_;
};

const std::string header = "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],f\n";

// A lobe about the mirror direction over a matte floor; each row through `change`.
std::string table(const std::function<void(std::array<double, 5>&)>& change = {}, const std::string& head = header) {
  std::string text = head;
  for (const double ti : {20.0, 40.0, 60.0})
    for (double to = 10; to <= 70; to += 10)
      for (const double po : {0.0, 180.0}) {
        const double off = 0.5 * ((po > 0 ? to : -to) - ti) * pi / 180;
        std::array<double, 5> row = {ti, 0, to, po, 0.1 + 0.4 * std::exp(-std::pow(std::tan(off) / 0.2, 2))};
        if (change) change(row);
        text += format("%.9g,%.9g,%.9g,%.9g,%.9g\n", row[0], row[1], row[2], row[3], row[4]);
      }
  return text;
}

TEST_F(BrdfFit, TellsItsOwnExample) {
  const Ended example = run({"--example"});
  ASSERT_EQ(example.status, 0);
  write("paint.csv", example.out);
  const Ended ended = run({"--model", "coated-diffuse", "--out", "o", "paint.csv"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out.json", folder_.path());
  const manifest::Surface& paint = document.surfaces.at("paint");
  EXPECT_EQ(paint.model, "coated-diffuse");
  // The truth within four of the stated standard deviations, which are themselves no wider than the noise warrants.
  EXPECT_NEAR(paint.parameters.at("alpha").scalar(), 0.18, 4 * paint.sigma.at("alpha").at(0));
  EXPECT_LT(paint.sigma.at("alpha").at(0), 0.002);
  const std::vector<double> albedo = {0.42, 0.08, 0.06};
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(paint.parameters.at("albedo").value.at(c), albedo[c], 4 * paint.sigma.at("albedo").at(c));
  const manifest::SurfaceFit& fit = document.surface_fits.at("paint");
  EXPECT_EQ(fit.verdict, "good");
  EXPECT_LT(*fit.held_out_rms, 1.15 * *fit.rms);
  EXPECT_LE(*fit.energy, 1.02);
  EXPECT_EQ(fit.mirror, "phi_i + pi");
  for (const char* name : {"paint.html", "paint.csv", "paint-sphere.png", "paint-scans.svg", "paint-lobes.svg"})
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "o" / name)) << name;
  EXPECT_THAT(read_file(folder_.path() / "o/paint.csv"), HasSubstr("channel,f,f_sigma,model,residual"));
}

TEST_F(BrdfFit, ReadsBackTheSamplesThatItWrites) {
  write("paint.csv", run({"--example"}).out);
  ASSERT_EQ(run({"--model", "coated-diffuse", "--csv", "again.csv", "-o", "a.json", "paint.csv"}).status, 0);
  const Ended again = run({"--model", "coated-diffuse", "--name", "paint", "again.csv"});
  ASSERT_EQ(again.status, 0) << again.err;
  const auto a = manifest::read_document(folder_.path() / "a.json"), b = manifest::parse_document(again.out, "b", ".");
  EXPECT_NEAR(a.surfaces.at("paint").parameters.at("alpha").scalar(),
              b.surfaces.at("paint").parameters.at("alpha").scalar(), 1e-4);
}

// explain has the samples and the surface that was fitted to them: nothing is left out of its own example, and of one
// whose second lobe the model lacks, the lobe is.
TEST_F(BrdfFit, HandsItsSamplesOnToExplain) {
  write("paint.csv", run({"--example"}).out);
  const auto explained = [&](const std::vector<std::string>& fit) {
    const Ended fitted = run(fit);
    EXPECT_EQ(fitted.status, 0) << fitted.err;
    const Ended ended = tests::Process({"explain", "--negative-controls", "4"}, folder_.path(), fitted.out).end();
    EXPECT_TRUE(ended.status == 0 || ended.status == 1) << ended.err;
    return manifest::parse_document(ended.out, "explained", folder_.path());
  };
  const auto own = explained({"--model", "coated-diffuse", "--isotropic", "paint.csv"});
  EXPECT_EQ(own.tables.at("paint").surface, "paint");
  EXPECT_EQ(own.tables.at("paint").sigma, std::vector<std::string>{"f_sigma"});
  EXPECT_EQ(own.explanations.at(0).find("verdict")->as_string(), "null")
      << own.explanations.at(0).find("sentence")->as_string();
  const auto matte = explained({"--model", "diffuse", "paint.csv"});
  EXPECT_EQ(matte.explanations.at(0).find("named")->as_array().at(0).find("mechanism")->as_string(),
            "surface.interface");
}

TEST_F(BrdfFit, ManifestsWithTables) {
  std::string text = table();
  write("t.csv", text);
  write("m.json", R"({"gonio": 1, "files": {"f": {"path": "t.csv"}}, "tables": {"t": {"file": "f", "model": "surface",
    "columns": {"theta_i": "rad", "phi_i": "rad", "theta_o": "rad", "phi_o": "rad", "f": "1/sr"},
    "observed": ["f"]}}})");
  const Ended ended = run({"--model", "diffuse", "m.json"});
  EXPECT_NE(ended.status, 65) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out", folder_.path());
  EXPECT_EQ(document.surface_fits.at("t").source, "tables/t");
  EXPECT_EQ(document.tables.at("t").surface, "t");
  EXPECT_EQ(document.tables.at("t").file, "f");
  EXPECT_EQ(run({"--table", "u", "m.json"}).status, 65);
}

TEST_F(BrdfFit, BadAngles) {
  refused("degrees called radians", "bad.csv", table({}, "theta_i [rad],phi_i [rad],theta_o [rad],phi_o [rad],f\n"), {},
          65, {"bad.csv:2: theta_i [rad]: 20 rad is no zenith", "--angles deg"});
  refused("no unit", "bad.csv", table({}, "theta_i,phi_i,theta_o,phi_o,f\n"), {}, 65,
          {"states no unit", "--angles deg"});
  refused("all below the horizon", "bad.csv", table([](auto& r) { r[2] += 90; }), {}, 65,
          {"no row that can be used, of 42", "below the horizon"});
  refused("one direction", "bad.csv", table([](auto& r) {
            r = {30, 0, 30, 180, 0.2};
          }),
          {"--mirror", "180"}, 1, {"one pair of directions", "--plan"});
  refused("mirror", "bad.csv", table([](auto& r) { r[4] = 0.2; }), {}, 65,
          {"does not tell where its mirror direction is", "--mirror 180", "--mirror 0"});
}

TEST_F(BrdfFit, BadValues) {
  refused("negative", "bad.csv", table([](auto& r) { r[4] = -1; }), {}, 65, {"no row", "42 with a negative value"});
  refused("NaN", "bad.csv", table([](auto& r) { r[4] = std::nan(""); }), {}, 65, {"no row", "without a number"});
  refused("text", "bad.csv", table() + "30,0,30,180,bright\n", {}, 65, {"bad.csv:44: f", "\"bright\" is no number"});
  refused("comma as point", "bad.csv", table() + "30,0,30,180,0,2\n", {}, 65, {"bad.csv:44", "6 fields"});
  refused("sigma of zero", "bad.csv",
          "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],f,sigma\n10,0,10,180,1,0\n20,0,10,180,1,0.1\n", {}, 65,
          {"bad.csv:2: sigma", "no standard uncertainty"});
}

TEST_F(BrdfFit, BadUnits) {
  const auto in_radians = [](auto& r) {
    for (std::size_t k = 0; k < 4; ++k) r[k] *= pi / 180;
  };
  refused("radians called degrees", "bad.csv", table(in_radians), {}, 65,
          {"no angle is above 3.14 deg; if these are radians", "--angles rad", "--mirror"});
  refused("nothing but zeros", "bad.csv", table([](auto& r) { r[4] = 0; }), {}, 65, {"no value above zero in 42 rows"});
  refused("metres called nanometres", "bad.csv",
          "theta_i [deg],phi_i [deg],theta_o [deg],phi_o [deg],wavelength [nm],f\n10,0,10,180,5.5e-7,1\n", {}, 65,
          {"bad.csv:2: wavelength", "5.5e-07 nm is none of light"});
  refused("no number in a .brdf", "bad.brdf", "1\n550\nfoo bar\n", {}, 65, {"bad.brdf:3", "\"foo\" is no number"});
  refused("no row in a .brdf", "bad.brdf", "1\n550\n0.1 0\n", {}, 65, {"bad.brdf:3", "1 wavelengths and 5 numbers"});
}

// Values a million times too large put every number at a bound: doubted, not believed, and no crash.
TEST_F(BrdfFit, DoubtsValuesInAnotherUnit) {
  for (const double scale : {100.0, 1e6}) {
    write("bright.csv", table([scale](auto& r) { r[4] *= scale; }));
    const Ended ended =
        run({"--starts", "0", "--lobes", "1", "--isotropic", "--model", "coated-diffuse", "bright.csv"});
    EXPECT_EQ(ended.status, 2) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr("a constant would err less. Are the values a BRDF in 1/sr?"));
  }
  write("pi.csv", table([](auto& r) { r[4] = 0.11 * pi * (1 + 0.1 * std::sin(r[2])); }));
  const Ended ended = run({"--starts", "0", "--mirror", "180", "--model", "diffuse", "pi.csv"});
  EXPECT_THAT(ended.err, HasSubstr("brighter than a surface that returns all light"));
}

TEST_F(BrdfFit, SaysWhatItLeavesOutAndWhatLooksWrong) {
  write("holes.csv", table([](auto& r) { r[4] = r[2] == 30 ? -1 : r[4]; }));
  const Ended ended = run({"--starts", "0", "--folds", "0", "--model", "diffuse", "--mirror", "0", "holes.csv"});
  EXPECT_THAT(ended.err, HasSubstr("6 of 42 pairs of directions are left out: 6 with a negative value"));
  EXPECT_THAT(ended.err, HasSubstr("That looks like the other convention"));
}

TEST_F(BrdfFit, BadColumns) {
  refused("missing", "bad.csv", "theta_i [deg],theta_o [deg],f\n10,20,1\n", {}, 65,
          {"no column for phi_i", "--columns phi_i"});
  refused("duplicate", "bad.csv", "theta_i,theta_i,phi_i,theta_o,phi_o,f\n1,1,1,1,1,1\n", {}, 65, {"twice"});
  refused("two names of one", "bad.csv", "theta_i,theta_in,phi_i,theta_o,phi_o,f\n1,1,1,1,1,1\n", {}, 65,
          {"\"theta_i\" and \"theta_in\" could both be theta_i"});
  refused("unknown to --columns", "bad.csv", table(), {"--columns", "f=brdf"}, 65, {"no column \"brdf\""});
  refused("misspelt quantity", "bad.csv", table(), {"--columns", "theta=f"}, 64, {"no quantity", "theta_i"});
  refused("empty", "bad.csv", "", {}, 65, {"is empty"});
  refused("header alone", "bad.csv", header, {}, 65, {"no rows"});
  refused("no such band", "bad.csv", table(), {"--bands", "550nm"}, 64, {"--bands", "no band"});
  refused("unknown model", "bad.csv", table(), {"--model", "coated"}, 64, {"--model", "no surface", "coated-diffuse"});
}

TEST_F(BrdfFit, BadFiles) {
  refused("MERL of wrong size", "bad.binary", std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", 12), {}, 65,
          {"bad.binary"});
  refused("MERL with impossible bins", "bad.binary", std::string("\0\0\0\0\xff\xff\xff\xff\x01\0\0\0", 12), {}, 65,
          {"bad.binary"});
  refused("Cornell, cut off", "bad.brdf", "1\n550\n0.1 0 0.2 3.1 0.5\n0.1 0 0.2", {}, 65,
          {"bad.brdf:4", "ends within a row"});
  refused("Cornell, no count", "bad.brdf", "theta phi\n", {}, 65, {"bad.brdf:1"});
  refused("ASTM, rows missing", "bad.astm", "NUM_POINTS 3\nVARS theta_i,phi_i,theta_s,phi_s,f\n0.1,0,0.2,3.1,0.5\n",
          {"--angles", "rad"}, 65, {"announces 3 points and has 1 rows"});
  refused("binary as text", "bad.csv", std::string("a,b\0c\n", 6), {}, 65, {"zero byte"});
  EXPECT_EQ(run({"none.csv"}).status, 66);
  refused("reconstruction without a place", "good.csv", table(), {"--reconstruct"}, 64, {"--merl FILE, or --out DIR"});
}

// Known before the fits begin, which take their time.
TEST_F(BrdfFit, NamesAndFilesThatAreThere) {
  std::filesystem::create_directories(folder_.path() / "a");
  std::filesystem::create_directories(folder_.path() / "o");
  write("t.csv", table()), write("a/t.csv", table()), write("o/t.csv", "mine\n");
  const Ended same = run({"--out", "p", "t.csv", "a/t.csv"});
  EXPECT_EQ(same.status, 65);
  EXPECT_THAT(same.err, HasSubstr("would be called \"t\""));
  const Ended there = run({"--out", "o", "t.csv"});
  EXPECT_EQ(there.status, 73);
  EXPECT_THAT(there.err, HasSubstr("o/t.csv: exists; --force"));
  EXPECT_EQ(read_file(folder_.path() / "o/t.csv"), "mine\n");
  // A name is no path.
  write("few.csv", header + "20,0,20,180,0.5\n40,0,40,180,0.6\n40,0,20,0,0.1\n");
  run({"--model", "coated-diffuse", "--mirror", "180", "--name", "../u", "--out", "q", "few.csv"});
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "q/.._u.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "u.csv"));
}

// Three samples and five numbers: nothing is told, and the reason is said.
TEST_F(BrdfFit, FewerSamplesThanNumbers) {
  write("few.csv", header + "20,0,20,180,0.5\n40,0,40,180,0.6\n40,0,20,0,0.1\n");
  const Ended ended = run({"--model", "coated-diffuse", "--mirror", "180", "few.csv"});
  EXPECT_TRUE(ended.status == 1 || ended.status == 65) << ended.status << ended.err;
  EXPECT_GT(ended.err.size(), 40u);
}

}  // namespace
}  // namespace gonio
