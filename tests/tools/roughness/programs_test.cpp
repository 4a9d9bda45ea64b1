// roughness, lobe and relief, from GONIO_BIN, as a person runs them: alone and in a pipe, what they write, what they
// refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "base/atomic_file.h"
#include "data.h"
#include "io/height_map.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/ground_noise.h"
#include "manifest/sections/relief.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "manifest/sections/table.h"
#include "process.h"
#include "relief/ridges.h"

namespace gonio::relief {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

// A TIFF of 32-bit floats in one strip, x + 10 y, little-endian, from its description.
std::string float_tiff(unsigned width, unsigned height) {
  std::string file;
  const auto put = [&file](unsigned value, int bytes) {
    for (int i = 0; i < bytes; ++i) file += static_cast<char>(value >> (8 * i) & 255);
  };
  file = "II";
  put(42, 2), put(8 + 4 * width * height, 4);
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x) put(std::bit_cast<unsigned>(static_cast<float>(x + 10 * y)), 4);
  const auto entry = [&](unsigned tag, unsigned type, unsigned value) {
    put(tag, 2), put(type, 2), put(1, 4), put(value, 4);
  };
  put(10, 2);
  entry(256, 3, width), entry(257, 3, height), entry(258, 3, 32), entry(259, 3, 1), entry(262, 3, 1), entry(273, 4, 8);
  entry(277, 3, 1), entry(278, 3, height), entry(279, 4, 4 * width * height), entry(339, 3, 3);
  put(0, 4);
  return file;
}

// The manifest that a program wrote, read as the next one would.
manifest::Document document_of(const tests::Ended& ended, const tests::ScratchFolder& folder) {
  EXPECT_EQ(ended.status, 0) << ended.err;
  return manifest::parse_document(ended.out, "stdout", folder.path());
}

TEST(Roughness, EntersFiguresAndWritesTableAndPage) {
  const tests::ScratchFolder folder;
  io::write_height_map(folder / "wave.x3p", map_of(sinusoid(2e-6, 1e-4, 1e-4)));
  const auto ended =
      tests::run({"roughness", "--levelling", "none", "--csv", "r.csv", "--html", "r.html", "wave.x3p"}, folder.path());
  const manifest::Document d = document_of(ended, folder);
  const manifest::ReliefMap& map = d.reliefs.at("wave");
  EXPECT_NEAR(map.parameters.at("Sq").value, 1e-6, 1e-12);
  EXPECT_EQ(map.parameters.at("Sq").unit, "m");
  EXPECT_EQ(map.treatment->levelling, "none");
  EXPECT_EQ(map.width, 128);
  EXPECT_EQ(map.normals.size(), 2u);
  EXPECT_EQ(d.files.at(map.file).path, "wave.x3p");
  EXPECT_EQ(d.files.at(map.file).bytes, std::filesystem::file_size(folder / "wave.x3p"));
  EXPECT_THAT(read_file(folder / "r.csv"), HasSubstr("\"wave.x3p\",Sa,m,"));
  EXPECT_THAT(read_file(folder / "r.html"), HasSubstr("Sku"));
}

TEST(Roughness, WritesBelowOutAndReplacesWithForceOnly) {
  const tests::ScratchFolder folder;
  io::write_height_map(folder / "wave.x3p", map_of(sinusoid(2e-6, 1e-4, 1e-4)));
  EXPECT_EQ(tests::run({"roughness", "--out", "o", "wave.x3p"}, folder.path()).status, 0);
  EXPECT_THAT(read_file(folder / "o/roughness.csv"), HasSubstr("\"wave.x3p\",Sa,m,"));
  EXPECT_THAT(read_file(folder / "o/report.html"), HasSubstr("Sku"));
  write_file(folder / "o/roughness.csv", "mine");
  const auto again = tests::run({"roughness", "--out", "o", "wave.x3p"}, folder.path());
  EXPECT_EQ(again.status, 73);
  EXPECT_THAT(again.err, HasSubstr("exists; --force replaces it"));
  EXPECT_EQ(read_file(folder / "o/roughness.csv"), "mine");
  EXPECT_EQ(tests::run({"roughness", "--out", "o", "--force", "wave.x3p"}, folder.path()).status, 0);
  EXPECT_THAT(read_file(folder / "o/roughness.csv"), HasSubstr("Sa"));
}

TEST(Relief, WritesBelowOutAndReplacesWithForceOnly) {
  const tests::ScratchFolder folder;
  const Words make{"relief", "sinusoid", "--amplitude", "1um", "--wave-x", "0.1mm", "--out", "o"};
  const manifest::Document d = document_of(tests::run(make, folder.path()), folder);
  EXPECT_EQ(d.files.at(d.reliefs.at("sinusoid").file).path, "o/sinusoid.x3p");
  const auto again = tests::run(make, folder.path());
  EXPECT_EQ(again.status, 73);
  EXPECT_THAT(again.err, HasSubstr("exists; --force replaces it"));
  Words forced = make;
  forced.push_back("--force");
  EXPECT_EQ(tests::run(forced, folder.path()).status, 0);
}

TEST(Roughness, UnitsMayBeNamedAloneAndAreChecked) {
  const tests::ScratchFolder folder;
  write_file(folder / "m.tif", float_tiff(4, 3));
  const auto measured = [&](const Words& options) {
    Words words{"roughness", "--levelling", "none", "--step", "2um", "m.tif"};
    words.insert(words.end(), options.begin(), options.end());
    return tests::run(words, folder.path());
  };
  const manifest::Document d = document_of(measured({"--unit", "um"}), folder);
  EXPECT_EQ(d.reliefs.at("m").unit_m, 1e-6);
  EXPECT_NEAR(*document_of(measured({"--unit", "25nm"}), folder).reliefs.at("m").unit_m, 25e-9, 1e-20);
  for (const char* unit : {"deg", "-1um", "3km", "", "5"}) {
    const auto refused = measured({"--unit", unit});
    EXPECT_EQ(refused.status, 64) << unit << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("--unit"));
  }
  const auto without = measured({});
  EXPECT_EQ(without.status, 65);
  EXPECT_THAT(without.err, HasSubstr("--unit um"));
}

TEST(Roughness, PassesOnWhatItDoesNotKnowAndTheMapsAreItsOwn) {
  const tests::ScratchFolder folder;
  std::filesystem::create_directory(folder / "a"), std::filesystem::create_directory(folder / "b");
  for (const char* name : {"a/m.sur", "b/m.sur"})
    io::write_height_map(folder / name, map_of(sinusoid(2e-6, 1e-4, 1e-4, 32)));
  write_file(folder / "scene.json",
             R"({"gonio": 1, "surfaces": {"s": {"model": "diffuse", "albedo": 0.25}}, "x-lab": 7})");
  const auto ended = tests::run({"roughness", "-i", "scene.json", "a/m.sur", "b/m.sur"}, folder.path());
  const manifest::Document d = document_of(ended, folder);
  EXPECT_EQ(d.reliefs.size(), 2u);
  EXPECT_EQ(d.reliefs.at("m-2").file, "m-2");
  EXPECT_TRUE(d.surfaces.contains("s"));
  EXPECT_THAT(ended.out, HasSubstr("\"x-lab\": 7"));
  const auto again = tests::run({"roughness", "--relief", "m-2", "--levelling", "none"}, folder.path(), ended.out);
  const manifest::Document e = document_of(again, folder);
  EXPECT_EQ(e.reliefs.size(), 2u);
  EXPECT_EQ(e.reliefs.at("m").treatment->levelling, "plane");
  EXPECT_EQ(e.reliefs.at("m-2").treatment->levelling, "none");
}

TEST(Roughness, RemembersWhatAPicturesNumbersMean) {
  const tests::ScratchFolder folder;
  io::write_height_map(folder / "m.exr", map_of(sinusoid(2e-6, 1e-4, 1e-4, 32)));
  const auto scaled = tests::run({"roughness", "--levelling", "none", "--unit", "0.5m", "m.exr"}, folder.path());
  EXPECT_NEAR(document_of(scaled, folder).reliefs.at("m").parameters.at("Sq").value, 0.5e-6, 1e-11);
  const auto next = tests::run({"roughness", "--levelling", "none"}, folder.path(), scaled.out);
  EXPECT_NEAR(document_of(next, folder).reliefs.at("m").parameters.at("Sq").value, 0.5e-6, 1e-11);
}

TEST(Roughness, RefusesWhatIsNoMapInOneLine) {
  const tests::ScratchFolder folder;
  write_file(folder / "a.txt", "some words that are no heights");
  write_file(folder / "empty.json", R"({"gonio": 1})");
  write_file(folder / "old.json", R"({"roughness": []})");
  io::write_height_map(folder / "m.exr", map_of(sinusoid(2e-6, 1e-4, 1e-4)));
  struct Wrong {
    Words words;
    int status;
    const char* says;
  };
  for (const Wrong& wrong : {Wrong{{"roughness", "a.txt"}, 65, "a.txt: is no height map that gonio reads"},
                             {{"roughness", "none.sur"}, 66, "none.sur"},
                             {{"roughness", "--s-filter", "8", "m.exr"}, 64, "--s-filter"},
                             {{"roughness"}, 66, "name a height map"},
                             {{"roughness", "empty.json"}, 65, "empty.json#/reliefs: has no relief"},
                             {{"roughness", "old.json"}, 65, "not a gonio manifest"},
                             {{"roughness", "--relief", "m", "m.exr"}, 64, "leave one of the two out"},
                             {{"roughness", "--html", "none/r.html", "m.exr"}, 73, "none"},
                             {{"relief", "ground-noise"}, 66, "name a height map"},
                             {{"relief", "noise", "--sq", "1um", "--to", "n.sur"}, 64, "--cell 0"},
                             {{"relief", "sinusoid", "--amplitude", "1um", "--to", "n.tif"}, 64, "n.tif"},
                             {{"lobe"}, 66, "name a height map"}}) {
    const auto ended = tests::run(wrong.words, folder.path());
    EXPECT_EQ(ended.status, wrong.status) << wrong.words.back() << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(wrong.says));
    EXPECT_EQ(std::ranges::count(ended.err, '\n'), 1) << ended.err;
  }
}

TEST(Lobe, OfAFlatMirrorIsOneCell) {
  const tests::ScratchFolder folder;
  io::write_height_map(folder / "flat.sur", {4, 4, 1e-6, 1e-6, std::vector<double>(16, 0.0)});
  const auto ended = tests::run({"lobe", "--facets", "metal", "--set", "f0=1", "--set", "alpha=0", "--paths", "640",
                                 "--incidence", "31deg", "--out", "o", "flat.sur"},
                                folder.path());
  const manifest::Document d = document_of(ended, folder);
  const manifest::ReliefLobe& lobe = d.reliefs.at("flat").lobes.at(0);
  EXPECT_NEAR(lobe.reflected.at(0), 1, 1e-12);
  EXPECT_NEAR(lobe.peak_theta_rad, 31 * pi / 180, 1e-12);
  EXPECT_EQ(lobe.facets, "metal");
  EXPECT_THAT(read_file(folder / "o/flat-lobe.csv"), HasSubstr("theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,f_r"));
  EXPECT_TRUE(std::filesystem::exists(folder / "o/flat-lobe-31.png"));
  for (const Words& wrong : {Words{"--facets", "nope"},
                             {"--set", "alpha"},
                             {"--set", "alpha=-1"},
                             {"--facets", "dipole"},
                             {"--incidence", "45"},
                             {"--incidence", "90deg"}}) {
    Words words{"lobe"};
    words.insert(words.end(), wrong.begin(), wrong.end());
    words.emplace_back("flat.sur");
    const auto refused = tests::run(words, folder.path());
    EXPECT_TRUE(refused.status == 64 || refused.status == 65) << wrong[1] << " " << refused.status << refused.err;
    EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1) << refused.err;
  }
}

// relief | roughness | lobe: each adds its own, and the surface that comes out is the facets' model of the map's
// slopes.
TEST(Pipe, FromADesignToASurface) {
  const tests::ScratchFolder folder;
  const auto made = tests::run({"relief", "noise", "--sq", "0.5um", "--cell", "8um", "--step", "0.5um", "--points",
                                "128", "--periodic", "--to", "n.x3p"},
                               folder.path());
  const auto design = document_of(made, folder);
  EXPECT_EQ(design.reliefs.at("n").kind, "noise");
  EXPECT_EQ(design.reliefs.at("n").design.at("cell_m"), std::vector<double>{8e-6});
  const auto rough = tests::run({"roughness", "--levelling", "none"}, folder.path(), made.out);
  const auto lobe = tests::run({"lobe", "--tiling", "repeated", "--paths", "64000", "--set", "alpha=0.05", "--out", "o",
                                "--theta-cells", "18", "--phi-cells", "24"},
                               folder.path(), rough.out);
  const manifest::Document d = document_of(lobe, folder);
  const manifest::ReliefMap& relief = d.reliefs.at("n");
  EXPECT_EQ(relief.kind, "noise");
  EXPECT_TRUE(relief.parameters.contains("Sa"));
  EXPECT_EQ(relief.lobes.at(0).treatment.levelling, "none") << "as roughness was asked to take it";
  ASSERT_EQ(relief.surface, "n");
  const manifest::Surface& surface = d.surfaces.at("n");
  const manifest::NormalsFit& normals = relief.normals.at(0);
  EXPECT_EQ(surface.model, normals.distribution == "ggx" ? "conductor" : "beckmann-conductor");
  EXPECT_NEAR(surface.parameters.at("alpha").scalar(), std::hypot(normals.alpha_u, 0.05), 1e-12);
  EXPECT_NEAR(surface.sigma.at("alpha").at(0), normals.sigma.at("alpha_u").at(0), 1e-3);
  // Half of it was seen by way of one facet; a microfacet model predicts that within a tenth of the logarithm.
  EXPECT_LT(d.surface_fits.at("n").held_out_rms.value(), 0.3);
  EXPECT_EQ(d.tables.at("n-lobe").surface, "n");
  EXPECT_EQ(d.provenance.find("steps")->as_object().size(), 3u) << "one graph";
}

TEST(Pipe, GroundNoiseOfAReliefComesBack) {
  const tests::ScratchFolder folder;
  const auto made = tests::run(
      {"relief", "noise", "--sq", "1um", "--cell", "8um", "--step", "1um", "--points", "192", "--to", "n.x3p"},
      folder.path());
  const auto fitted = tests::run({"relief", "ground-noise", "--parts", "1", "--layer", "18um", "--to", "again.x3p"},
                                 folder.path(), made.out);
  const manifest::Document d = document_of(fitted, folder);
  const manifest::GroundNoiseFit& ground = d.ground_noises.at("ground");
  EXPECT_EQ(ground.reliefs, Words{"n"});
  EXPECT_EQ(ground.example, "again");
  const manifest::GroundNoisePart& part = ground.parts.at(0);
  EXPECT_LT(std::abs(part.sq_m - 1e-6), 4 * part.sigma.at("sq_m").at(0));
  EXPECT_LT(std::abs(part.cell_m - 8e-6), 4 * part.sigma.at("cell_m").at(0));
  EXPECT_NEAR(part.weight.value() / (part.sq_m / (0.1539 * 18e-6)), 1, 1e-3);
  EXPECT_EQ(d.reliefs.at("again").kind, "noise");
}

// A file that has changed since is not what the manifest says; said of it again by the program that made it.
TEST(Pipe, MapsThatChangedAreRefusedAndEnteredAnew) {
  const tests::ScratchFolder folder;
  const Words noise{"relief", "noise", "--sq",     "1um", "--cell", "8um",
                    "--step", "1um",   "--points", "64",  "--to",   "n.x3p"};
  tests::run(noise, folder.path());
  const auto rough = tests::run({"roughness", "n.x3p"}, folder.path());
  write_file(folder / "r.json", rough.out);
  Words other = noise;
  other.insert(other.end(), {"--seed", "9", "-i", "r.json"});
  const auto anew = tests::run(other, folder.path());
  EXPECT_TRUE(document_of(anew, folder).reliefs.at("n").parameters.empty()) << "figures of another map";
  const auto stale = tests::run({"lobe", "r.json"}, folder.path());
  EXPECT_EQ(stale.status, 65);
  EXPECT_THAT(stale.err, HasSubstr("r.json#/files/n: \"n.x3p\" has "));
}

}  // namespace
}  // namespace gonio::relief
