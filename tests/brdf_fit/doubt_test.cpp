// brdf-fit on photographs that render makes, and results that it doubts: status 2, with the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "data.h"
#include "manifest/document.h"
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
  const Ended ended = run({"brdf-fit", "--model", "coated-diffuse", "--html", "p.html"}, images.out);
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
  EXPECT_THAT(read_file(folder_.path() / "p.html"), HasSubstr("told from its reflectance"));
}

// Dark red under varnish, of one band: a conductor fits it with constants of no metal. Left to itself brdf-fit refuses
// that one; asked for it, it says so.
TEST_F(BrdfFitOfImages, CallsNoPaintAMetal) {
  const auto paint = tests::data("brdf/cornell/garnet_red.brdf");
  if (!std::filesystem::exists(paint)) {
    if (tests::data_is_required()) FAIL() << paint << " is missing";
    GTEST_SKIP() << paint << " is not there";
  }
  const Ended named = run({"brdf-fit", "--bands", "550nm", "--isotropic", "--model", "conductor", paint.string()});
  EXPECT_EQ(named.status, 2) << named.err;
  EXPECT_THAT(named.err, HasSubstr("no known metal"));
  const auto document = manifest::parse_document(named.out, "out", folder_.path());
  EXPECT_EQ(document.surface_fits.at("garnet_red").verdict, "doubtful");
  const Ended free =
      run({"brdf-fit", "--bands", "550nm", "--isotropic", "--starts", "0", "--lobes", "1", paint.string()});
  EXPECT_EQ(free.status, 0) << free.err;
  const auto fit = manifest::parse_document(free.out, "out", folder_.path()).surface_fits.at("garnet_red");
  EXPECT_TRUE(fit.parameters.contains("albedo")) << fit.model;
  EXPECT_THAT(fit.refusals, testing::Contains(testing::AllOf(HasSubstr("conductor"), HasSubstr("no known metal"))));
}

}  // namespace
}  // namespace gonio
