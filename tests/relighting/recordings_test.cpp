// What the image model takes from the files of photographs: which pixels count (relighting/recordings.h).
#include "relighting/recordings.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "io/codes.h"
#include "manifest/document.h"

namespace gonio::relighting {
namespace {

manifest::Document document_of(const std::filesystem::path& folder, const std::string& response) {
  const std::string json =
      R"({"gonio": 1, "files": {"a": {"path": "a.png"}},
          "cameras": {"c": {"model": "pinhole", "width_px": 4, "height_px": 1, "fx_px": 4, "fy_px": 4, "cx_px": 1.5,
                            "cy_px": 0}},
          "images": [{"id": "a", "file": "a", "camera": "c")" +
      (response.empty() ? "" : R"(, "response": ")" + response + "\"") + "}]}";
  return manifest::parse_document(json, (folder / "s.json").string(), folder);
}

TEST(Recordings, TheTopCodesOfSixteenBitsCount) {
  const tests::ScratchFolder folder;
  io::Image image(4, 1, {"Y"});
  image.data = {1, 65534 / 65535.0f, 0.999f, 0.5f};  // all but the last beyond the highest code but one of 8 bits
  io::write_png(folder / "a.png", image, 16);
  EXPECT_EQ(read_recordings(document_of(folder.path(), "linear")).images[0].counts,
            (std::vector<std::uint8_t>{0, 1, 1, 1}));
}

TEST(Recordings, CodesWhoseMeaningIsNotStatedAreRefused) {
  const tests::ScratchFolder folder;
  io::write_png(folder / "a.png", io::Image(4, 1, {"Y"}), 8);
  EXPECT_THROW(read_recordings(document_of(folder.path(), "")), Error);
}

}  // namespace
}  // namespace gonio::relighting
