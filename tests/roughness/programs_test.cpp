// roughness, lobe and relief, from GONIO_BIN, as a person runs them: what they print and write, what they refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/atomic_file.h"
#include "data.h"
#include "io/height_map.h"
#include "manifest/value.h"
#include "process.h"
#include "relief/ridges.h"

namespace gonio::relief {
namespace {

using testing::HasSubstr;

TEST(Roughness, PrintsFiguresAndWritesTableAndPage) {
  const tests::ScratchFolder folder;
  io::write_height_map(folder / "wave.x3p", map_of(sinusoid(2e-6, 1e-4, 1e-4)));
  const auto ended =
      tests::run({"roughness", "--levelling", "none", "--csv", "r.csv", "--html", "r.html", "wave.x3p"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Value v = manifest::parse_json(ended.out, "stdout");
  const manifest::Value& map = v.find("roughness")->as_array().at(0);
  EXPECT_NEAR(map.find("parameters")->find("Sq")->find("value")->as_number(), 1e-6, 1e-12);
  EXPECT_EQ(map.find("levelling")->as_string(), "none");
  EXPECT_THAT(read_file(folder / "r.csv"), HasSubstr("\"wave.x3p\",Sa,m,"));
  EXPECT_THAT(read_file(folder / "r.html"), HasSubstr("Sku"));
}

TEST(Roughness, RefusesWhatIsNoMapInOneLine) {
  const tests::ScratchFolder folder;
  write_file(folder / "a.txt", "some words that are no heights");
  io::write_height_map(folder / "m.exr", map_of(sinusoid(2e-6, 1e-4, 1e-4)));
  const auto text = tests::run({"roughness", "a.txt"}, folder.path());
  EXPECT_EQ(text.status, 65);
  EXPECT_THAT(text.err, HasSubstr("a.txt: is no height map that gonio reads"));
  EXPECT_EQ(tests::run({"roughness", "none.sur"}, folder.path()).status, 66);
  EXPECT_EQ(tests::run({"roughness", "--s-filter", "8", "m.exr"}, folder.path()).status, 64);
  EXPECT_EQ(tests::run({"roughness"}, folder.path()).status, 64);
}

TEST(Lobe, OfAFlatMirrorIsOneCell) {
  const tests::ScratchFolder folder;
  io::write_height_map(folder / "flat.sur", {4, 4, 1e-6, 1e-6, std::vector<double>(16, 0.0)});
  const auto ended = tests::run({"lobe", "--facets", "metal", "--set", "f0=1", "--set", "alpha=0", "--paths", "640",
                                 "--incidence", "31deg", "--out", "o", "flat.sur"},
                                folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const manifest::Value v = manifest::parse_json(ended.out, "stdout");
  const manifest::Value& lobe = v.find("lobes")->as_array().at(0);
  EXPECT_NEAR(lobe.find("reflected")->find("value")->as_array().at(0).as_number(), 1, 1e-12);
  EXPECT_NEAR(lobe.find("peak")->find("theta_rad")->as_number(), 31 * pi / 180, 1e-12);
  EXPECT_THAT(read_file(folder / "o/lobe-31.csv"), HasSubstr("theta_rad,phi_rad,f_r"));
  EXPECT_TRUE(std::filesystem::exists(folder / "o/lobe-31.png"));
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--facets", "nope"},
                                                {"--set", "alpha"},
                                                {"--set", "alpha=-1"},
                                                {"--facets", "dipole"},
                                                {"--incidence", "45"},
                                                {"--incidence", "90deg"}}) {
    std::vector<std::string> words{"lobe"};
    words.insert(words.end(), wrong.begin(), wrong.end());
    words.emplace_back("flat.sur");
    const auto refused = tests::run(words, folder.path());
    EXPECT_TRUE(refused.status == 64 || refused.status == 65) << wrong[1] << " " << refused.status << refused.err;
    EXPECT_EQ(std::ranges::count(refused.err, '\n'), 1) << refused.err;
  }
}

}  // namespace
}  // namespace gonio::relief
