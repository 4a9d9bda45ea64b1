// Sequences and reconstructions as entries of a manifest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"
#include "nrsfm/files.h"
#include "nrsfm/manifest_sequences.h"
#include "synthetic.h"

namespace gonio::nrsfm::testing {
namespace {

struct Entered {
  tests::ScratchFolder folder;
  manifest::Document document;
  Sequence sequence = made({.frames = 20, .points = 12, .shapes = 2, .cosines = 2});
  std::string id;

  Entered() {
    document.folder = folder.path();
    document.name = "m.json";
    write_sequence(sequence, folder / "bending.mat");
    id = enter_sequence(document, folder / "bending.mat", sequence);
  }
};

TEST(Manifest, gives_back_the_sequence_that_was_entered) {
  Entered e;
  EXPECT_EQ(e.id, "bending");
  const Sequence back = sequence_of(e.document, e.id);
  EXPECT_EQ(back.name, "bending");
  EXPECT_TRUE(back.tracks.isApprox(e.sequence.tracks, 1e-12));
  EXPECT_TRUE(back.truth->isApprox(*e.sequence.truth, 1e-12));
  EXPECT_EQ(enter_sequence(e.document, e.folder / "bending.mat", e.sequence), "bending-2");
}

TEST(Manifest, entry_says_more_than_the_file) {
  Entered e;
  manifest::TrackSequence& entry = e.document.sequences.at(e.id);
  entry.projection = "perspective";
  entry.camera = "c";
  entry.factors = {{"path", "circle"}};
  manifest::Camera camera;
  camera.fx_px = 800.0;
  camera.fy_px = 801.0;
  camera.cx_px = 320.0;
  camera.cy_px = 240.0;
  e.document.cameras["c"] = camera;
  const Sequence back = sequence_of(e.document, e.id);
  EXPECT_EQ(back.projection, Projection::perspective);
  ASSERT_TRUE(back.pinhole.has_value());
  EXPECT_EQ(back.pinhole->fy_px, 801);
  EXPECT_EQ(back.factors.at("path"), "circle");
}

TEST(Manifest, refuses_entries_that_do_not_fit) {
  Entered e;
  EXPECT_THROW(sequence_of(e.document, "stretching"), Error);
  e.document.sequences.at(e.id).frames = 21;
  try {
    sequence_of(e.document, e.id);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("m.json#/sequences/bending/frames"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("21 where the file has 20"));
  }
}

TEST(Manifest, takes_a_reconstruction_and_replaces_one_of_the_same_id) {
  Entered e;
  const Solution solution = answer("pta", sequence_of(e.document, e.id), {{"terms", 2}});
  write_reconstruction(solution.reconstruction, e.folder / "bending-pta.mat");
  for (int k = 0; k < 2; ++k)
    enter_reconstruction(e.document, "bending-pta", e.id, solution, 7, e.folder / "bending-pta.mat");
  ASSERT_EQ(e.document.reconstructions.size(), 1u);
  const manifest::ShapeReconstruction& entry = e.document.reconstructions.front();
  EXPECT_EQ(entry.sequence, "bending");
  EXPECT_EQ(entry.algorithm, "pta");
  EXPECT_EQ(entry.parameters.at("terms"), 2);
  EXPECT_EQ(*entry.estimated_share, 1);
  EXPECT_EQ(entry.frame, "object");
  const Reconstruction back = read_reconstruction(e.folder / "bending-pta.mat");
  EXPECT_TRUE(back.shapes.isApprox(solution.reconstruction.shapes, 1e-12));
  const std::string text = print_document(e.document, e.folder.path());
  const manifest::Document again = manifest::parse_document(text, "m.json", e.folder.path());
  EXPECT_EQ(again.reconstructions.size(), 1u);
}

}  // namespace
}  // namespace gonio::nrsfm::testing
