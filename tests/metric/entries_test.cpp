// What is held against a photograph.
#include "metric/entries.h"

#include <gtest/gtest.h>

#include "data.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/image.h"
#include "manifest/sections/rendering.h"

namespace gonio::metric {
namespace {

// A sensor behind polarizers gets half of the light, more or less: the rendering of what it gets, where there is one.
TEST(Entries, ASensorBehindPolarizersIsHeldAgainstWhatItGets) {
  const tests::ScratchFolder folder;
  io::Image image(2, 2, {"R", "G", "B"});
  for (const char* name : {"photograph.exr", "whole.exr", "mosaic.exr"}) io::write_picture(folder / name, image);
  manifest::Document document;
  document.folder = folder.path();
  manifest::ImageEntry entry;
  entry.id = "view";
  entry.camera = "camera";
  entry.file = manifest::add_file(document, folder / "photograph.exr", "view");
  document.images = {entry};
  manifest::Rendering rendering;
  rendering.image = "view";
  rendering.file = manifest::add_file(document, folder / "whole.exr", "whole");
  rendering.files["mosaic"] = manifest::add_file(document, folder / "mosaic.exr", "mosaic");
  document.renderings = {rendering};
  document.cameras["camera"];
  EXPECT_EQ(entries(document).front().rendering.filename(), "whole.exr");
  document.cameras["camera"].mosaic = "polarizers";
  EXPECT_EQ(entries(document).front().rendering.filename(), "mosaic.exr");
  document.renderings.front().files.clear();
  EXPECT_EQ(entries(document).front().rendering.filename(), "whole.exr");
}

}  // namespace
}  // namespace gonio::metric
