// See compensation.h.
#include "print/compensation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "print/mechanisms/print_overcure.h"

namespace gonio::print {
namespace {

constexpr std::size_t block = 8;        // layers that are solved and sent at once
constexpr std::size_t most_reach = 24;  // layers
constexpr double counts = 0.01;         // of light that goes through

PixelBox widened(const PixelBox& box, const Printer& printer) {
  const auto margin = [&](double pixel_m) {
    return printer.bleed.none() ? 0 : static_cast<int>(std::ceil(4 * printer.bleed.sigma_m / pixel_m)) + 2;
  };
  const int x = margin(printer.pixel_m.x), y = margin(printer.pixel_m.y);
  return {std::max(0, box.x_begin - x), std::max(0, box.y_begin - y), std::min(printer.width_px, box.x_end + x),
          std::min(printer.height_px, box.y_end + y)};
}

std::size_t reach_of(const Printer& printer) {
  if (!printer.overcure_m) return 0;
  double thinnest = printer.layer_m;
  for (const double layer_m : printer.layers_m) thinnest = std::min(thinnest, layer_m);
  return std::min(most_reach, static_cast<std::size_t>(std::ceil(-std::log(counts) * *printer.overcure_m / thinnest)));
}

enum class Wish : std::uint8_t { empty, part, full };

}  // namespace

double Misfit::rms_m() const {
  return voxels == 0 ? 0 : std::sqrt(sum_m2 / static_cast<double>(voxels));
}

struct Compensation::Voxels {
  std::size_t index = 0;
  double bottom_m = 0, top_m = 0;
  std::vector<Wish> wish{};
  std::vector<float> height_m{}, wanted{}, weight{};  // asked for; the light of that height; of the misfit
  std::vector<float> plain{}, light{};                // grey values without compensation, with it
  Misfit before{}, after{};
  double thickness_m() const { return top_m - bottom_m; }
};

Compensation::Compensation(const Printer& printer, const PixelBox& box, Source source, int iterations, Known known)
    : printer_(printer),
      box_(widened(box, printer)),
      source_(std::move(source)),
      iterations_(iterations),
      known_(std::move(known)),
      spread_(printer.bleed, printer.pixel_m, box_.x_end - box_.x_begin, box_.y_end - box_.y_begin),
      reach_(reach_of(printer)) {}
Compensation::~Compensation() = default;

double Compensation::kept(std::size_t k) const {
  // Through the layer itself, to the top of the one below.
  return equation::print_overcure(window_[k].thickness_m(), printer_.overcure_m.value_or(0));
}

bool Compensation::draw() {
  const LayerPicture* const next = ended_ ? nullptr : source_();
  if (next == nullptr) {
    ended_ = true;
    return false;
  }
  const LayerPicture& from = *next;
  Voxels v{.index = from.index, .bottom_m = from.bottom_m, .top_m = from.top_m};
  const int wide = box_.x_end - box_.x_begin, high = box_.y_end - box_.y_begin;
  const auto pixels = static_cast<std::size_t>(wide) * static_cast<std::size_t>(high);
  const double t = v.thickness_m(), reach_m = std::min(t, printer_.growth.reach_m(t));
  const double white = std::max(1e-12, printer_.growth.slope_m(1, t));
  const auto weigh = [&](double light) { return static_cast<float>(printer_.growth.slope_m(light, t) / white); };
  const double threshold = printer_.growth.threshold();
  v.wish.assign(pixels, Wish::empty), v.height_m.assign(pixels, 0), v.plain.assign(pixels, 0);
  v.wanted.assign(pixels, static_cast<float>(threshold));
  v.weight.assign(pixels, threshold > 0 ? weigh(threshold + 1e-9) : 1);
  for (int y = from.box.y_begin; y < from.box.y_end; ++y)
    for (int x = from.box.x_begin; x < from.box.x_end; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y - from.box.y_begin) * static_cast<std::size_t>(from.box.x_end - from.box.x_begin) +
          static_cast<std::size_t>(x - from.box.x_begin);
      const double share = static_cast<double>(from.share[at]);
      const double grey = printer_.growth.grey_of_share(share, t);
      if (!(grey > 0)) continue;
      const std::size_t k = static_cast<std::size_t>(y - box_.y_begin) * static_cast<std::size_t>(wide) +
                            static_cast<std::size_t>(x - box_.x_begin);
      v.height_m[k] = static_cast<float>(share * t), v.plain[k] = static_cast<float>(std::round(255 * grey) / 255);
      v.wish[k] = share * t >= reach_m ? Wish::full : Wish::part;
      v.wanted[k] = static_cast<float>(grey), v.weight[k] = weigh(grey);
    }
  v.light = v.plain;
  window_.push_back(std::move(v));
  return true;
}

Compensation::Lights Compensation::total(const Lights& own) const {
  Lights all(own.size());
  parallel_for(0, own.size(), [&](std::size_t k) {
    all[k].resize(own[k].size());
    spread_(own[k], all[k]);
  });
  if (!printer_.overcure_m) return all;
  for (std::size_t k = own.size() - 1; k-- > 0;) {
    const auto through = static_cast<float>(kept(k + 1));
    for (std::size_t i = 0; i < all[k].size(); ++i) all[k][i] += through * all[k + 1][i];
  }
  return all;
}

Compensation::Lights Compensation::misfit(const Lights& total) const {
  Lights all(total.size());
  for (std::size_t k = 0; k < total.size(); ++k) {
    const Voxels& v = window_[k];
    all[k].resize(total[k].size());
    for (std::size_t i = 0; i < total[k].size(); ++i) {
      const float off = total[k][i] - v.wanted[i];
      const bool counts_here = v.wish[i] == Wish::part || (v.wish[i] == Wish::empty ? off > 0 : off < 0);
      all[k][i] = counts_here ? v.weight[i] * off : 0;
    }
  }
  return all;
}

Compensation::Lights Compensation::slopes(const Lights& misfit) const {
  Lights carried = misfit;
  for (std::size_t k = 1; k < carried.size() && printer_.overcure_m; ++k) {
    const auto through = static_cast<float>(kept(k));
    for (std::size_t i = 0; i < carried[k].size(); ++i) carried[k][i] += through * carried[k - 1][i];
  }
  Lights all(carried.size());
  parallel_for(0, all.size(), [&](std::size_t k) {
    all[k].resize(carried[k].size());
    spread_.backwards(carried[k], all[k]);
  });
  return all;
}

void Compensation::judge(Voxels& v, const std::vector<float>& without, const std::vector<float>& with) const {
  const double t = v.thickness_m();
  v.before = v.after = {};
  for (std::size_t i = 0; i < with.size(); ++i) {
    const auto off = [&](float light) {
      return std::min(t, printer_.growth.height_m(static_cast<double>(light), t)) - static_cast<double>(v.height_m[i]);
    };
    const double before = off(without[i]), after = off(with[i]);
    if (v.wish[i] != Wish::part && before == 0 && after == 0) continue;
    v.before.sum_m2 += before * before, ++v.before.voxels;
    v.after.sum_m2 += after * after, ++v.after.voxels;
  }
}

// Of the block up to `last`: have all its layers been found before?
bool Compensation::take_known(std::size_t last) {
  if (!known_) return false;
  for (std::size_t k = sent_; k < last; ++k) {
    const std::vector<std::uint8_t> greys = known_(window_[k].index);
    if (greys.size() != window_[k].light.size()) return false;
    for (std::size_t i = 0; i < greys.size(); ++i) window_[k].light[i] = static_cast<float>(greys[i]) / 255;
  }
  return true;
}

void Compensation::solve() {
  const std::size_t last = std::min(window_.size(), sent_ + block);
  // Those that follow begin anew with every block, so that a block depends on nothing but what was sent.
  for (std::size_t k = sent_; k < window_.size(); ++k) window_[k].light = window_[k].plain;
  const bool known = take_known(last);
  Lights x, plain;
  float heaviest = 1;
  double carried = 0;
  for (std::size_t k = 0; k < window_.size(); ++k) {
    x.push_back(window_[k].light), plain.push_back(k < sent_ ? window_[k].light : window_[k].plain);
    heaviest = std::max(heaviest, std::ranges::max(window_[k].weight));
    carried = std::max(carried, kept(k));
  }
  const Lights without = total(plain);
  // The largest slope of the slopes: |K| <= 1, and what is carried down is a geometric series.
  const auto step = static_cast<float>((1 - carried) * (1 - carried) / static_cast<double>(heaviest));
  Lights y = x;
  double momentum = 1;
  for (int iteration = 0; iteration < (known ? 0 : iterations_); ++iteration) {
    const Lights slope = slopes(misfit(total(y)));
    const double next = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
    double turns = 0;
    for (std::size_t k = sent_; k < x.size(); ++k)
      for (std::size_t i = 0; i < x[k].size(); ++i) {
        const float moved = std::clamp(y[k][i] - step * slope[k][i], 0.0f, 1.0f);
        turns += static_cast<double>(slope[k][i]) * static_cast<double>(moved - x[k][i]);
        y[k][i] = moved + static_cast<float>((momentum - 1) / next) * (moved - x[k][i]);
        x[k][i] = moved;
      }
    momentum = next;
    if (turns > 0) y = x, momentum = 1;
  }
  for (std::size_t k = sent_; k < x.size(); ++k) {
    for (float& grey : x[k]) grey = std::round(255 * grey) / 255;
    window_[k].light = x[k];
  }
  const Lights with = total(x);
  for (std::size_t k = sent_; k < last; ++k) judge(window_[k], without[k], with[k]);
  solved_ = last - sent_;
}

bool Compensation::next(CompensatedLayer& layer) {
  if (solved_ == 0) {
    while (window_.size() < sent_ + block + reach_ && draw()) continue;
    if (window_.size() == sent_) return false;
    solve();
  }
  const Voxels& v = window_[sent_];
  layer = {.index = v.index, .bottom_m = v.bottom_m, .top_m = v.top_m, .box = box_, .greys = {}};
  layer.greys.resize(v.light.size());
  for (std::size_t i = 0; i < v.light.size(); ++i)
    layer.greys[i] = static_cast<std::uint8_t>(std::lround(255 * v.light[i]));
  layer.before = v.before, layer.after = v.after;
  ++sent_, --solved_;
  for (; sent_ > reach_; --sent_) window_.pop_front();
  return true;
}

}  // namespace gonio::print
