// See raw_view.h.
#include "photograph/raw_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "photograph/exposure_times.h"
#include "photograph/frame_store.h"

namespace gonio::photograph {
namespace {

constexpr std::size_t most_samples = 60000;  // of the noise's estimate

class Development {
 public:
  Development(const RawView& view, const RawRecipe& recipe) : view_(view), recipe_(recipe) {}

  DevelopedView run() {
    look();
    DevelopedView out;
    out.noise = noise(out.noise_from_exposures);
    MergeRequest request{.width = width_,
                         .height = height_,
                         .exposures_s = exposures_s_,
                         .read = [this](std::size_t k) { return plane(k); },
                         .noise = out.noise,
                         .full_scale = full_scale_,
                         .floor = floor_,
                         .blooming_px = recipe_.blooming_px,
                         .period_px = mosaic_.period_px(),
                         .refine_exposures = recipe_.refine_exposures};
    if (frames_.holds_all())
      request.read_rows = [this](std::size_t k, int first, int count, RawPlane& into) { rows(k, first, count, into); };
    // Dark frames' own noise is in every reading.
    if (recipe_.dark && recipe_.dark->frames > 0)
      request.noise.read *= std::sqrt(1 + 1 / static_cast<double>(recipe_.dark->frames));
    // What is stated is of codes as they are read; what exposures say of each other is of linear ones.
    if (recipe_.stated.linearity && !out.noise_from_exposures)
      request.noise = recipe_.stated.linearity->noise(request.noise, full_scale_);
    out.stated_s = exposures_s_;
    out.merged = merge_exposures(request);
    flatten(out.merged);
    paint(out);
    return out;
  }

 private:
  // Sizes, mosaic and times of all frames; the least full scale counts.
  void look() {
    if (view_.frames.empty()) throw Error(Exit::data, view_.name, "has no frames", "one at least");
    std::vector<StoredFrame> wanted;
    for (std::size_t k = 0; k < view_.frames.size(); ++k) {
      wanted.push_back({view_.frames[k], recipe_.stated});
      if (view_.exposures_s[k]) wanted[k].stated.exposure_s = view_.exposures_s[k];
    }
    frames_ = FrameStore(std::move(wanted), recipe_.frame_memory_bytes);
    full_scale_ = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const RawFrame& frame = frames_.head(k);
      const std::string place = frames_.path(k).string();
      if (k == 0) width_ = frame.width, height_ = frame.height, mosaic_ = frame.mosaic;
      if (frame.width != width_ || frame.height != height_)
        throw Error(
            Exit::data, place,
            format("has %d x %d samples, the view's first frame %d x %d", frame.width, frame.height, width_, height_),
            "frames of one view come from one camera");
      if (!(frame.mosaic == mosaic_))
        throw Error(Exit::data, place, "has another mosaic than the view's first frame", "state --mosaic");
      if (!frame.exposure_s && view_.frames.size() > 1)
        throw Error(Exit::data, place, "does not say how long it was exposed",
                    "state exposure_s, or write it into the name: scene_20ms.png");
      exposures_s_.push_back(frame.exposure_s.value_or(1));
      if (frame.full_scale < full_scale_) full_scale_ = frame.full_scale;
      floor_ = k == 0 ? frame.floor : std::max(floor_, frame.floor);
    }
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    if ((recipe_.dark && recipe_.dark->offset.size() != pixels) ||
        (recipe_.flat && recipe_.flat->factor.size() != pixels))
      throw Error(Exit::data, frames_.path(0).string(), "is of another size than the dark or flat frames",
                  "frames of one sensor");
  }

  // Dark current off, and which samples are unusable, of rows whose first sample is the frame's sample `first`. What is
  // full is full before anything is taken off.
  void correct(std::size_t k, std::size_t first, RawPlane& p) const {
    if (!recipe_.dark && !recipe_.flat) return;
    p.unusable.assign(p.codes.size(), 0);
    const auto exposure_s = static_cast<float>(exposures_s_[k]);
    for (std::size_t n = 0, i = first; n < p.codes.size(); ++n, ++i) {
      if (recipe_.flat) p.unusable[n] |= recipe_.flat->dead[i];
      if (!recipe_.dark) continue;
      p.unusable[n] |= recipe_.dark->hot[i];
      p.codes[n] = p.codes[n] >= full_scale_ ? std::numeric_limits<float>::infinity()
                                             : p.codes[n] - recipe_.dark->at(i, exposure_s);
    }
  }
  RawPlane plane(std::size_t k) const {
    RawPlane p{frames_.codes(k), {}};
    correct(k, 0, p);
    return p;
  }
  void rows(std::size_t k, int first, int count, RawPlane& into) const {
    frames_.rows(k, first, count, into.codes);
    correct(k, static_cast<std::size_t>(first) * static_cast<std::size_t>(width_), into);
  }

  manifest::Noise noise(bool& from_exposures) const {
    if (recipe_.noise) return *recipe_.noise;
    const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                      stride = std::max<std::size_t>(1, pixels / most_samples) | 1;
    // A start: read noise of a code, and as many electrons as fill a sensor of some 10,000.
    const manifest::Noise start{1e4 / std::min(full_scale_, 1e6), 1};
    ExposureSamples samples{exposures_s_, {}, start, full_scale_, floor_};
    for (std::size_t k = 0; k < exposures_s_.size(); ++k) {
      const RawPlane p = plane(k);
      const auto kinds = kinds_of(p, width_, height_, full_scale_, recipe_.blooming_px);
      samples.codes.emplace_back();
      for (std::size_t i = 0; i < pixels; i += stride)
        samples.codes.back().push_back(kinds[i] == SampleKind::read ? p.codes[i]
                                                                    : std::numeric_limits<float>::quiet_NaN());
    }
    // Shutters that are off would be taken for noise.
    for (int round = 0; round < 3 && recipe_.refine_exposures; ++round) {
      if (const auto found = noise_of_stack(samples)) samples.noise = found->noise;
      samples.exposures_s = refine_exposures(samples).exposures_s;
    }
    const auto found = noise_of_stack(samples);
    if (!found)
      throw Error(Exit::data, view_.name, "does not tell its own noise: fewer than two exposures overlap",
                  "state --noise-gain and --read-noise");
    from_exposures = true;
    return found->noise;
  }

  void flatten(MergedPlane& m) const {
    if (!recipe_.flat) return;
    for (std::size_t i = 0; i < m.rate.size(); ++i) {
      const float f = recipe_.flat->factor[i];
      m.variance[i] = f * f * m.variance[i] + f * f * m.rate[i] * m.rate[i] * recipe_.flat->variance[i];
      m.rate[i] *= f;
    }
  }

  void paint(DevelopedView& out) const {
    const MergedPlane& m = out.merged;
    std::vector<std::uint8_t> trusted(m.rate.size());
    double bright = 0, moved = 0, none = 0;
    for (std::size_t i = 0; i < trusted.size(); ++i) {
      trusted[i] = m.trust[i] == Trust::good || m.trust[i] == Trust::moved;
      bright += m.trust[i] == Trust::too_bright, moved += m.trust[i] == Trust::moved;
      none += m.trust[i] == Trust::no_sample;
    }
    const auto n = static_cast<double>(trusted.size());
    out.share_too_bright = bright / n, out.share_moved = moved / n, out.share_unusable = none / n;
    Demosaiced d =
        demosaic({width_, height_, m.rate, m.variance, trusted, m.first, m.last}, mosaic_, recipe_.demosaicing);
    out.trusted = std::move(d.trusted);
    std::vector<std::string> names = d.colour.channels;
    const std::size_t colours = names.size();
    for (std::size_t c = 0; c < colours; ++c) names.push_back("variance." + names[c]);
    names.insert(names.end(), {"exposure.shortest", "exposure.longest"});
    std::vector<float> times;
    for (const std::size_t k : by_duration(exposures_s_)) times.push_back(static_cast<float>(m.exposures_s[k]));
    out.picture = io::Image(width_, height_, names);
    const auto columns = static_cast<std::size_t>(width_);
    parallel_for(0, static_cast<std::size_t>(height_), [&](std::size_t y) {
      for (std::size_t i = y * columns; i < (y + 1) * columns; ++i) {
        float* pixel = &out.picture.data[i * names.size()];
        for (std::size_t c = 0; c < colours; ++c) {
          pixel[c] = d.colour.data[colours * i + c];
          const float v = d.variance.data[colours * i + c];
          pixel[colours + c] = std::isfinite(v) ? v : 0;
        }
        if (d.first[i] > d.last[i]) continue;  // of none
        pixel[2 * colours] = times[d.first[i]];
        pixel[2 * colours + 1] = times[d.last[i]];
      }
    });
    out.merged.rate.clear(), out.merged.variance.clear(), out.merged.trust.clear();
    out.merged.first.clear(), out.merged.last.clear();
  }

  const RawView& view_;
  const RawRecipe& recipe_;
  FrameStore frames_;
  int width_ = 0, height_ = 0;
  Mosaic mosaic_;
  std::vector<double> exposures_s_;
  double full_scale_ = 0, floor_ = 0;
};

}  // namespace

DevelopedView develop_view(const RawView& view, const RawRecipe& recipe) {
  return Development(view, recipe).run();
}

}  // namespace gonio::photograph
