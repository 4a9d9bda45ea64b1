// Every registered surface through the manifest: written, read and built into a scene it has the same values, bit for
// bit, whichever way a parameter is stated. Nothing here names a model.
#include <gtest/gtest.h>

#include "cases.h"
#include "manifest/document.h"
#include "manifest/sections/file.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/surface.h"
#include "scene/scene.h"
#include "surface/law.h"

namespace gonio::tests {
namespace {

using manifest::Document;
using manifest::Parameter;

// Inside the bounds, with all of its digits.
Parameter drawn(const manifest::ParameterInfo& info, Random& random) {
  std::vector<double> value;
  for (int i = 0; i < info.components; ++i) value.push_back(draw_value(info, random));
  return value;
}
Parameter adorned(Parameter p, const manifest::ParameterInfo& info, Random& random) {
  p.free = true;
  if (std::isfinite(info.lower) && random.below(2) == 0) p.min = info.lower;
  if (std::isfinite(info.upper) && random.below(2) == 0) p.max = info.upper;
  if (random.below(2) == 0) p.sigma = random.uniform();
  if (random.below(2) == 0) p.share = "tied " + info.name;
  return p;
}

// A ball with the surface "tested", every parameter stated, and what the surface lies on or reads.
Document document_of(const surface::Model& model, Random& random) {
  Document d;
  d.folder = std::filesystem::temp_directory_path();
  manifest::Surface& s = d.surfaces["tested"];
  s.model = model.info().id;
  for (const auto& info : model.info().parameters) s.parameters[info.name] = drawn(info, random);
  if (model.info().attachment != manifest::Attachment::none) {
    const std::filesystem::path table = file_for(model.info());
    d.folder = table.parent_path();
    d.files["table"].path = table.filename();
    s.file = "table";
  }
  if (model.info().takes_base) {
    s.base = "beneath";
    const auto plain = [](const surface::Model* m) {
      return !m->info().takes_base && !m->transmits() && m->info().attachment == manifest::Attachment::none;
    };
    const auto all = surface::all_models();
    const surface::Model* base = *std::find_if(all.begin(), all.end(), plain);
    d.surfaces["beneath"].model = base->info().id;
    for (const auto& info : base->info().parameters) d.surfaces["beneath"].parameters[info.name] = drawn(info, random);
  }
  d.meshes["ball"].sphere_radius_m = 0.1;
  d.objects.push_back({.id = "o", .mesh = "ball", .surface = "tested", .world_from_object = {}});
  return d;
}

Document read_back(const Document& d) {
  return manifest::parse_document(manifest::print_document(d, d.folder), "round.json", d.folder);
}

void expect_same(const manifest::Surface& a, const manifest::Surface& b, const std::string& what) {
  EXPECT_EQ(a.model, b.model) << what;
  EXPECT_EQ(a.parameters, b.parameters) << what;
  EXPECT_EQ(a.textures, b.textures) << what;
  EXPECT_EQ(a.sigma, b.sigma) << what;
  EXPECT_EQ(a.file, b.file) << what;
  EXPECT_EQ(a.base, b.base) << what;
  EXPECT_EQ(a.spectra, b.spectra) << what;
  EXPECT_EQ(a.vertices, b.vertices) << what;
  EXPECT_EQ(a.labels, b.labels) << what;
  ASSERT_EQ(a.laws.size(), b.laws.size()) << what;
  for (const auto& [parameter, use] : a.laws) {
    ASSERT_TRUE(b.laws.contains(parameter)) << what;
    EXPECT_EQ(use.law, b.laws.at(parameter).law) << what;
    EXPECT_EQ(use.parameters, b.laws.at(parameter).parameters) << what;
  }
}

class SurfaceInManifest : public testing::TestWithParam<const surface::Model*> {};
INSTANTIATE_TEST_SUITE_P(Registered, SurfaceInManifest,
                         testing::ValuesIn(surface::all_models().begin(), surface::all_models().end()), test_name);

TEST_P(SurfaceInManifest, NumbersReadBackBitForBit) {
  const surface::Model& model = *GetParam();
  Random random(21);
  for (int k = 0; k < 50; ++k) {
    Document d = document_of(model, random);
    for (const auto& info : model.info().parameters) {
      manifest::Surface& s = d.surfaces["tested"];
      if (random.below(2) == 0) s.parameters[info.name] = adorned(s.parameters[info.name], info, random);
      if (random.below(2) == 0) s.sigma[info.name] = {random.uniform()};
    }
    const Document read = read_back(d);
    expect_same(d.surfaces.at("tested"), read.surfaces.at("tested"), model.info().id);
    EXPECT_EQ(surface::values_of(model, d.surfaces.at("tested").parameters, "before").v,
              surface::values_of(model, read.surfaces.at("tested").parameters, "after").v);
    EXPECT_EQ(manifest::print_document(read, d.folder), manifest::print_document(d, d.folder));
  }
}

TEST_P(SurfaceInManifest, ScenesHaveTheValuesThatWereWritten) {
  const surface::Model& model = *GetParam();
  Random random(22);
  for (int k = 0; k < 3; ++k) {
    const Document d = document_of(model, random);
    const scene::Scene scene = scene::build_scene(read_back(d));
    for (const scene::Surface& built : scene.appearance.surfaces) {
      const manifest::Surface& written = d.surfaces.at(built.id);
      EXPECT_EQ(built.model->info().id, written.model);
      EXPECT_EQ(built.values.v, surface::values_of(*built.model, written.parameters, "written").v) << built.id;
      EXPECT_EQ(built.base.has_value(), !written.base.empty());
    }
  }
}

// By a texture, a spectrum, per vertex, per label, by any law that is registered: one parameter after the other.
TEST_P(SurfaceInManifest, OtherWaysToStateAParameterReadBack) {
  const surface::Model& model = *GetParam();
  Random random(23);
  const Document plain = document_of(model, random);
  for (const auto& info : model.info().parameters) {
    const auto expect_kept = [&](const char* way, const auto& state) {
      Document d = plain;
      d.files["other"].path = "other.csv";
      state(d.surfaces["tested"]);
      const Document read = read_back(d);
      expect_same(d.surfaces.at("tested"), read.surfaces.at("tested"), model.info().id + " " + info.name + " " + way);
    };
    expect_kept("texture", [&](manifest::Surface& s) { s.textures[info.name] = "other"; });
    expect_kept("spectrum", [&](manifest::Surface& s) {
      s.parameters.erase(info.name);
      s.spectra[info.name] = "other";
    });
    expect_kept("per vertex", [&](manifest::Surface& s) { s.vertices[info.name] = "wear"; });
    expect_kept("per label", [&](manifest::Surface& s) {
      for (const char* label : {"-1", "0", "7"}) s.labels[info.name][label] = drawn(info, random);
    });
    for (const surface::Law* law : surface::all_laws())
      expect_kept("law", [&](manifest::Surface& s) {
        manifest::LawUse use{.law = law->info().id, .parameters = {}};
        for (const auto& amount : law->info().parameters) use.parameters[amount.name] = drawn(amount, random);
        s.laws[info.name] = use;
      });
  }
}

}  // namespace
}  // namespace gonio::tests
