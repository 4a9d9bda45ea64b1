// brdf-fit on photographs that render makes, and names that its numbers do not tell.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/surface.h"
#include "manifest/sections/surface_fit.h"
#include "process.h"

namespace gonio {
namespace {

using testing::HasSubstr;
using tests::Ended;

class BrdfFitOfImages : public testing::Test {
 protected:
  Ended run(const std::vector<std::string>& words, const std::string& input = {}) {
    return tests::Process(words, folder_.path(), input).end();
  }
  tests::ScratchFolder folder_;
};

TEST_F(BrdfFitOfImages, TellsTheSurfaceThatWasRendered) {
  const Ended scene = run({"render", "--specimen", "goniometer"});
  ASSERT_EQ(scene.status, 0) << scene.err;
  const auto truth = manifest::parse_document(scene.out, "scene", folder_.path());
  const Ended images = run({"render", "--record", "--spp", "2", "--aov", "off", "--out", "g"}, scene.out);
  ASSERT_EQ(images.status, 0) << images.err;
  const Ended ended = run({"brdf-fit", "--model", "coated-diffuse"}, images.out);
  ASSERT_EQ(ended.status, 0) << ended.err;
  const auto document = manifest::parse_document(ended.out, "out", folder_.path());
  ASSERT_EQ(document.surface_fits.size(), 1u);
  const auto& [name, fit] = *document.surface_fits.begin();
  EXPECT_EQ(fit.source, "goniometer/" + name);
  EXPECT_EQ(fit.verdict, "good");
  ASSERT_TRUE(truth.surfaces.contains(name)) << name;
  const auto& was = truth.surfaces.at(name);
  const auto& is = document.surfaces.at(name);
  ASSERT_EQ(was.model, "coated-diffuse");
  for (const char* parameter : {"alpha", "f0"})
    EXPECT_NEAR(is.parameters.at(parameter).scalar(), was.parameters.at(parameter).scalar(),
                4 * is.sigma.at(parameter).at(0))
        << parameter;
}

// Dark red under varnish, of one band: a conductor fits it with constants that reflect as a varnish does.
TEST_F(BrdfFitOfImages, SaysWhereANumberTellsNoMetal) {
  GONIO_NEEDS_DATA("brdf/cornell/garnet_red.brdf");
  const auto paint = tests::data("brdf/cornell/garnet_red.brdf").string();
  const Ended named = run({"brdf-fit", "--bands", "550nm", "--isotropic", "--model", "conductor", paint});
  EXPECT_EQ(named.status, 0) << named.err;
  const auto fit = manifest::parse_document(named.out, "out", folder_.path()).surface_fits.at("garnet_red");
  EXPECT_EQ(fit.verdict, "good");
  EXPECT_THAT(fit.sentence, HasSubstr("does not tell a metal from a dielectric of index 1."));
}

// A recorded metal reads so, too, and keeps its name.
TEST_F(BrdfFitOfImages, AMetalKeepsItsName) {
  GONIO_NEEDS_DATA("brdf/merl-aluminium-slices/aluminum_brdf.csv");
  const auto slices = tests::data("brdf/merl-aluminium-slices/aluminum_brdf.csv").string();
  const Ended ended = run({"brdf-fit", "--angles", "deg", "--columns", "theta_i=#1,phi_i=#2,theta_o=#3,phi_o=#4,f=#5",
                           "--isotropic", "--starts", "0", "--model", "glossy", "--model", "glossy-metal", slices});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const auto fit = manifest::parse_document(ended.out, "out", folder_.path()).surface_fits.at("aluminum_brdf");
  EXPECT_THAT(fit.model, HasSubstr("metal"));
  EXPECT_THAT(fit.sentence, HasSubstr("does not tell a metal from a dielectric of index 2."));
}

}  // namespace
}  // namespace gonio
