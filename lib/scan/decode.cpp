// See decode.h.
#include "scan/decode.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "photograph/noise_variance.h"
#include "scan/cosine_decoder.h"
#include "scan/frame_noise.h"
#include "scan/gray_decoder.h"
#include "scan/line_decoder.h"

namespace gonio::scan {
namespace {

using What = Shown::What;

CameraFrame read_checked(const DecodeRequest& r, std::size_t frame) {
  CameraFrame f = r.read(frame);
  const std::size_t pixels = static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height);
  if (f.size() != pixels)
    throw Error(Exit::data, format("frame %zu", frame), "is of another size than the first",
                "give pictures of one camera that did not move");
  return f;
}

std::optional<std::size_t> frame_that(const Sequence& s, const auto& is) {
  const auto found = std::ranges::find_if(s.frames, is);
  if (found == s.frames.end()) return std::nullopt;
  return static_cast<std::size_t>(found - s.frames.begin());
}

}  // namespace

Codes decode(const DecodeRequest& r) {
  const std::size_t pixels = static_cast<std::size_t>(r.width) * static_cast<std::size_t>(r.height);
  Codes codes;
  codes.width = r.width, codes.height = r.height;
  codes.refusal.assign(pixels, Refusal::none);
  constexpr double least_sigma = 1e-6;  // zero says that nothing is known
  if (r.gamma > 0) codes.gamma = r.gamma, codes.gamma_sigma = std::max(least_sigma, r.gamma_sigma);
  if (!r.mask.empty())
    for (std::size_t i = 0; i < pixels; ++i)
      if (r.mask[i] == 0) codes.refusal[i] = Refusal::masked;
  const auto reader = [&r](std::size_t frame) { return read_checked(r, frame); };
  const auto white = frame_that(r.sequence, [](const Shown& s) { return s.what == What::white; });
  const auto black = frame_that(r.sequence, [](const Shown& s) { return s.what == What::black; });
  const bool bits = frame_that(r.sequence, [](const Shown& s) { return s.what == What::bit; }).has_value();
  if (bits) {
    if (!white || !black)
      throw Error(Exit::data, "sequence", "has bits, and no white or no black picture",
                  "show both: they tell what is lit at all");
    decode_gray(r, reader, *white, *black, codes);
  }
  if (frame_that(r.sequence, [](const Shown& s) { return s.what == What::cosine; })) decode_cosines(r, reader, codes);
  if (frame_that(r.sequence, [](const Shown& s) { return s.what == What::line; })) decode_lines(r, reader, codes);
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t axis = 0; axis < 2; ++axis)
    for (std::size_t i = 0; i < codes.place[axis].size(); ++i) {
      const float u = codes.place[axis][i];
      if (codes.told(i) && !(u > -1 && u < static_cast<float>(r.sequence.size(static_cast<Axis>(axis)))))
        codes.refusal[i] = Refusal::outside;
      if (!codes.told(i)) codes.place[axis][i] = codes.sigma[axis][i] = none;
    }
  return codes;
}

}  // namespace gonio::scan
