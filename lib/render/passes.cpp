// The loop over pixels and passes; see passes.h. What a path carries is the integrator's affair (integrator.h).
#include "render/passes.h"

#include <algorithm>
#include <bit>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "render/image_seed.h"
#include "render/pass_splats.h"
#include "render/sample_map.h"

namespace gonio::render {
namespace {

constexpr int tile = 16;  // pixels per side of a unit of parallel work
constexpr int wanted_passes = 16, most_samples_per_pass = 64;
constexpr std::size_t none = ~std::size_t{0};

class PassLoop {
 public:
  PassLoop(const Integrator& integrator, PassSums& sums)
      : integrator_(integrator),
        sums_(sums),
        what_(sums.identity()),
        map_(integrator.sample_map(what_.samples_per_pass)),
        seed_(seed_of(what_.seed, what_.image)),
        planes_(what_.planes.size()) {}

  // Passes first .. first + count - 1 of the pixels of one tile.
  void run_tile(std::size_t index, std::uint32_t first, std::uint32_t count, const PassSplats* splats) {
    const int columns = (what_.width_px + tile - 1) / tile;
    const int left = static_cast<int>(index) % columns * tile, top = static_cast<int>(index) / columns * tile;
    std::vector<Rgb> means(planes_);
    Noticed noticed;
    for (int y = top; y < std::min(top + tile, what_.height_px); ++y)
      for (int x = left; x < std::min(left + tile, what_.width_px); ++x) {
        const auto pixel =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(what_.width_px) + static_cast<std::size_t>(x);
        for (std::uint32_t pass = first; pass < first + count; ++pass) {
          throw_if_interrupted();
          noticed.seen.assign(integrator_.lights(), 0);
          noticed.met = 0;
          trace(x, y, pixel, pass, means, noticed);
          if (splats)
            for (std::size_t plane = 0; plane < planes_; ++plane) means[plane] += splats->value(pixel, plane);
          sums_.add(pixel, means, noticed);
        }
      }
  }

  std::size_t tiles() const {
    const auto along = [](int pixels) { return static_cast<std::size_t>((pixels + tile - 1) / tile); };
    return along(what_.width_px) * along(what_.height_px);
  }

  // Light that only paths from the lights find: as many of them in a pass as paths from the camera.
  std::unique_ptr<PassSplats> splats(std::uint32_t pass) const {
    if (!integrator_.traces_from_lights()) return nullptr;
    auto splats = std::make_unique<PassSplats>(what_.width_px, what_.height_px, planes_);
    const std::uint64_t count = sums_.pixels() * static_cast<std::uint64_t>(what_.samples_per_pass);
    integrator_.trace_from_lights(split_mix(seed_), pass * count, count, *splats);
    return splats;
  }

 private:
  void trace(int x, int y, std::size_t pixel, std::uint32_t pass, std::vector<Rgb>& means, Noticed& noticed) const {
    const std::uint64_t stream = (static_cast<std::uint64_t>(pixel) << 24) + pass;
    std::fill(means.begin(), means.end(), Rgb{});
    const int samples = map_ ? map_->samples(x, y) : what_.samples_per_pass;
    const int noticing = std::min(samples, what_.samples_per_pass);
    Noticed beyond = noticed;
    for (int sample = 0; sample < samples; ++sample) {
      Sampler sampler(seed_, stream, static_cast<std::uint32_t>(sample));
      integrator_.trace(Vec2{x - 0.5, y - 0.5} + sampler.two(), sampler, means, sample < noticing ? noticed : beyond);
    }
    for (Rgb& mean : means) mean = mean / samples;
    // Counts are those of a pass: of its first samples, or of fewer and multiplied.
    const auto share = static_cast<std::uint32_t>(what_.samples_per_pass / noticing);
    noticed.met *= share;
    for (std::uint32_t& seen : noticed.seen) seen *= share;
  }

  const Integrator& integrator_;
  PassSums& sums_;
  const PictureIdentity& what_;
  const SampleMap* map_;  // null: every pixel takes the same
  std::uint64_t seed_;
  std::size_t planes_;
};

template <class Function>
Rgb rgb_of(const Function& channel) {
  return {channel(0), channel(1), channel(2)};
}

}  // namespace

SamplePlan sample_plan(int spp) {
  const int most = std::clamp(spp / wanted_passes, 1, most_samples_per_pass);
  SamplePlan plan;
  plan.samples_per_pass = static_cast<int>(std::bit_floor(static_cast<unsigned>(most)));
  plan.passes = std::max(2, (spp + plan.samples_per_pass - 1) / plan.samples_per_pass);
  return plan;
}

bool keeps_variance(const std::string& plane) {
  return plane.empty() || plane == "s1" || plane == "s2" || plane == "s3";
}

PassSums::PassSums(PictureIdentity identity, std::uint32_t first_pass)
    : identity_(std::move(identity)), first_pass_(first_pass) {
  for (const std::string& plane : identity_.planes)
    with_variance_.push_back(keeps_variance(plane) ? variances_++ : none);
  sums_.resize(pixels() * identity_.planes.size() * 3);
  squares_.resize(pixels() * variances_ * 3);
  met_.resize(pixels());
  seen_.resize(pixels() * identity_.lights.size());
}

std::size_t PassSums::pixels() const {
  return static_cast<std::size_t>(identity_.width_px) * static_cast<std::size_t>(identity_.height_px);
}

void PassSums::add(std::size_t pixel, std::span<const Rgb> means, const Noticed& noticed) {
  for (std::size_t plane = 0; plane < means.size(); ++plane) {
    const std::array<float, 3> v = {static_cast<float>(means[plane].x), static_cast<float>(means[plane].y),
                                    static_cast<float>(means[plane].z)};
    for (std::size_t c = 0; c < 3; ++c) {
      sums_[(pixel * means.size() + plane) * 3 + c].add(v[c]);
      if (with_variance_[plane] != none) squares_[(pixel * variances_ + with_variance_[plane]) * 3 + c].add(v[c]);
    }
  }
  met_[pixel] += noticed.met;
  const std::size_t lights = identity_.lights.size();
  for (std::size_t i = 0; i < lights && i < noticed.seen.size(); ++i) seen_[pixel * lights + i] += noticed.seen[i];
}

void PassSums::append(const PassSums& next) {
  if (!(next.identity_ == identity_) || next.first_pass_ != end_pass())
    throw Error(Exit::internal, identity_.image, "sums were to be joined that do not follow each other");
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i].add(next.sums_[i]);
  for (std::size_t i = 0; i < squares_.size(); ++i) squares_[i].add(next.squares_[i]);
  for (std::size_t i = 0; i < met_.size(); ++i) met_[i] += next.met_[i];
  for (std::size_t i = 0; i < seen_.size(); ++i) seen_[i] += next.seen_[i];
  passes_ += next.passes_;
}

Rgb PassSums::mean(std::size_t pixel, std::size_t plane) const {
  const std::size_t first = (pixel * identity_.planes.size() + plane) * 3;
  return rgb_of([&](std::size_t c) { return sums_[first + c].value() / passes_; });
}

Rgb PassSums::variance(std::size_t pixel, std::size_t plane) const {
  const std::size_t sum = (pixel * identity_.planes.size() + plane) * 3;
  const std::size_t square = (pixel * variances_ + with_variance_[plane]) * 3;
  return rgb_of([&](std::size_t c) { return variance_of_mean(sums_[sum + c], squares_[square + c], passes_); });
}

double PassSums::met(std::size_t pixel) const {
  return met_[pixel] / static_cast<double>(samples());
}

double PassSums::seen(std::size_t pixel, std::size_t light) const {
  return met_[pixel] > 0 ? static_cast<double>(seen_[pixel * identity_.lights.size() + light]) / met_[pixel] : 0;
}

std::vector<std::span<std::byte>> PassSums::parts() {
  return {std::as_writable_bytes(std::span(sums_)), std::as_writable_bytes(std::span(squares_)),
          std::as_writable_bytes(std::span(met_)), std::as_writable_bytes(std::span(seen_))};
}

std::vector<std::span<const std::byte>> PassSums::parts() const {
  return {std::as_bytes(std::span(sums_)), std::as_bytes(std::span(squares_)), std::as_bytes(std::span(met_)),
          std::as_bytes(std::span(seen_))};
}

void add_passes(const Integrator& integrator, PassSums& sums, std::uint32_t count, Progress* progress) {
  PassLoop loop(integrator, sums);
  // Splats fill a picture of their own, pass by pass; without them a tile stays with its passes.
  const std::uint32_t step = integrator.traces_from_lights() ? 1 : count;
  for (std::uint32_t done = 0; done < count; done += step) {
    const std::uint32_t first = sums.end_pass();
    const auto splats = loop.splats(first);
    parallel_for(0, loop.tiles(), [&](std::size_t index) {
      loop.run_tile(index, first, step, splats.get());
      if (progress) progress->advance(std::uint64_t{step} * tile * tile);
    });
    sums.count_passes(step);
  }
}

}  // namespace gonio::render
