// Frames that are kept are those that would be decoded again, whatever their codes are and however little memory there
// is.
#include "photograph/frame_store.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/codes.h"
#include "io/picture.h"

namespace gonio::photograph {
namespace {

constexpr int width = 90, height = 50;

// 8 and 16 bits, floats that are whole, that are not, and that are no numbers; black that is whole or not.
std::vector<StoredFrame> frames_in(const tests::ScratchFolder& folder) {
  Random random(3);
  io::Image image(width, height, {"Y"});
  for (float& v : image.data) v = static_cast<float>(random.uniform());
  image.data[0] = 0, image.data[1] = 1;
  io::write_png(folder / "a.png", image, 8);
  io::write_png(folder / "b.png", image, 16);
  io::write_picture(folder / "c.exr", image);
  for (float& v : image.data) v = std::round(4000 * v);
  io::write_picture(folder / "d.exr", image);
  image.data[5] = 1e9f, image.data[6] = -1e9f, image.data[7] = std::nanf("");
  io::write_picture(folder / "e.exr", image);
  std::vector<StoredFrame> frames;
  for (const char* name : {"a.png", "b.png", "c.exr", "d.exr", "e.exr"})
    for (const double black : {0.0, 3.0, 0.3}) {
      frames.push_back({folder / name, {}});
      frames.back().stated.black = black, frames.back().stated.exposure_s = 1 + black;
    }
  return frames;
}

TEST(FrameStore, KeepsWhatWouldBeDecoded) {
  const tests::ScratchFolder folder;
  const auto frames = frames_in(folder);
  const std::size_t one = sizeof(std::uint16_t) * width * height;
  for (const std::size_t memory : {std::size_t{0}, one, 7 * one, 1000 * one}) {
    const FrameStore store(frames, memory);
    ASSERT_EQ(store.size(), frames.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const RawFrame again = read_raw_frame(frames[k].path, frames[k].stated);
      const std::vector<float> codes = store.codes(k);
      ASSERT_EQ(codes.size(), again.codes.size());
      for (std::size_t i = 0; i < codes.size(); ++i)
        if (!std::isnan(again.codes[i])) {
          ASSERT_EQ(codes[i], again.codes[i]) << frames[k].path << " " << i;
        }
      EXPECT_EQ(store.head(k).full_scale, again.full_scale);
      EXPECT_EQ(store.head(k).exposure_s, again.exposure_s);
      EXPECT_EQ(store.head(k).width, width);
    }
  }
}

TEST(FrameStore, TheFirstBadFrameIsNamed) {
  const tests::ScratchFolder folder;
  auto frames = frames_in(folder);
  frames[4].path = folder / "missing.png", frames[9].path = folder / "gone.png";
  try {
    const FrameStore store(frames, 0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("missing.png"), std::string::npos);
  }
}

}  // namespace
}  // namespace gonio::photograph
