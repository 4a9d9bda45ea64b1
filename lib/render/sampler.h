// The random numbers of one camera path. Low-discrepancy over the samples of one pass of a pixel: every pair of
// dimensions is a Sobol' (0,2)-sequence of its own, Owen-scrambled and shuffled by hashes (Burley 2020, "Practical
// Hash-based Owen Scrambling", JCGT 9(4); Laine & Karras 2011 with the constants of Vegdahl 2021). Unlimited in
// dimensions. Passes and pixels are scrambled independently of each other, so that the scatter of passes measures the
// error of their mean. The numbers of a sample depend on nothing but (seed, pixel, pass, index).
#pragma once
#include <cstdint>

#include "base/random.h"
#include "geom/vector.h"

namespace gonio::render {

class Sampler {
 public:
  // `stream`: of this pixel in this pass; `index`: of the sample within the pass.
  Sampler(std::uint64_t seed, std::uint64_t stream, std::uint32_t index)
      : key_(split_mix(split_mix(seed) ^ stream)), index_(reversed(index)) {}

  // For `count` paths, a power of two, that share this one's beginning: the samples of all beginnings' parts together
  // are as evenly spread as a pass of so many more.
  Sampler part(std::uint32_t number, std::uint32_t count) const {
    Sampler part = *this;
    part.key_ = split_mix(key_ + dimension_ + 0x73706c6974u);
    part.dimension_ = 0;
    part.index_ = reversed(reversed(index_) * count + number);
    return part;
  }
  double uniform() {
    const Key key(key_ + ++dimension_);
    return unit(reversed(scrambled(shuffled(key), key.high)));
  }
  Vec2 two() {
    const Key key(key_ + ++dimension_);
    const std::uint32_t place = shuffled(key);
    // The first dimension is van der Corput's: the reversal of its reversed bits is the index itself.
    return {unit(reversed(scrambled(place, key.high))),
            unit(reversed(scrambled(reversed_second(place), key.high * 0x9e3779b9u + key.low)))};
  }

 private:
  struct Key {  // of one pair of dimensions
    explicit Key(std::uint64_t number) {
      const std::uint64_t hash = split_mix(number);
      low = static_cast<std::uint32_t>(hash), high = static_cast<std::uint32_t>(hash >> 32);
    }
    std::uint32_t low, high;
  };
  std::uint32_t shuffled(const Key& key) const { return reversed(scrambled(index_, key.low)); }
  static double unit(std::uint32_t x) { return (x + 0.5) * 0x1p-32; }  // in (0, 1)
  static std::uint32_t reversed(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
  }
  // Owen's nested uniform scrambling of a number whose bits are reversed.
  static std::uint32_t scrambled(std::uint32_t x, std::uint32_t key) {
    x ^= x * 0x3d20adeau;
    x += key;
    x *= (key >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
  }
  // Second dimension of Sobol's sequence, bits reversed. Bit k of the index contributes (1 + x)^k, a polynomial over
  // GF(2); of it bit j is odd where j's bits are a subset of k's (Lucas 1878). So bit j of the result is the sum over
  // all supersets of j, found bit by bit of j and k: five steps for 32 bits.
  static std::uint32_t reversed_second(std::uint32_t index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    return index ^ ((index >> 16) & 0x0000ffffu);
  }

  std::uint64_t key_;
  std::uint32_t index_;  // reversed
  std::uint64_t dimension_ = 0;
};

}  // namespace gonio::render
