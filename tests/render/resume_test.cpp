// Renderings that were interrupted go on to the picture that they would have become; nothing is taken for what it is
// not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "data.h"
#include "io/exr.h"
#include "io/ply.h"
#include "manifest/sections/file.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mesh.h"
#include "manifest/sections/object.h"
#include "manifest/sections/rendering.h"
#include "progressive_scene.h"
#include "render/share.h"

namespace gonio::render {
namespace {

namespace fs = std::filesystem;
using tests::rendered;
using tests::small_scene;

class Resume : public testing::Test {
 protected:
  fs::path picture() const { return folder_ / "one.exr"; }
  fs::path checkpoint() const { return folder_ / "one.checkpoint"; }
  // As a run leaves it that was stopped after some passes.
  void stop_after(const std::string& samples, SessionOptions options = {.spp = 16}) {
    options.samples = samples;
    write_sums(checkpoint(), *rendered(small_scene(), options, 0, folder_ / "share.exr").sums, 7);
  }
  void write(const Rendered& r) { write_file(picture(), io::encode_exr(r.picture, attributes_of(r.facts, r.picture))); }
  Exit refusal(const SessionOptions& options) {
    try {
      rendered(small_scene(), options, 0, picture());
    } catch (const Error& e) {
      return e.code();
    }
    return Exit::done;
  }
  tests::ScratchFolder folder_;
};

TEST_F(Resume, GoesOnToTheSamePicture) {
  const Rendered whole = rendered(small_scene(), {.spp = 16});
  for (const char* samples : {"0:1", "0:9", "0:16"}) {
    stop_after(samples);
    const Rendered resumed = rendered(small_scene(), {.spp = 16, .resume = true}, 0, picture());
    EXPECT_EQ(resumed.picture.data, whole.picture.data) << samples;
    EXPECT_EQ(resumed.facts.end_sample, 16);
  }
}

TEST_F(Resume, CheckpointsAppearWhileItWorks) {
  const Rendered whole = rendered(small_scene(), {.spp = 16, .checkpoint_s = 0}, 0, picture());
  ASSERT_TRUE(fs::exists(checkpoint()));
  const SumsHeader header = read_sums_header(checkpoint());
  EXPECT_GT(header.passes, 0u);
  EXPECT_LE(header.passes, 16u);
  const Rendered resumed = rendered(small_scene(), {.spp = 16, .resume = true}, 0, picture());
  EXPECT_EQ(resumed.picture.data, whole.picture.data);
  Session::remove_checkpoint(picture());
  EXPECT_FALSE(fs::exists(checkpoint()));
  rendered(small_scene(), {.spp = 16, .checkpoint_s = 3600}, 0, picture());
  EXPECT_FALSE(fs::exists(checkpoint()));
}

TEST_F(Resume, ACheckpointOfAnotherCallIsNotMixedIn) {
  stop_after("0:8");
  EXPECT_EQ(refusal({.spp = 16}), Exit::cannot_create) << "nobody asked to go on";
  EXPECT_EQ(refusal({.seed = 2, .spp = 16, .resume = true}), Exit::data);
  EXPECT_EQ(refusal({.spp = 64, .resume = true}), Exit::data) << "other passes";
  EXPECT_EQ(refusal({.geometry = false, .spp = 16, .resume = true}), Exit::data);
  EXPECT_EQ(refusal({.spp = 16, .samples = "2:16", .resume = true}), Exit::data);
  EXPECT_EQ(refusal({.spp = 4, .resume = true}), Exit::data) << "it has more";
  EXPECT_EQ(refusal({.spp = 16, .resume = true, .force = true}), Exit::done) << "--force begins anew";
  write_file(checkpoint(), read_file(checkpoint()).substr(0, 5000));
  EXPECT_EQ(refusal({.spp = 16, .resume = true}), Exit::data);
}

TEST_F(Resume, FinishedPicturesAreKnown) {
  const SessionOptions options{.spp = 16, .resume = true};
  EXPECT_FALSE(Session(small_scene(), options, {}).finished(0, picture()));
  write(rendered(small_scene(), options, 0, picture()));
  const auto facts = Session(small_scene(), options, {}).finished(0, picture());
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->samples(), 16);
  EXPECT_GT(facts->relative_error, 0);
  const auto is_another = [&](const manifest::Document& document, const SessionOptions& other) {
    EXPECT_THROW((void)Session(document, other, {}).finished(0, picture()), Error);
  };
  is_another(small_scene(), {.seed = 2, .spp = 16, .resume = true});
  is_another(small_scene(), {.spp = 32, .resume = true});
  is_another(small_scene(tests::glass()), options);
  is_another(small_scene(), {.relative_error = 1e-3, .resume = true});
  EXPECT_TRUE(Session(small_scene(), {.relative_error = 0.9, .resume = true}, {}).finished(0, picture()));
  EXPECT_FALSE(Session(small_scene(), {.spp = 16, .resume = true, .force = true}, {}).finished(0, picture()));
  stop_after("0:8");  // where a checkpoint lies the picture is an older one
  EXPECT_FALSE(Session(small_scene(), options, {}).finished(0, picture()));
}

// What the picture depends on, and what it does not.
TEST_F(Resume, TheSceneIsKnownByItsContent) {
  const auto name = [](const manifest::Document& document, const SessionOptions& options = {.spp = 2}) {
    return rendered(document, options).facts.scene;
  };
  const auto plain = small_scene();
  auto same = plain;
  same.renderings.push_back({.image = "one", .file = "r"});
  same.images[0].file = "recording";
  same.files["recording"] = {"recording.exr", {}, ""};
  EXPECT_EQ(name(same), name(plain));
  EXPECT_NE(name(small_scene(tests::glass())), name(plain));
  EXPECT_NE(name(plain, {.geometry = false, .spp = 2}), name(plain));
  SessionOptions options{.spp = 2};
  options.transport.max_bounces = 3;
  EXPECT_NE(name(plain, options), name(plain));
}

// Two meshes change places: the same files, another picture.
TEST_F(Resume, FilesAreKnownByTheirPlaceInTheScene) {
  for (const double height : {0.1, 0.3}) {
    io::TriangleMesh mesh;
    mesh.positions_m = {{0, 0, height}, {0.1, 0, 0}, {-0.1, 0.1, 0}, {-0.1, -0.1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    io::write_ply(folder_ / (height < 0.2 ? "low.ply" : "high.ply"), mesh);
  }
  auto document = small_scene();
  document.folder = folder_.path();
  document.files = {{"a", {"low.ply", {}, ""}}, {"b", {"high.ply", {}, ""}}};
  document.meshes["a"].file = "a";
  document.meshes["b"].file = "b";
  document.objects[0].mesh = "a";
  document.objects[1].mesh = "b";
  auto swapped = document;
  std::swap(swapped.files["a"].path, swapped.files["b"].path);
  const Rendered one = rendered(document, {.spp = 2}), other = rendered(swapped, {.spp = 2});
  ASSERT_NE(one.picture.data, other.picture.data);
  EXPECT_NE(one.facts.scene, other.facts.scene);
  fs::create_directory(folder_ / "moved");  // elsewhere on another machine
  for (const char* name : {"low.ply", "high.ply"}) fs::copy_file(folder_ / name, folder_ / "moved" / name);
  auto moved = document;
  for (auto& [id, file] : moved.files) file.path = "moved/" + file.path;
  EXPECT_EQ(rendered(moved, {.spp = 2}).facts.scene, one.facts.scene);
}

}  // namespace
}  // namespace gonio::render
