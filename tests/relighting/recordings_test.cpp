// What the image model takes from the files of photographs: which pixels count (relighting/recordings.h).
#include "relighting/recordings.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"
#include "manifest/document.h"

namespace gonio::relighting {
namespace {

manifest::Document document_of(const std::filesystem::path& folder, const std::string& response,
                               const std::string& file = "a.png", const std::string& more = "") {
  const std::string json = R"({"gonio": 1, "files": {"a": {"path": ")" + file + R"("}},
          "cameras": {"c": {"model": "pinhole", "width_px": 4, "height_px": 1, "fx_px": 4, "fy_px": 4, "cx_px": 1.5,
                            "cy_px": 0}},
          "images": [{"id": "a", "file": "a", "camera": "c")" +
                           (response.empty() ? "" : R"(, "response": ")" + response + "\"") + more + "}]}";
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

// Of a picture that says how sure it is of each value, that counts, and what it says nothing of does not; the
// manifest's noise goes before it.
TEST(Recordings, EachReadingHasTheVarianceThatItsFileStates) {
  const tests::ScratchFolder folder;
  io::Image image(4, 1, {"R", "G", "B", "variance.R", "variance.G", "variance.B"});
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      image.data[6 * i + c] = 1;
      image.data[6 * i + 3 + c] = i == 2 && c == 1 ? 0.0f : static_cast<float>((3 * i + c + 1) * (3 * i + c + 1));
    }
  io::write_picture(folder / "a.exr", image);
  const Recordings read = read_recordings(document_of(folder.path(), "", "a.exr"));
  EXPECT_EQ(read.images[0].counts, (std::vector<std::uint8_t>{1, 1, 0, 1}));
  for (const std::size_t place : {0, 4, 11}) EXPECT_FLOAT_EQ(noise_sigma(read.images[0], 1, place), place + 1) << place;
  const Recordings stated =
      read_recordings(document_of(folder.path(), "", "a.exr", R"(, "noise": {"gain": 1e12, "read": 0.5})"));
  EXPECT_EQ(stated.images[0].counts, (std::vector<std::uint8_t>{1, 1, 1, 1}));
  EXPECT_FLOAT_EQ(noise_sigma(stated.images[0], 1, 4), 0.5);
}

}  // namespace
}  // namespace gonio::relighting
