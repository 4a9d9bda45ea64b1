// See sequence.h.
#include "scan/sequence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "geom/vector.h"
#include "manifest/document.h"
#include "manifest/sections/projection.h"

namespace gonio::scan {
namespace {

using What = Shown::What;

constexpr const char* words[] = {"white", "black", "bit", "cosine", "line"};
constexpr const char* axis_words[] = {"column", "row"};
constexpr std::size_t fewest_shifts = 3;
constexpr int least_period_px = 6;  // of lines: what lies between them tells the light from elsewhere

}  // namespace

bool Sequence::tells(Axis axis) const {
  return std::ranges::any_of(
      frames, [axis](const Shown& s) { return s.what != What::white && s.what != What::black && s.axis == axis; });
}

int bits_of(int size) {
  int bits = 0;
  while ((1 << bits) < size) ++bits;
  return bits;
}

int gray_code(int number) {
  return number ^ (number >> 1);
}

int number_of_gray(int code) {
  for (int shift = 1; shift < 32; shift *= 2) code ^= code >> shift;
  return code;
}

Sequence gray_sequence(int width_px, int height_px, std::span<const Axis> axes) {
  Sequence s{width_px, height_px, {}};
  for (const Axis axis : axes)
    for (int bit = bits_of(s.size(axis)) - 1; bit >= 0; --bit)
      for (const bool inverse : {false, true}) s.frames.push_back({What::bit, axis, bit, inverse});
  s.frames.push_back({.what = What::white});
  s.frames.push_back({.what = What::black});
  return s;
}

Sequence cosine_sequence(int width_px, int height_px, std::span<const Axis> axes, std::span<const double> periods,
                         int shifts) {
  Sequence s{width_px, height_px, {}};
  for (const Axis axis : axes)
    for (const double p : periods)
      for (int k = 0; k < shifts; ++k)
        s.frames.push_back({.what = What::cosine, .axis = axis, .periods = p, .shift_rad = 2 * pi * k / shifts});
  return s;
}

Sequence line_sequence(int width_px, int height_px, std::span<const Axis> axes, int period_px) {
  Sequence s{width_px, height_px, {}};
  int finest = 0;
  while ((2 << finest) * 2 <= period_px) ++finest;
  for (const Axis axis : axes) {
    for (int bit = bits_of(s.size(axis)) - 1; bit >= finest; --bit)
      for (const bool inverse : {false, true}) s.frames.push_back({What::bit, axis, bit, inverse});
    for (int k = 0; k < period_px; ++k)
      s.frames.push_back({.what = What::line, .axis = axis, .period_px = period_px, .offset_px = k});
  }
  s.frames.push_back({.what = What::white});
  s.frames.push_back({.what = What::black});
  return s;
}

double light_at(const Sequence& sequence, std::size_t frame, int column, int row) {
  const Shown& s = sequence.frames[frame];
  const int u = s.axis == Axis::column ? column : row;
  if (s.what == What::white || s.what == What::black) return s.what == What::white;
  if (s.what == What::bit) return ((gray_code(u) >> s.bit) & 1) != static_cast<int>(s.inverse);
  if (s.what == What::line) return u % s.period_px == s.offset_px;
  const double half = pi * s.periods / sequence.size(s.axis), theta = 2 * half * (u + 0.5);
  return 0.5 + 0.5 * std::cos(theta - s.shift_rad) * std::sin(half) / half;
}

io::Image picture_of(const Sequence& sequence, std::size_t frame) {
  io::Image picture(sequence.width_px, sequence.height_px, {"Y"});
  for (int y = 0; y < sequence.height_px; ++y)
    for (int x = 0; x < sequence.width_px; ++x)
      picture.at(x, y, 0) = static_cast<float>(light_at(sequence, frame, x, y));
  return picture;
}

namespace {

Shown shown(const manifest::ProjectedFrame& f, const std::string& at) {
  const auto refuse = [&at](const std::string& what, const std::string& remedy) {
    throw Error(Exit::data, at, what, remedy);
  };
  Shown s;
  s.what = static_cast<What>(std::ranges::find(words, f.show) - std::begin(words));
  if (s.what == What::white || s.what == What::black) return s;
  if (f.axis.empty()) refuse("says no axis", "\"axis\": \"column\" or \"row\"");
  s.axis = f.axis == "row" ? Axis::row : Axis::column;
  if (s.what == What::bit) {
    if (!f.bit) refuse("says no bit", "give it, 0 the finest");
    s.bit = static_cast<int>(*f.bit), s.inverse = f.inverse.value_or(false);
    return s;
  }
  if (s.what == What::line) {
    if (!f.period_px || !f.offset_px) refuse("says no period_px or no offset_px", "give both");
    s.period_px = static_cast<int>(*f.period_px), s.offset_px = static_cast<int>(*f.offset_px);
    return s;
  }
  if (!f.periods || !f.shift_rad) refuse("says no periods or no shift_rad", "give both");
  s.periods = *f.periods, s.shift_rad = *f.shift_rad;
  return s;
}

// What the frames of one axis must say together.
void check_axis(const Sequence& sequence, Axis axis, const std::string& at) {
  std::set<std::pair<int, bool>> bits;
  std::map<double, std::set<double>> shifts;
  int coarsest = -1, finest = 32;
  for (const Shown& s : sequence.frames) {
    if (s.axis != axis) continue;
    if (s.what == What::bit) {
      if (!bits.insert({s.bit, s.inverse}).second)
        throw Error(Exit::data, at, format("shows bit %d of %ss twice", s.bit, axis_words[static_cast<int>(axis)]),
                    "every picture of a Gray code is shown once");
      coarsest = std::max(coarsest, s.bit), finest = std::min(finest, s.bit);
    }
    if (s.what == What::cosine) shifts[s.periods].insert(s.shift_rad);
  }
  for (int bit = finest; bit <= coarsest; ++bit)
    if (!bits.contains({bit, false}))
      throw Error(Exit::data, at, format("shows no bit %d of %ss", bit, axis_words[static_cast<int>(axis)]),
                  "a Gray code has all its bits from the coarsest to the finest that is shown");
  if (coarsest >= 0 && (1 << (coarsest + 1)) < sequence.size(axis))
    throw Error(Exit::data, at,
                format("shows bits up to %d, and there are %d %ss", coarsest, sequence.size(axis),
                       axis_words[static_cast<int>(axis)]),
                "show the coarser bits, too, or state the projector's true size");
  for (const auto& [periods, own] : shifts)
    if (own.size() < fewest_shifts)
      throw Error(Exit::data, at, format("shows %g periods at %zu shifts", periods, own.size()),
                  "three shifts at least: a pixel has three unknowns");
}

// Lines: once at every offset of one period, and a Gray code of stripes that are no wider than half of it.
void check_lines(const Sequence& sequence, Axis axis, const std::string& at) {
  int period = 0, finest = 32;
  std::set<int> offsets;
  for (const Shown& s : sequence.frames) {
    if (s.axis == axis && s.what == What::bit) finest = std::min(finest, s.bit);
    if (s.axis != axis || s.what != What::line) continue;
    if (period > 0 && s.period_px != period)
      throw Error(Exit::data, at, format("shows lines %d and %d pixels apart", period, s.period_px),
                  "one period for each axis");
    period = s.period_px;
    if (s.offset_px >= period || !offsets.insert(s.offset_px).second)
      throw Error(Exit::data, at, format("shows lines at the offset %d twice, or beyond their period", s.offset_px),
                  format("each of 0 to %d once", period - 1));
  }
  if (period == 0) return;
  if (period < least_period_px)
    throw Error(Exit::data, at, format("shows lines %d pixels apart", period),
                format("%d at least: dark pixels between them tell what comes from elsewhere", least_period_px));
  if (static_cast<int>(offsets.size()) < period)
    throw Error(Exit::data, at, format("shows lines at %zu of %d offsets", offsets.size(), period), "show all");
  if (finest > 30 || (2 << finest) > period)
    throw Error(Exit::data, at, "has no bits that tell its lines apart",
                format("a Gray code whose stripes are %d pixels or less", period / 2));
}

}  // namespace

Sequence sequence_of(const manifest::Document& document, const std::string& name) {
  const manifest::Projection& p = document.projections.at(name);
  const std::string at = manifest::place(document, "/projections/" + name);
  Sequence s{static_cast<int>(p.width_px), static_cast<int>(p.height_px), {}};
  for (std::size_t i = 0; i < p.frames.size(); ++i)
    s.frames.push_back(shown(p.frames[i], at + "/frames/" + std::to_string(i)));
  for (const Axis axis : {Axis::column, Axis::row}) check_axis(s, axis, at), check_lines(s, axis, at);
  if (!s.tells(Axis::column) && !s.tells(Axis::row))
    throw Error(Exit::data, at, "tells neither columns nor rows", "show bits, cosines or lines");
  return s;
}

manifest::Projection projection_of(const Sequence& sequence) {
  manifest::Projection p;
  p.width_px = sequence.width_px, p.height_px = sequence.height_px;
  for (const Shown& s : sequence.frames) {
    manifest::ProjectedFrame f;
    f.show = words[static_cast<int>(s.what)];
    if (s.what != What::white && s.what != What::black) f.axis = axis_words[static_cast<int>(s.axis)];
    if (s.what == What::bit) {
      f.bit = s.bit;
      if (s.inverse) f.inverse = true;
    }
    if (s.what == What::cosine) f.periods = s.periods, f.shift_rad = s.shift_rad;
    if (s.what == What::line) f.period_px = s.period_px, f.offset_px = s.offset_px;
    p.frames.push_back(std::move(f));
  }
  return p;
}

}  // namespace gonio::scan
