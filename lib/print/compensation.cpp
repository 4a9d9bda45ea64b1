// See compensation.h.
#include "print/compensation.h"

#include <algorithm>
#include <cmath>

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

Compensation::Compensation(const Printer& printer, const PixelBox& box, Source source, int iterations)
    : printer_(printer),
      box_(widened(box, printer)),
      source_(std::move(source)),
      iterations_(iterations),
      spread_(printer.bleed, printer.pixel_m, box_.x_end - box_.x_begin, box_.y_end - box_.y_begin),
      reach_(reach_of(printer)) {}
Compensation::~Compensation() = default;

double Compensation::kept(std::size_t k) const {
  // Through the layer itself, to the top of the one below.
  return printer_.overcure_m ? std::exp(-window_[k].thickness_m() / *printer_.overcure_m) : 0;
}

bool Compensation::draw() {
  LayerPicture from;
  if (ended_ || !source_(from)) {
    ended_ = true;
    return false;
  }
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
      if (!(share > 0)) continue;
      const std::size_t k = static_cast<std::size_t>(y - box_.y_begin) * static_cast<std::size_t>(wide) +
                            static_cast<std::size_t>(x - box_.x_begin);
      const double grey = printer_.growth.grey(share * t, t);
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
  for (std::size_t k = own.size(); k-- > 0;) {
    all[k].resize(own[k].size());
    spread_(own[k], all[k]);
    if (k + 1 == own.size() || !printer_.overcure_m) continue;
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
  Lights all(misfit.size());
  std::vector<float> carried;
  for (std::size_t k = 0; k < misfit.size(); ++k) {
    if (k == 0 || !printer_.overcure_m)
      carried = misfit[k];
    else {
      const auto through = static_cast<float>(kept(k));
      for (std::size_t i = 0; i < carried.size(); ++i) carried[i] = misfit[k][i] + through * carried[i];
    }
    all[k].resize(carried.size());
    spread_.backwards(carried, all[k]);
  }
  return all;
}

Misfit Compensation::judged(const Voxels& v, const std::vector<float>& total) const {
  Misfit sum;
  const double t = v.thickness_m();
  for (std::size_t i = 0; i < total.size(); ++i) {
    const double height_m = std::min(t, printer_.growth.height_m(static_cast<double>(total[i]), t));
    const double off = height_m - static_cast<double>(v.height_m[i]);
    if (v.wish[i] != Wish::part && off == 0) continue;
    sum.sum_m2 += off * off, ++sum.voxels;
  }
  return sum;
}

void Compensation::solve() {
  Lights x, plain;
  float heaviest = 1;
  double carried = 0;
  for (std::size_t k = 0; k < window_.size(); ++k) {
    x.push_back(window_[k].light), plain.push_back(k < sent_ ? window_[k].light : window_[k].plain);
    heaviest = std::max(heaviest, std::ranges::max(window_[k].weight));
    carried = std::max(carried, kept(k));
  }
  const std::size_t last = std::min(window_.size(), sent_ + block);
  const Lights without = total(plain);
  for (std::size_t k = sent_; k < last; ++k) window_[k].before = judged(window_[k], without[k]);
  // The largest slope of the slopes: |K| <= 1, and what is carried down is a geometric series.
  const auto step = static_cast<float>((1 - carried) * (1 - carried) / static_cast<double>(heaviest));
  Lights y = x;
  double momentum = 1;
  for (int iteration = 0; iteration < iterations_; ++iteration) {
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
  for (std::size_t k = sent_; k < last; ++k) window_[k].after = judged(window_[k], with[k]);
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
